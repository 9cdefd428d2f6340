//! Which examples does the help of a command end with?

/// A command, and two lines that show it at work.
pub(crate) const ALL: [(&str, [&str; 2]); 43] = [
    (
        "prepare video",
        [
            "foveal prepare video my.mp4 --out my.foveal",
            "foveal prepare video sphere.png --projection equirect --out sphere.foveal",
        ],
    ),
    (
        "prepare scene",
        [
            "foveal prepare scene statue.glb --out statue.foveal",
            "foveal prepare scene statue.glb --dry-run",
        ],
    ),
    (
        "prepare formats",
        ["foveal prepare formats", "foveal prepare formats --json"],
    ),
    (
        "info",
        ["foveal info my.foveal", "foveal info statue.foveal --json"],
    ),
    (
        "verify",
        [
            "foveal verify my.foveal",
            "foveal verify statue.foveal --cuts 10 --orders 10",
        ],
    ),
    (
        "calibrate",
        [
            "foveal calibrate my.foveal --out calibrated.foveal",
            "foveal calibrate my.foveal --thorough --out thorough.foveal",
        ],
    ),
    (
        "select",
        [
            "foveal select --projection cube --face-size 4096 --policy acuity --random-gazes 300",
            "foveal select --projection flat --size 7680x4320 --preset kastner-2016",
        ],
    ),
    (
        "simulate",
        [
            "foveal simulate my.foveal --gaze scan --target 9.5 --score --out run",
            "foveal simulate my.foveal --gaze 10,5 --link 4mbit --pictures none --out linked",
        ],
    ),
    (
        "replay",
        [
            "foveal replay run/session.jsonl",
            "foveal replay run/session.jsonl --pack my.foveal --json",
        ],
    ),
    (
        "score",
        [
            "foveal score ref.png test.png --display standard_hmd --gaze 720,800",
            "foveal score my.mp4 my.foveal --gaze 10,5 --target 9.5",
        ],
    ),
    (
        "export site",
        [
            "foveal export site my.foveal --out site",
            "foveal export site my.foveal statue.foveal --title Samples --out site",
        ],
    ),
    (
        "perception table",
        [
            "foveal perception table",
            "foveal perception table --ecc 0,10,20 --cpd 1,4,16 --luminance 50",
        ],
    ),
    (
        "perception bands",
        [
            "foveal perception bands a.png --gaze 480,270 --fov 48 --out bands",
            "foveal perception bands a.png --gaze 480,270 --fov 48 --spread 2 --out bands",
        ],
    ),
    (
        "perception importance",
        [
            "foveal perception importance a.png b.png --gaze 480,270 --fov 48 --out heat.png",
            "foveal perception importance a.png b.png --gaze 480,270 --fov 48 --mode landed \
             --out landed.png",
        ],
    ),
    (
        "view",
        [
            "foveal view my.foveal --demo",
            "foveal view statue.foveal --policy acuity --gaze scan",
        ],
    ),
    (
        "demo",
        [
            "foveal demo --out demo",
            "foveal demo --input my.mp4 --out demo",
        ],
    ),
    (
        "serve",
        [
            "foveal serve my.foveal",
            "foveal serve my.foveal statue.foveal --allow-origin https://example.org",
        ],
    ),
    (
        "evaluate policies",
        [
            "foveal evaluate policies my.foveal --source my.mp4 --out compared",
            "foveal evaluate policies my.foveal --gaze scan --targets 9,9.5 --out compared",
        ],
    ),
    (
        "evaluate codecs",
        [
            "foveal evaluate codecs my.mp4",
            "foveal evaluate codecs my.mp4 --codecs vp9,jpeg90 --frames 8 --play 10",
        ],
    ),
    (
        "evaluate grid-sweep",
        [
            "foveal evaluate grid-sweep my.mp4",
            "foveal evaluate grid-sweep my.mp4 --grids 2,4 --levels 3 --frames 8 --play 10",
        ],
    ),
    (
        "evaluate goldens",
        ["foveal evaluate goldens", "foveal evaluate goldens G1 G2"],
    ),
    (
        "evaluate targets",
        [
            "foveal evaluate targets",
            "foveal evaluate targets --seeds 8 --input my.mp4",
        ],
    ),
    (
        "bench perception",
        [
            "foveal bench perception",
            "foveal bench perception --runs 3 --json",
        ],
    ),
    (
        "bench prepare",
        [
            "foveal bench prepare",
            "foveal bench prepare --input my.mp4 --frames 8",
        ],
    ),
    (
        "bench score",
        [
            "foveal bench score",
            "foveal bench score --no-baseline --runs 1",
        ],
    ),
    (
        "bench video",
        [
            "foveal bench video my.foveal",
            "foveal bench video my.foveal --original my.mp4 --target 9",
        ],
    ),
    (
        "bench scene",
        [
            "foveal bench scene my.glb",
            "foveal bench scene statue.foveal --only decode,choose",
        ],
    ),
    (
        "panels fit",
        [
            "foveal panels fit examples/panels/twelve.toml",
            "foveal panels fit examples/panels/three.toml --source 1600x1200",
        ],
    ),
    (
        "panels map",
        [
            "foveal panels map examples/panels/three.toml --at C:400,300",
            "foveal panels map examples/panels/three.toml --format mpcdi --out maps",
        ],
    ),
    (
        "panels import",
        [
            "foveal panels import maps/three.mpcdi --out imported.toml",
            "foveal panels import wall.obj \
             --projector \"left at=0,0,3 pixels=1920x1080 throw=1.5\" --out lit.toml",
        ],
    ),
    (
        "panels warp",
        [
            "foveal panels warp examples/panels/twelve.toml world:valley --out panels",
            "foveal panels warp examples/panels/three.toml my.mp4 --frames 2 --out panels",
        ],
    ),
    (
        "panels bench",
        [
            "foveal panels bench examples/panels/three.toml --panels 3,6",
            "foveal panels bench examples/panels/twelve.toml --model seed",
        ],
    ),
    (
        "panels figures",
        [
            "foveal panels figures examples/panels/twelve.toml --out figures",
            "foveal panels figures examples/panels/three.toml --placement seed --out figures",
        ],
    ),
    (
        "panels pattern",
        [
            "foveal panels pattern grid --size 1920x1080 --out grid.png",
            "foveal panels pattern numbers --size 1280x800 --out numbers.png",
        ],
    ),
    (
        "panels schema",
        ["foveal panels schema", "foveal panels schema --json"],
    ),
    (
        "gaze eval head",
        [
            "foveal gaze eval head --data first.csv second.csv",
            "foveal gaze eval head --data first.csv second.csv --leave-one-out --json",
        ],
    ),
    (
        "gaze eval delay",
        [
            "foveal gaze eval delay --data first.csv second.csv",
            "foveal gaze eval delay --data first.csv --delays 100,300 --plot delay.svg",
        ],
    ),
    (
        "gaze eval saccade",
        [
            "foveal gaze eval saccade",
            "foveal gaze eval saccade --data labelled.csv",
        ],
    ),
    (
        "gaze eval landing",
        [
            "foveal gaze eval landing",
            "foveal gaze eval landing --data labelled.csv",
        ],
    ),
    (
        "gaze eval filter",
        [
            "foveal gaze eval filter",
            "foveal gaze eval filter --data labelled.csv",
        ],
    ),
    (
        "gaze fit head",
        [
            "foveal gaze fit head --data first.csv second.csv --out mine.toml",
            "foveal gaze fit head --data first.csv --out first.toml --json",
        ],
    ),
    (
        "gaze classify",
        [
            "foveal gaze classify gaze.csv --out events.csv",
            "foveal gaze classify tracker.csv --gaze-columns time_ms,x,y \
             --gaze-screen 0.52x0.29m,1920x1080,0.6m",
        ],
    ),
    (
        "gaze record",
        [
            "foveal gaze record --gaze udp:5005 --out gaze.csv",
            "foveal gaze record --gaze scan --seconds 1 --out scan.csv",
        ],
    ),
];

/// The program with two examples at the end of the help of each of these commands.
pub(crate) fn attached(program: clap::Command) -> clap::Command {
    ALL.iter().fold(program, |program, (path, lines)| {
        attached_at(program, &path.split(' ').collect::<Vec<_>>(), lines)
    })
}

fn attached_at(command: clap::Command, path: &[&str], lines: &[&str; 2]) -> clap::Command {
    let Some((name, rest)) = path.split_first() else {
        let before = command
            .get_after_help()
            .map(|text| format!("{}\n\n", text.to_string().trim_end()));
        let before = before.unwrap_or_default();
        let [first, second] = lines;
        return command.after_help(format!("{before}Examples:\n  {first}\n  {second}"));
    };
    match command.find_subcommand(name).is_some() {
        true => command.mut_subcommand(name, |command| attached_at(command, rest, lines)),
        false => command,
    }
}
