//! Is every shader valid, and laid out as the Rust structs are?

use foveal_core::view::surface::Projection;
use foveal_render::importance::{BandParams, EyeParams};
use foveal_render::params::{
    BlurParams, HalvedParams, Overlay, SparseParams, TileParams, ViewParams,
};
use foveal_render::points::params::{CloudViewParams, CubeParams};
use foveal_render::points::pass::draw_points;
use foveal_render::scene::footprints::GazedParams;
use foveal_render::scene::params::{HalvingParams, PlacementParams, SceneParams};
use foveal_render::shaders::{
    Shader, blur_halve, blur_radial, cull_clusters, draw_clusters, footprints, halve_depths,
    halve_tiles, importance, interpolate_sparse, mark_units, overlay, reconstruct,
    reconstruct_textures, reduce_source, warp,
};
use foveal_render::warp::params::{BlendParams, PanelParams, SightParams, WarpParams};
use naga::proc::Layouter;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{Module, TypeInner};
use std::mem::offset_of;

fn all() -> Vec<(Shader, Projection)> {
    [Projection::Flat, Projection::Cube, Projection::Equirect]
        .into_iter()
        .flat_map(|p| {
            let over_tiles = [
                reconstruct,
                overlay,
                interpolate_sparse,
                reconstruct_textures,
            ];
            over_tiles.map(|shader| (shader(p), p))
        })
        .collect()
}

fn parsed(shader: &Shader) -> Module {
    naga::front::wgsl::parse_str(&shader.text)
        .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&shader.text)))
}

/// Size of a struct and the offsets of its members.
fn layout(module: &Module, name: &str) -> (u32, Vec<(String, u32)>) {
    let mut layouter = Layouter::default();
    layouter.update(module.to_ctx()).unwrap();
    let (handle, ty) = module
        .types
        .iter()
        .find(|(_, ty)| ty.name.as_deref() == Some(name))
        .unwrap_or_else(|| panic!("no struct {name}"));
    let TypeInner::Struct { members, .. } = &ty.inner else {
        panic!("{name} is no struct")
    };
    let members = members
        .iter()
        .map(|m| (m.name.clone().unwrap(), m.offset))
        .collect();
    (layouter[handle].size, members)
}

macro_rules! same_layout {
    ($module:expr, $name:literal, $ty:ty, [$($field:ident),*]) => {
        let expected = vec![$((stringify!($field).to_owned(), offset_of!($ty, $field) as u32)),*];
        assert_eq!(layout(&$module, $name), (size_of::<$ty>() as u32, expected), $name);
    };
}

#[test]
fn what_is_drawn_over_a_picture_is_valid_with_no_capability_that_a_browser_lacks() {
    for shader in [blur_halve(), blur_radial(), halve_tiles(), mark_units()] {
        let module = parsed(&shader);
        Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{}: {e:?}", shader.name));
    }
    same_layout!(
        parsed(&halve_tiles()),
        "Halved",
        HalvedParams,
        [first, size, low, high, shift, layer, ratio]
    );
    let module = parsed(&blur_radial());
    same_layout!(
        module,
        "Blur",
        BlurParams,
        [
            ray_from_pixel,
            gaze,
            fovea_chord,
            fovea,
            growth,
            pitch,
            last,
            first,
            unused,
            unused_pair
        ]
    );
}

#[test]
fn the_pass_that_adds_up_footprints_is_valid_with_no_capability_that_a_browser_lacks() {
    let text = footprints().text;
    let module = naga::front::wgsl::parse_str(&text)
        .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text)));
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .unwrap();
    same_layout!(module, "Gazed", GazedParams, [field, gaze, unused]);
}

#[test]
fn the_passes_that_halve_depths_are_valid_with_no_capability_that_a_browser_lacks() {
    let [first, further] = halve_depths();
    assert_eq!(first.text, further.text);
    let module = naga::front::wgsl::parse_str(&first.text)
        .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&first.text)));
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .unwrap();
    same_layout!(module, "Halving", HalvingParams, [picture, level, unused]);
}

#[test]
fn the_passes_of_meshes_are_valid_with_no_capability_that_a_browser_lacks() {
    let (draw, cull) = (draw_clusters(), cull_clusters());
    for (name, text) in [(draw.name, draw.text), (cull.name, cull.text)] {
        let module = naga::front::wgsl::parse_str(&text)
            .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text)));
        Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{name}: {e:?}"));
        assert!(!text.contains("enable "), "{name}");
        same_layout!(
            module,
            "Scene",
            SceneParams,
            [
                clip_from_view,
                field,
                light,
                near,
                up,
                tint,
                coarsest,
                culls,
                picture
            ]
        );
        same_layout!(
            module,
            "Placement",
            PlacementParams,
            [
                view_from_grid,
                normal_from_object,
                eye_in_grid,
                colour,
                uv_from_grid,
                flags,
                textures,
                unused_pair
            ]
        );
    }
}

#[test]
fn the_passes_that_fill_panels_are_valid_with_no_capability_that_a_browser_lacks() {
    for shader in [warp(), reduce_source()] {
        let module = parsed(&shader);
        Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{}: {e:?}", shader.name));
        assert!(!shader.text.contains("enable "), "{}", shader.name);
    }
    let module = parsed(&warp());
    assert_eq!(size_of::<PanelParams>(), 128);
    same_layout!(
        module,
        "Panel",
        PanelParams,
        [
            right, projection, down, black, corner, blend, origin, size, scale, offset, low, high,
            gain, grid, cell, channels, alpha, sight
        ]
    );
    same_layout!(
        module,
        "Sight",
        SightParams,
        [world_from_source, source_from_world]
    );
    same_layout!(
        module,
        "Blend",
        BlendParams,
        [
            right,
            sharpness,
            down,
            first,
            corner,
            count,
            chart_right,
            most,
            chart_down,
            field,
            chart_axis,
            per_step,
            low,
            nodes
        ]
    );
    same_layout!(
        module,
        "Warp",
        WarpParams,
        [
            atlas,
            spread,
            filter_by,
            last,
            most_probes,
            paints,
            by_device,
            unused
        ]
    );
}

#[test]
fn the_pass_of_points_is_valid_with_no_capability_that_a_browser_lacks() {
    let module = parsed(&draw_points());
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .unwrap_or_else(|e| panic!("{e:?}"));
    same_layout!(
        module,
        "CloudView",
        CloudViewParams,
        [half_pixel, unused_pair]
    );
    same_layout!(
        module,
        "Cube",
        CubeParams,
        [
            view_from_cube,
            spacing,
            level,
            unused_pair,
            octants,
            refiners
        ]
    );
}

#[test]
fn every_shader_is_valid_with_no_capability_that_a_browser_lacks() {
    for (shader, projection) in all() {
        let module = parsed(&shader);
        Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{} {projection:?}: {e:?}", shader.name));
        let entries: Vec<&str> = module
            .entry_points
            .iter()
            .map(|e| e.name.as_str())
            .collect();
        for entry in shader.steps.iter().flatten() {
            assert!(
                entries.contains(entry),
                "{} has no entry {entry}",
                shader.name
            );
        }
        assert!(
            !shader.text.contains("enable "),
            "directives differ between naga and browsers"
        );
    }
}

#[test]
fn every_pass_of_importance_is_valid_with_no_capability_that_a_browser_lacks() {
    for shader in importance() {
        let module = naga::front::wgsl::parse_str(&shader.text)
            .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&shader.text)));
        Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{}: {e:?}", shader.name));
        let entries = module.entry_points.iter().map(|e| e.name.as_str());
        assert_eq!(entries.collect::<Vec<_>>(), [shader.name]);
        assert!(!shader.text.contains("enable "), "{}", shader.name);
        same_layout!(
            module,
            "Band",
            BandParams,
            [
                fine,
                coarse,
                picture,
                side,
                contrast_scale,
                octave,
                has_coarser
            ]
        );
        if !["seen", "gain", "accumulate"].contains(&shader.name) {
            continue;
        }
        same_layout!(
            module,
            "Eye",
            EyeParams,
            [
                gaze_from_pixel,
                acuity,
                constant,
                error,
                popping,
                omega,
                density_octave,
                display_octave,
                quanta,
                most_quanta,
                by_area,
                first_chord,
                chords_per_octave,
                first_octave,
                entries_per_octave,
                rows_per_octave,
                row_growth
            ]
        );
    }
}

#[test]
fn uniforms_have_one_layout_in_rust_and_in_wgsl() {
    for (shader, _) in all() {
        let module = parsed(&shader);
        same_layout!(
            module,
            "Tiles",
            TileParams,
            [
                size,
                segment,
                cell,
                base_span,
                cells,
                segments,
                base_step,
                base_face,
                base_across,
                slot,
                coarsest,
                octaves,
                span_octaves,
                growth,
                coarsest_scale,
                chroma_offset,
                faces_of_an_eye,
                mapping,
                rgb_from_yuv
            ]
        );
        same_layout!(module, "View", ViewParams, [content_from_pixel, first_face]);
        if shader.name == "interpolate_sparse" {
            same_layout!(
                module,
                "Sparse",
                SparseParams,
                [
                    corner,
                    side,
                    blends,
                    spacing_step,
                    unused,
                    unused_pair,
                    spacings
                ]
            );
        }
        if shader.name == "overlay" {
            same_layout!(
                module,
                "Overlay",
                Overlay,
                [gaze, gaze_radius, heat, borders, unused]
            );
        }
    }
}
