//! How does a wasm module become something that a page can import?
//!
//! `web-bindgen MODULE FOLDER`: wasm-bindgen as a library, of the very version that
//! `crates/web` is compiled with, so that no other tool has to be installed.

use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [module, folder] = arguments.as_slice() else {
        eprintln!("web-bindgen MODULE FOLDER");
        return ExitCode::from(2);
    };
    let made = wasm_bindgen_cli_support::Bindgen::new()
        .input_path(module)
        .out_name("foveal")
        .web(true)
        .map(|bindgen| {
            bindgen
                .typescript(true)
                .omit_default_module_path(false)
                .remove_name_section(true)
                .remove_producers_section(true)
        })
        .and_then(|bindgen| bindgen.generate(folder));
    match made {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("web-bindgen: {module}: {error:#}");
            ExitCode::FAILURE
        }
    }
}
