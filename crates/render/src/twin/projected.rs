//! Where in a source does a ray end? Twin of `shaders/shared/projected.wgsl`.

use glam::{Vec2, Vec3};

pub(super) struct Projected {
    pub(super) ahead: bool,
    pub(super) at: Vec2,
    pub(super) right: Vec2,
    pub(super) down: Vec2,
}

pub(super) fn projected(projection: u32, ray: Vec3, right: Vec3, down: Vec3) -> Projected {
    if projection == 0 {
        let at = ray.truncate() / ray.z;
        return Projected {
            ahead: ray.z > 0.0,
            at,
            right: (right.truncate() - at * right.z) / ray.z,
            down: (down.truncate() - at * down.z) / ray.z,
        };
    }
    if projection == 3 {
        return through_fisheye(ray, right, down);
    }
    let level2 = ray.x * ray.x + ray.z * ray.z;
    let level = level2.sqrt();
    let turn = Vec2::new(
        ray.z * right.x - ray.x * right.z,
        ray.z * down.x - ray.x * down.z,
    ) / level2;
    let grown = Vec2::new(
        ray.x * right.x + ray.z * right.z,
        ray.x * down.x + ray.z * down.z,
    ) / level;
    let yaw = ray.x.atan2(ray.z);
    let (height, climb) = if projection == 1 {
        let height = ray.y / level;
        (
            height,
            (Vec2::new(right.y, down.y) - height * grown) / level,
        )
    } else {
        let rise = level * Vec2::new(right.y, down.y) - ray.y * grown;
        (ray.y.atan2(level), rise / (level2 + ray.y * ray.y))
    };
    Projected {
        ahead: true,
        at: Vec2::new(yaw, height),
        right: Vec2::new(turn.x, climb.x),
        down: Vec2::new(turn.y, climb.y),
    }
}

fn through_fisheye(ray: Vec3, right: Vec3, down: Vec3) -> Projected {
    let across = ray.truncate().length();
    if across < 1e-6 * ray.z.abs() {
        return Projected {
            ahead: ray.z > 0.0,
            at: ray.truncate() / ray.z,
            right: right.truncate() / ray.z,
            down: down.truncate() / ray.z,
        };
    }
    let angle = across.atan2(ray.z);
    let grown = Vec2::new(
        ray.truncate().dot(right.truncate()),
        ray.truncate().dot(down.truncate()),
    ) / across;
    let turned = (ray.z * grown - across * Vec2::new(right.z, down.z)) / ray.dot(ray);
    let share = angle / across;
    let growth = (turned - share * grown) / across;
    Projected {
        ahead: true,
        at: share * ray.truncate(),
        right: growth.x * ray.truncate() + share * right.truncate(),
        down: growth.y * ray.truncate() + share * down.truncate(),
    }
}
