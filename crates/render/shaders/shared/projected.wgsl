// Where in a source does a ray end, and how does that move with the ray?
//
// Rays are to the right, down and forward of the source's axis; places are in the window's units.

// What a projection makes of a ray and of its changes.
struct Projected {
    ahead: bool,
    at: vec2f,
    right: vec2f,
    down: vec2f,
}

// By projection: 0 plane, 1 cylinder, 2 equirectangular, 3 fisheye.
fn projected(projection: u32, ray: vec3f, right: vec3f, down: vec3f) -> Projected {
    if (projection == 0u) {
        let at = ray.xy / ray.z;
        let by_right = (right.xy - at * right.z) / ray.z;
        return Projected(ray.z > 0.0, at, by_right, (down.xy - at * down.z) / ray.z);
    }
    if (projection == 3u) {
        return through_fisheye(ray, right, down);
    }
    let level2 = ray.x * ray.x + ray.z * ray.z;
    let level = sqrt(level2);
    let turn = vec2f(ray.z * right.x - ray.x * right.z, ray.z * down.x - ray.x * down.z) / level2;
    let grown = vec2f(ray.x * right.x + ray.z * right.z, ray.x * down.x + ray.z * down.z) / level;
    let yaw = atan2(ray.x, ray.z);
    if (projection == 1u) {
        let height = ray.y / level;
        let climb = (vec2f(right.y, down.y) - height * grown) / level;
        return Projected(true, vec2f(yaw, height), vec2f(turn.x, climb.x), vec2f(turn.y, climb.y));
    }
    let climb = (level * vec2f(right.y, down.y) - ray.y * grown) / (level2 + ray.y * ray.y);
    let pitch = atan2(ray.y, level);
    return Projected(true, vec2f(yaw, pitch), vec2f(turn.x, climb.x), vec2f(turn.y, climb.y));
}

// The angle from the axis, along the direction across it.
fn through_fisheye(ray: vec3f, right: vec3f, down: vec3f) -> Projected {
    let across = length(ray.xy);
    if (across < 1e-6 * abs(ray.z)) {
        return Projected(ray.z > 0.0, ray.xy / ray.z, right.xy / ray.z, down.xy / ray.z);
    }
    let angle = atan2(across, ray.z);
    let grown = vec2f(dot(ray.xy, right.xy), dot(ray.xy, down.xy)) / across;
    let turned = (ray.z * grown - across * vec2f(right.z, down.z)) / dot(ray, ray);
    let share = angle / across;
    let growth = (turned - share * grown) / across;
    let by_right = growth.x * ray.xy + share * right.xy;
    return Projected(true, share * ray.xy, by_right, growth.y * ray.xy + share * down.xy);
}
