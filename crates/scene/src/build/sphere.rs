//! Which sphere encloses the spheres of finer groups?

/// A sphere in an object's space, from the origin of its grid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub(super) struct LocalSphere {
    /// Its centre.
    pub centre: [f32; 3],
    /// Its radius.
    pub radius: f32,
}

impl LocalSphere {
    /// A small sphere that encloses all of these, of which there is at least one: exactly so with
    /// these rounded numbers.
    pub(super) fn round(spheres: &[LocalSphere]) -> Self {
        let bytes = meshopt::typed_to_bytes(spheres);
        let centres = meshopt::PositionDataAdapter {
            data: bytes,
            position_count: spheres.len(),
            position_stride: size_of::<LocalSphere>(),
            position_offset: 0,
        };
        let radii = meshopt::RadiusDataAdapter {
            data: bytes,
            radius_count: spheres.len(),
            radius_stride: size_of::<LocalSphere>(),
            radius_offset: 12,
        };
        let centre = meshopt::compute_sphere_bounds(centres, Some(radii)).center;
        let reach = spheres
            .iter()
            .map(|it| it.reach(centre))
            .fold(0.0, f64::max);
        let nearest = reach as f32;
        let radius = match f64::from(nearest) < reach {
            true => nearest.next_up(),
            false => nearest,
        };
        Self { centre, radius }
    }

    /// How far it reaches from a point.
    pub(super) fn reach(&self, from: [f32; 3]) -> f64 {
        let along = |axis: usize| f64::from(self.centre[axis]) - f64::from(from[axis]);
        let square: f64 = [0, 1, 2].map(along).iter().map(|it| it * it).sum();
        square.sqrt() + f64::from(self.radius)
    }
}
