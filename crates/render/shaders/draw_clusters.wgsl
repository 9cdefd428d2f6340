// draw_clusters: which colour has each pixel of the nearest surface?
//
// Reads: placements, clusters, vertices, pages, the clusters that are seen. Writes: sRGB codes, or
// the units that would refine what is drawn. Size: the corners that `cull_clusters` wrote.

// The block of each cluster and its placement.
@group(0) @binding(3) var<storage, read> shown: array<vec2u>;
@group(0) @binding(4) var<storage, read> vertices: array<u32>;

const VERTEX_BITS = 7u;
const VERTEX_MASK = 127u;

// Ambient light from below and from above, and light from the lamp; 1 shows a colour as it is.
const GROUND = 0.22;
const SKY = 0.45;
const LAMP = 0.55;

struct Corner {
    @builtin(position) position: vec4f,
    // In view space.
    @location(0) place: vec3f,
    @location(1) normal: vec3f,
    // In linear light.
    @location(2) colour: vec3f,
    // On the texture.
    @location(3) uv: vec2f,
    // Flags, level, refiner and texture.
    @location(4) @interpolate(flat) of_cluster: vec4u,
}

fn linear_from_srgb(code: vec3f) -> vec3f {
    let curved = pow((code + 0.055) / 1.055, vec3f(2.4));
    return select(curved, code / 12.92, code <= vec3f(0.04045));
}

fn srgb_from_linear(light: vec3f) -> vec3f {
    let curved = 1.055 * pow(light, vec3f(1.0 / 2.4)) - 0.055;
    return select(curved, light * 12.92, light <= vec3f(0.0031308));
}

// The direction of an octahedral normal: Meyer et al. 2010.
fn direction_from_octahedral(normal: vec2f) -> vec3f {
    let z = 1.0 - abs(normal.x) - abs(normal.y);
    let sides = select(vec2f(-1.0), vec2f(1.0), normal >= vec2f(0.0));
    let folded = (1.0 - abs(normal.yx)) * sides;
    return normalize(vec3f(select(normal, folded, z < 0.0), z));
}

fn unit(direction: vec3f) -> vec3f {
    return direction / max(length(direction), 1e-18);
}

fn clip_from_view(place: vec3f) -> vec4f {
    let across = place.xy * scene.clip_from_view.xy + place.z * scene.clip_from_view.zw;
    return vec4f(across, scene.near, place.z);
}

@vertex
fn place_corner(@builtin(vertex_index) number: u32) -> Corner {
    let block = shown[number >> VERTEX_BITS].x;
    let placement = shown[number >> VERTEX_BITS].y;
    let flags = placements[placement].flags;
    let vertex = 4u * words[block + HEAD_WORDS + (number & VERTEX_MASK)];
    let low = vertices[vertex];
    let high = vertices[vertex + 1u];
    let grid = vec3f(vec3u(low & 65535u, low >> 16u, high & 65535u));
    var corner: Corner;
    corner.place = times(placements[placement].view_from_grid, vec4f(grid, 1.0));
    corner.position = clip_from_view(corner.place);
    corner.colour = placements[placement].colour.rgb;
    if ((flags & COLOURS) != 0u) {
        corner.colour = linear_from_srgb(unpack4x8unorm(vertices[vertex + 2u]).rgb);
    }
    if ((flags & NORMALS) != 0u) {
        let normal = direction_from_octahedral(unpack4x8snorm(high).zw);
        corner.normal = unit(times(placements[placement].normal_from_object, vec4f(normal, 0.0)));
    }
    let place = vertices[vertex + 3u];
    let uv = vec2f(vec2u(place & 65535u, place >> 16u));
    let from_grid = placements[placement].uv_from_grid;
    corner.uv = from_grid.xy + from_grid.zw * uv;
    var head = NO_TEXTURE;
    if ((flags & TEXTURED) != 0u) {
        head = texture_of(placements[placement].textures, vertices[vertex + 2u] >> 24u);
    }
    corner.of_cluster = vec4u(flags, counts_of(block).level, refiner_of(block), head);
    return corner;
}

// The face turned to the viewer; a vertex' normal is turned to that side where both are seen.
fn normal_at(flags: u32, place: vec3f, normal: vec3f, face: vec3f) -> vec3f {
    let seen = select(face, -face, dot(face, place) > 0.0);
    let has_normals = (flags & NORMALS) != 0u && dot(normal, normal) > 0.0;
    let own = unit(select(seen, normal, has_normals));
    let turns = (flags & TWO_SIDED) != 0u && dot(own, seen) < 0.0;
    return select(own, -own, turns);
}

fn light_on(normal: vec3f) -> f32 {
    let ambient = mix(GROUND, SKY, 0.5 + 0.5 * dot(normal, scene.up));
    return ambient + LAMP * max(dot(normal, scene.light), 0.0);
}

fn shaded(flags: u32, level: u32, colour: vec3f, normal: vec3f) -> vec3f {
    let light = select(light_on(normal), 1.0, (flags & UNLIT) != 0u);
    let code = srgb_from_linear(clamp(colour * light, vec3f(0.0), vec3f(1.0)));
    return mix(code, ramp(f32(level) / scene.coarsest), scene.tint);
}

// The colour of the texture, given how far places on it move from one pixel to the next.
fn texture_on(head: u32, uv: vec2f, right: vec2f, down: vec2f) -> vec4f {
    if (head == NO_TEXTURE) {
        return vec4f(1.0);
    }
    let colour = texture_colour(head, uv, right, down);
    if (is_cut_out(head, colour.a)) {
        discard;
    }
    return colour;
}

@fragment
fn draw_clusters(corner: Corner) -> @location(0) vec4f {
    let face = cross(unit(dpdx(corner.place)), unit(dpdy(corner.place)));
    let right = dpdx(corner.uv);
    let down = dpdy(corner.uv);
    let flags = corner.of_cluster.x;
    let normal = normal_at(flags, corner.place, corner.normal, face);
    let colour = corner.colour * texture_on(corner.of_cluster.w, corner.uv, right, down).rgb;
    return vec4f(shaded(flags, corner.of_cluster.y, colour, normal), 1.0);
}

@fragment
fn draw_refiners(corner: Corner) -> @location(0) vec4u {
    let right = dpdx(corner.uv);
    let down = dpdy(corner.uv);
    let colour = texture_on(corner.of_cluster.w, corner.uv, right, down);
    return vec4u(corner.of_cluster.z, 0u, 0u, 0u);
}
