//! How much light comes from each place of a surface?
//!
//! As `crates/render/shaders/draw_clusters.wgsl` shades it, before light becomes a code.

use foveal_core::content::mesh::octahedral::direction_from_octahedral;
use foveal_core::content::mesh::payload::{Attributes, MeshVertex};
use foveal_core::content::scene::description::SceneObject;
use foveal_core::content::scene::lighting::{GROUND, LAMP, SKY, normal_matrix};
use foveal_core::perception::luminance::linear_from_srgb;
use foveal_core::perception::parameters::Parameters;
use glam::{DAffine3, DMat3, DVec3};

/// What the surface of an object looks like where the object stands first, on the default display,
/// lit from one direction.
pub(super) struct LitSurface {
    attributes: Attributes,
    /// Whether both sides are seen.
    pub two_sided: bool,
    unlit: bool,
    colour: DVec3,
    /// Turns normals of the object into those of the world, not of unit length.
    normals: DMat3,
    lamp: DVec3,
    linear: [f64; 256],
    display: Parameters,
}

/// A triangle with what shading asks of it.
pub(super) struct LitTriangle {
    /// Places of its corners on the grid.
    pub places: [[i64; 3]; 3],
    /// The least and the most of them along each axis.
    pub low: [i64; 3],
    pub high: [i64; 3],
    /// Normal to the outside, on the grid: twice the area long.
    pub face: [i64; 3],
    /// Unit normal of the world.
    seen: DVec3,
    /// Unit normals of corners, in the world.
    normals: [DVec3; 3],
    /// Linear light.
    colours: [DVec3; 3],
}

impl LitSurface {
    pub(super) fn new(object: &SceneObject, light: DVec3) -> Self {
        let world_from_object = object.placements().next().unwrap_or(DAffine3::IDENTITY);
        let [r, g, b, _] = object.colour.map(f64::from);
        Self {
            attributes: object.attributes,
            two_sided: object.two_sided,
            unlit: object.unlit,
            colour: DVec3::new(r, g, b),
            normals: normal_matrix(world_from_object.matrix3),
            lamp: unit(light),
            linear: std::array::from_fn(|code| linear_from_srgb(code as u8)),
            display: Parameters::default(),
        }
    }

    pub(super) fn triangle(&self, corners: &[MeshVertex; 3]) -> LitTriangle {
        let places = corners.map(|it| it.place.map(i64::from));
        let [a, b, c] = places;
        let face = [(1, 2), (2, 0), (0, 1)]
            .map(|(u, v)| (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]));
        let in_world = |it: DVec3| unit(self.normals * it);
        let normal = |it: MeshVertex| match self.attributes.normals {
            true => in_world(DVec3::from(
                direction_from_octahedral(it.normal).map(f64::from),
            )),
            false => DVec3::ZERO,
        };
        let colour = |it: MeshVertex| match (self.attributes.colours, it.colour) {
            (true, [r, g, b, _]) => DVec3::from([r, g, b].map(|it| self.linear[usize::from(it)])),
            (false, _) => self.colour,
        };
        LitTriangle {
            places,
            low: [0, 1, 2].map(|axis| a[axis].min(b[axis]).min(c[axis])),
            high: [0, 1, 2].map(|axis| a[axis].max(b[axis]).max(c[axis])),
            face,
            seen: in_world(DVec3::from(face.map(|it| it as f64))),
            normals: corners.map(normal),
            colours: corners.map(colour),
        }
    }

    /// Whether a triangle has one light all over.
    pub(super) fn is_plain(&self) -> bool {
        (self.unlit || !self.attributes.normals) && !self.attributes.colours
    }

    /// Luminance in cd/m² of a place of a triangle, by its shares of the corners, seen from outside
    /// or from inside.
    pub(super) fn luminance(
        &self,
        triangle: &LitTriangle,
        shares: [f64; 3],
        is_outside: bool,
    ) -> f64 {
        let light = match self.unlit {
            true => 1.0,
            false => self.light_on(self.normal_at(triangle, shares, is_outside)),
        };
        let colour = (between(&triangle.colours, shares) * light).clamp(DVec3::ZERO, DVec3::ONE);
        self.display.luminance_from_linear(colour.to_array())
    }

    fn normal_at(&self, triangle: &LitTriangle, shares: [f64; 3], is_outside: bool) -> DVec3 {
        let seen = if is_outside {
            triangle.seen
        } else {
            -triangle.seen
        };
        if !self.attributes.normals {
            return seen;
        }
        let own = between(&triangle.normals, shares);
        let own = if own == DVec3::ZERO { seen } else { unit(own) };
        let turns = self.two_sided && own.dot(seen) < 0.0;
        if turns { -own } else { own }
    }

    fn light_on(&self, normal: DVec3) -> f64 {
        let [ground, sky, lamp] = [GROUND, SKY, LAMP].map(f64::from);
        let ambient = ground + (sky - ground) * (0.5 + 0.5 * normal.y);
        ambient + lamp * normal.dot(self.lamp).max(0.0)
    }
}

fn between([a, b, c]: &[DVec3; 3], shares: [f64; 3]) -> DVec3 {
    *a * shares[0] + *b * shares[1] + *c * shares[2]
}

fn unit(direction: DVec3) -> DVec3 {
    direction / direction.dot(direction).sqrt().max(1e-18)
}
