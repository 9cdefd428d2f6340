//! Where do the objects of a file stand in a world whose y axis points up?

use glam::{DAffine3, DMat3, DVec3};

use super::error::Fault;
use crate::source::SourceScene;

/// Most places where all objects of a file stand together: a few lines of a scene file can name as
/// many as take 25 MB.
pub(super) const MOST_PLACES: usize = 1 << 18;

/// Which axis of a file points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Up {
    /// y, as in the world of a scene.
    Y,
    /// z: x stays, z becomes y, and y points away from the viewer.
    Z,
}

/// What is to be known of files besides what they say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// Which axis points up in all of them; if not given, the one that is usual for the format: z
    /// in STL, LAS and LAZ, y in all others.
    pub up: Option<Up>,
    /// Whether files are opened that lie outside the folder of the file that names them.
    pub allow_outside: bool,
}

/// Turns a file's world so that y points up.
pub(super) fn turn_up(scene: &mut SourceScene, up: Up) {
    if up == Up::Y {
        return;
    }
    let world_from_file = DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y));
    for world_from_mesh in scene.placements_mut().flatten() {
        *world_from_mesh = world_from_file * *world_from_mesh;
    }
}

/// Refuses a scene with more places than a pack can hold.
pub(super) fn check_count(scene: &SourceScene) -> Result<(), Fault> {
    match scene.placements().map(Vec::len).sum::<usize>() > MOST_PLACES {
        true => Err(too_many()),
        false => Ok(()),
    }
}

/// What is said of more places.
pub(super) fn too_many() -> Fault {
    let what = format!("objects stand in more than {MOST_PLACES} places");
    Fault::broken("scene", what, "give fewer places, or several packs")
}

/// Refuses a scene with a vertex that stands nowhere: beyond what numbers can say.
pub(super) fn check(scene: &SourceScene) -> Result<(), Fault> {
    for ((name, reach), placements) in scene.reaches().zip(scene.placements()) {
        let stands = |world_from_mesh: &DAffine3| {
            let axes = world_from_mesh.matrix3;
            let farthest =
                DMat3::from_cols(axes.x_axis.abs(), axes.y_axis.abs(), axes.z_axis.abs());
            let far = farthest * reach + world_from_mesh.translation.abs();
            far.is_finite()
        };
        if !placements.iter().all(stands) {
            return Err(stands_nowhere(name));
        }
    }
    Ok(())
}

/// Views come no nearer to a scene of this length, in metres.
const SMALLEST: f64 = 2e-9;

/// Reports a scene that is so small that views do not come near to it.
pub(super) fn tell_small(scene: &mut SourceScene) {
    let [least, most] = extent(scene);
    let length = (most - least).max_element();
    // A single point has no length.
    if length > 0.0 && length < SMALLEST {
        scene.remark(format!(
            "all of it is only {length:.1e} m across, which is too small to be looked at: scale it \
             up, or write it in larger units"
        ));
    }
}

/// The least and most along each axis of the world; of what is larger than [`SMALLEST`], only a
/// part that shows it.
fn extent(scene: &SourceScene) -> [DVec3; 2] {
    let mut all = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    for place in scene.places() {
        all = [all[0].min(place), all[1].max(place)];
        if (all[1] - all[0]).max_element() >= SMALLEST {
            break;
        }
    }
    all
}

fn stands_nowhere(name: &str) -> Fault {
    let name = super::text::shortened(name);
    Fault::broken(
        format!("object {name:?}"),
        "is moved or scaled beyond what numbers can say",
        "apply its transform where it was made, and export it again",
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::SourceObject;

    #[test]
    fn z_becomes_y_without_a_mirror() {
        let mut scene = SourceScene::default();
        scene.objects.push(SourceObject {
            name: String::new(),
            mesh: 0,
            placements: vec![DAffine3::from_translation(DVec3::new(1.0, 2.0, 3.0))],
        });
        turn_up(&mut scene, Up::Z);
        let world_from_mesh = scene.objects[0].placements[0];
        let stands = world_from_mesh.transform_point3(DVec3::new(10.0, 20.0, 30.0));
        assert_eq!(stands, DVec3::new(11.0, 33.0, -22.0));
        assert_eq!(world_from_mesh.matrix3.determinant(), 1.0);
    }
}
