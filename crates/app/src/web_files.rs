//! Which files of the built page does the program carry?

/// A file of the page, by the name that pages load it by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WebFile {
    /// Relative to the page, with `/` between folders.
    pub(crate) name: &'static str,
    pub(crate) bytes: &'static [u8],
}

/// Every file of the page but what is made for the packs at hand; none where the program was built
/// before the page.
pub(crate) fn web_files() -> &'static [WebFile] {
    include!(concat!(env!("OUT_DIR"), "/web_files.rs"))
}
