//! Is a file as people have it shown, and are repairs in it reported?
//!
//! Inputs are made here, after what users of other players, viewers and converters reported.

mod assemblies;
mod broken;
mod broken_films;
mod cameras;
mod colours;
mod ends;
mod film_file;
mod films;
mod gltf;
mod las;
mod layouts;
mod lenient;
mod meshes;
mod not_the_file;
mod numbers;
mod odd_films;
mod odd_layouts;
mod odd_meshes;
mod odd_points;
mod odd_stills;
mod outliers;
mod panels;
mod paths;
mod row;
mod stills;

use crate::support::done;

#[test]
fn the_page_on_inputs_is_what_the_program_prints() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/formats/inputs.md");
    let page = std::fs::read_to_string(path).unwrap();
    let told = done(&["prepare", "formats"]).stdout;
    assert!(
        page == told,
        "docs/formats/inputs.md: write it again by `foveal prepare formats > {path}`"
    );
}
