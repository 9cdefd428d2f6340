//! Which examples does the help of a command end with?

/// A command, and lines that show it at work.
pub(crate) const ALL: [(&str, &str); 18] = [
    (
        "prepare video",
        "foveal prepare video my.mp4 --out my.foveal",
    ),
    (
        "prepare scene",
        "foveal prepare scene statue.glb --out statue.foveal",
    ),
    ("info", "foveal info my.foveal"),
    ("verify", "foveal verify my.foveal"),
    (
        "select",
        "foveal select --projection cube --face-size 4096 --policy acuity --random-gazes 300",
    ),
    (
        "simulate",
        "foveal simulate my.foveal --gaze scan --target 9.5 --score --out run",
    ),
    ("replay", "foveal replay run/session.jsonl"),
    (
        "score",
        "foveal score ref.png test.png --display standard_hmd --gaze 720,800",
    ),
    ("export site", "foveal export site my.foveal --out site"),
    (
        "perception importance",
        "foveal perception importance a.png b.png --gaze 480,270 --fov 48 --out heat.png",
    ),
    ("view", "foveal view my.foveal --demo"),
    ("serve", "foveal serve my.foveal"),
    (
        "evaluate policies",
        "foveal evaluate policies my.foveal --source my.mp4 --out compared",
    ),
    ("evaluate codecs", "foveal evaluate codecs my.mp4"),
    ("bench video", "foveal bench video my.foveal"),
    ("bench scene", "foveal bench scene my.glb"),
    (
        "panels fit",
        "foveal panels fit examples/panels/twelve.toml",
    ),
    (
        "panels warp",
        "foveal panels warp examples/panels/twelve.toml world:valley --out panels",
    ),
];

/// The program with an example at the end of the help of each of these commands. A command that
/// ends its help with something else keeps that, after the example.
pub(crate) fn attached(program: clap::Command) -> clap::Command {
    ALL.iter().fold(program, |program, (path, line)| {
        attached_at(program, &path.split(' ').collect::<Vec<_>>(), line)
    })
}

fn attached_at(command: clap::Command, path: &[&str], line: &str) -> clap::Command {
    let Some((name, rest)) = path.split_first() else {
        let more = command.get_after_help().map(|more| format!("\n\n{more}"));
        return command.after_help(format!("Example:\n  {line}{}", more.unwrap_or_default()));
    };
    match command.find_subcommand(name).is_some() {
        true => command.mut_subcommand(name, |command| attached_at(command, rest, line)),
        false => command,
    }
}
