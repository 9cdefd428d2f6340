//! Which filters does a graph of FFmpeg name, and may they run?
//!
//! A graph may come from a page or a friend, and filters of FFmpeg read and write files, and fetch
//! from the network. Only those of a list run, none of which has an option that names a file or an
//! address. The graph is taken apart exactly as FFmpeg does it (libavfilter/graphparser.c,
//! libavutil/avstring.c: `av_get_token`), so that quotes hide nothing.

/// What makes pictures.
pub const SOURCES: [&str; 21] = [
    "allrgb",
    "allyuv",
    "color",
    "colorchart",
    "colorspectrum",
    "gradients",
    "haldclutsrc",
    "mandelbrot",
    "mptestsrc",
    "nullsrc",
    "pal100bars",
    "pal75bars",
    "perlin",
    "rgbtestsrc",
    "sierpinski",
    "smptebars",
    "smptehdbars",
    "testsrc",
    "testsrc2",
    "yuvtestsrc",
    "zoneplate",
];

/// What changes pictures, and keeps few of them.
pub const FILTERS: [&str; 79] = [
    "alphaextract",
    "alphamerge",
    "avgblur",
    "bilateral",
    "blend",
    "boxblur",
    "bwdif",
    "chromakey",
    "chromashift",
    "colorbalance",
    "colorchannelmixer",
    "colorcontrast",
    "colorcorrect",
    "colorize",
    "colorkey",
    "colorlevels",
    "colorspace",
    "colortemperature",
    "convolution",
    "copy",
    "crop",
    "dilation",
    "drawbox",
    "drawgrid",
    "edgedetect",
    "eq",
    "erosion",
    "exposure",
    "fade",
    "fillborders",
    "format",
    "fps",
    "framerate",
    "framestep",
    "gblur",
    "geq",
    "hflip",
    "hstack",
    "hue",
    "lagfun",
    "lenscorrection",
    "limiter",
    "lut",
    "lutrgb",
    "lutyuv",
    "median",
    "mergeplanes",
    "monochrome",
    "negate",
    "noise",
    "normalize",
    "null",
    "overlay",
    "pad",
    "perspective",
    "pixelize",
    "premultiply",
    "pseudocolor",
    "rgbashift",
    "rotate",
    "scale",
    "scroll",
    "setdar",
    "setpts",
    "setsar",
    "settb",
    "shear",
    "split",
    "stereo3d",
    "tblend",
    "transpose",
    "trim",
    "unpremultiply",
    "unsharp",
    "v360",
    "vflip",
    "vignette",
    "vstack",
    "zoompan",
];

/// Longest graph, in bytes.
const MOST_BYTES: usize = 1 << 16;
const WHITE: &[u8] = b" \n\t\r";

/// Refuses a graph of which a part may do something else than make pictures, and says which.
pub(super) fn check(graph: &str) -> Result<(), String> {
    if graph.len() > MOST_BYTES {
        return Err(format!("it is longer than {MOST_BYTES} bytes"));
    }
    for Filter { name, options } in filters_of(graph.as_bytes())? {
        let kind = name.split('@').next().unwrap_or_default();
        if !SOURCES.contains(&kind) && !FILTERS.contains(&kind) {
            return Err(format!(
                "its filter {:?} is not one of those that run here: FFmpeg's filters may read \
                 and write files and fetch from the network, and only sources and filters of \
                 pictures that cannot are let in",
                begin_of(kind)
            ));
        }
        // Later versions of FFmpeg read an option's value from a file where a slash stands before
        // its name.
        if options.starts_with('/') || options.contains(":/") {
            return Err(format!(
                "an option of its filter {kind} is read from a file, which is not done here"
            ));
        }
    }
    Ok(())
}

/// As much of a text as a message needs.
fn begin_of(text: &str) -> String {
    text.chars().take(40).collect()
}

/// A filter as it stands in a graph.
#[derive(Debug, PartialEq, Eq)]
struct Filter {
    name: String,
    /// Without the quotes of the graph.
    options: String,
}

/// The filters of a graph in their order.
fn filters_of(graph: &[u8]) -> Result<Vec<Filter>, String> {
    let mut at = 0;
    if graph.starts_with(b"sws_flags=") {
        let end = graph.iter().position(|it| *it == b';');
        at = end.ok_or("no `;` ends its sws_flags")? + 1;
    }
    let mut filters = Vec::new();
    loop {
        skip_white(graph, &mut at);
        skip_labels(graph, &mut at)?;
        let name = token(graph, &mut at, b"=,;[");
        let mut options = String::new();
        if graph.get(at) == Some(&b'=') {
            at += 1;
            options = token(graph, &mut at, b"[],;");
        }
        filters.push(Filter { name, options });
        skip_labels(graph, &mut at)?;
        skip_white(graph, &mut at);
        match graph.get(at) {
            None => return Ok(filters),
            Some(b',' | b';') => at += 1,
            Some(_) => {
                let rest = String::from_utf8_lossy(&graph[at..]);
                return Err(format!("it cannot be read at {:?}", begin_of(&rest)));
            }
        }
    }
}

fn skip_white(graph: &[u8], at: &mut usize) {
    while graph.get(*at).is_some_and(|it| WHITE.contains(it)) {
        *at += 1;
    }
}

/// Names of links in brackets.
fn skip_labels(graph: &[u8], at: &mut usize) -> Result<(), String> {
    while graph.get(*at) == Some(&b'[') {
        *at += 1;
        token(graph, at, b"]");
        if graph.get(*at) != Some(&b']') {
            return Err("no `]` ends a link of it".to_owned());
        }
        *at += 1;
        skip_white(graph, at);
    }
    Ok(())
}

/// What stands before one of `ends`, without quotes and backslashes, and without white space
/// around what is not quoted.
fn token(graph: &[u8], at: &mut usize, ends: &[u8]) -> String {
    skip_white(graph, at);
    let mut taken = Vec::new();
    // Quoted white space stays.
    let mut kept = 0;
    while let Some(byte) = graph.get(*at).filter(|it| !ends.contains(it)) {
        *at += 1;
        match (byte, graph.get(*at)) {
            (b'\\', Some(escaped)) => {
                taken.push(*escaped);
                *at += 1;
                kept = taken.len();
            }
            (b'\'', _) => {
                let rest = &graph[*at..];
                let quoted = rest.iter().position(|it| *it == b'\'');
                taken.extend_from_slice(&rest[..quoted.unwrap_or(rest.len())]);
                *at += quoted.map_or(rest.len(), |length| length + 1);
                if quoted.is_some() {
                    kept = taken.len();
                }
            }
            _ => taken.push(*byte),
        }
    }
    while taken.len() > kept && taken.last().is_some_and(|it| WHITE.contains(it)) {
        taken.pop();
    }
    String::from_utf8_lossy(&taken).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ffmpeg_next::ffi;
    use proptest::prelude::*;

    fn names(graph: &str) -> Vec<String> {
        let filters = filters_of(graph.as_bytes()).unwrap();
        filters.into_iter().map(|it| it.name).collect()
    }

    #[test]
    fn a_graph_is_taken_apart_as_ffmpeg_does_it() {
        for (graph, expected) in [
            ("testsrc2", &["testsrc2"][..]),
            (" color = c=red : s=64x48 ", &["color"]),
            ("color=c=red,hue=h=9[a];[a]null", &["color", "hue", "null"]),
            ("sws_flags=bicubic;color", &["color"]),
            ("[in] [two] overlay@top=1:2 [o]", &["overlay@top"]),
            // Quotes and backslashes hide nothing, and what they hide is no filter.
            ("color,mo\\vie=x", &["color", "movie"]),
            ("color,'movie'=x", &["color", "movie"]),
            ("geq=lum='a,movie=x'", &["geq"]),
            ("geq=lum=a\\,b,null", &["geq", "null"]),
            ("[a,movie=x]null", &["null"]),
            ("color,geq='unclosed,movie=x", &["color", "geq"]),
            ("color]", &["color]"]),
        ] {
            assert_eq!(names(graph), expected, "{graph}");
        }
        for graph in ["[a", "color=a]", "sws_flags=1"] {
            assert!(filters_of(graph.as_bytes()).is_err(), "{graph}");
        }
    }

    #[test]
    fn what_may_do_more_than_make_pictures_is_refused_by_name() {
        for graph in [
            "testsrc2",
            "testsrc2=size=64x48:rate=30000/1001,scale=iw/2:-1,hue=H=2*PI*t",
            "color[a];mandelbrot[b];[a][b]hstack",
            "color=c=0x2060a0:size=64x48:rate=50:duration=0.5",
        ] {
            assert_eq!(check(graph), Ok(()), "{graph}");
        }
        for (graph, name) in [
            ("movie=/etc/passwd", "movie"),
            ("testsrc2,metadata=print:file=x", "metadata"),
            ("testsrc2,metadata@null=print:file=x", "metadata"),
            ("color,mo\\vie=http\\\\://a", "movie"),
            ("[x]\nmovie=a", "movie"),
            ("testsrc2[a];movie=b[b];[a][b]overlay", "movie"),
            ("testsrc2,curves=plot=x", "curves"),
            ("frei0r_src=64x48:x", "frei0r_src"),
            ("life=filename=x", "life"),
            ("testsrc2,scale=/w=x", "scale"),
            ("testsrc2,scale=h=2:/w=x", "scale"),
            ("no_such_filter", "no_such_filter"),
            ("", ""),
        ] {
            let why = check(graph).unwrap_err();
            assert!(why.contains(name), "{graph}: {why}");
        }
    }

    /// The beginning of FFmpeg's `AVFilter`.
    #[repr(C)]
    struct AvFilter {
        names: [*const std::ffi::c_char; 2],
        pads: [*const std::ffi::c_void; 2],
        class: *const ffi::AVClass,
    }

    #[allow(unsafe_code)] // ffmpeg-next has filters only with a part of FFmpeg that nothing needs.
    #[link(name = "avfilter")]
    unsafe extern "C" {
        fn avfilter_get_by_name(name: *const std::ffi::c_char) -> *const AvFilter;
    }

    /// Names of the options of a filter of the FFmpeg that is there; none where it has it not.
    #[allow(unsafe_code)]
    fn options_of(name: &str) -> Vec<String> {
        let name = std::ffi::CString::new(name).unwrap();
        let mut options = Vec::new();
        // SAFETY: the name ends in NUL. A filter and its class are constants of the library, whose
        // options end where `av_opt_next` gives none; an object begins with its class.
        unsafe {
            let filter = avfilter_get_by_name(name.as_ptr());
            let class = filter.as_ref().map(|it| it.class);
            let Some(class) = class.filter(|it| !it.is_null()) else {
                return options;
            };
            let object: *const _ = &raw const class;
            let mut option = ffi::av_opt_next(object.cast(), std::ptr::null());
            while let Some(it) = option.as_ref() {
                let name = std::ffi::CStr::from_ptr(it.name);
                options.push(name.to_string_lossy().into_owned());
                option = ffi::av_opt_next(object.cast(), option);
            }
        }
        options
    }

    #[test]
    fn no_filter_of_the_list_has_an_option_that_names_a_file() {
        crate::ffmpeg::start();
        let mut seen = 0;
        for filter in SOURCES.iter().chain(&FILTERS) {
            let options = options_of(filter);
            seen += options.len();
            for option in options {
                let names_a_file = ["file", "path", "url", "model", "plot", "kdtree", "addr"]
                    .iter()
                    .any(|part| option.contains(part));
                assert!(!names_a_file, "{filter}: {option}");
            }
        }
        assert!(seen > 300, "{seen} options");
        assert!(options_of("movie").contains(&"filename".to_owned()));
    }

    proptest! {
        #[test]
        fn any_text_is_taken_apart(text in "[a-z=,;\\[\\]'\\\\ @/:]{0,40}") {
            let _ = check(&text);
        }
    }
}
