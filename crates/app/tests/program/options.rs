//! Is an option without effect reported or refused?

use crate::scenes::{waves, write_clip};
use crate::support::{Folder, done, refused};

const SELECT: [&str; 6] = [
    "select",
    "--projection",
    "cube",
    "--face-size",
    "256",
    "--tile",
];

#[test]
fn an_option_of_another_policy_is_told() {
    let told = |policy: &str, options: &[&str]| {
        let common = [&SELECT[..], &["64", "--policy", policy]].concat();
        done(&[&common, options].concat()).stderr
    };
    let said = told("acuity", &["--samples", "5", "--edge-margin", "1"]);
    assert!(said.contains("--samples changes nothing with --policy acuity"));
    assert!(said.contains("--edge-margin changes nothing") && said.contains("it is for grid"));
    assert_eq!(told("grid", &["--edge-margin", "1"]), "");
    assert_eq!(
        told("acuity", &["--safety-disc", "1", "--slope", "0.011"]),
        ""
    );
    assert!(told("full", &["--slope", "1"]).contains("--slope changes nothing"));
}

#[test]
fn options_that_contradict_the_content_or_each_other_are_refused_or_told() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([96, 64], 2));
    let (pack, out) = (folder.name("a.foveal"), folder.name("run"));
    refused(
        2,
        &[
            "prepare",
            "video",
            &clip,
            "--out",
            &pack,
            "--codec",
            "png",
            "--quality",
            "3",
        ],
        &["--quality", "lossless"],
    );
    done(&["prepare", "video", &clip, "--out", &pack]);
    let simulate = ["simulate", &pack, "--out", &out, "--renderer", "none"];
    let with = |options: &[&'static str]| [&simulate[..], options].concat();
    refused(2, &with(&["--blur", "on"]), &["--renderer none", "--blur"]);
    for fov in ["0", "nan", "360"] {
        refused(2, &with(&["--fov", fov]), &["--fov", "1 to 170 degrees"]);
    }
    let eyes = done(&with(&["--eye", "both"])).stderr;
    assert!(eyes.contains("one picture for both eyes"), "{eyes}");
    let field = done(&with(&["--fov", "60"])).stderr;
    assert!(
        field.contains("--fov changes nothing for flat content"),
        "{field}"
    );
    refused(
        2,
        &with(&["--preset", "kastner"]),
        &["--preset is kastner", "kastner-2016"],
    );
    let video = std::fs::read(&clip).unwrap();
    let precious = folder.holding("precious.mkv", &video);
    refused(
        2,
        &["prepare", "video", &clip, "--out", &precious],
        &["precious.mkv", "not a pack", "another --out"],
    );
    assert_eq!(std::fs::read(&precious).unwrap(), video);
    refused(1, &["info", &clip], &["foveal prepare video", "a.mkv"]);
    refused(2, &with(&["--screen", "24"]), &["24,0.6"]);
    refused(2, &with(&["--screen", "-3,0"]), &["inches"]);
    refused(
        1,
        &["info", &folder.name(".")],
        &["is a folder", "foveal prepare"],
    );
}

#[test]
fn the_help_names_one_default_of_the_policy_of_a_window() {
    for help in ["-h", "--help"] {
        let told = done(&["view", help]).stdout;
        let from = told.find("--policy").unwrap();
        let policy = &told[from..from + told[from..].find("--target").unwrap()];
        let words = policy.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(
            words.contains("by viewport, or with --demo by perceptual"),
            "{policy}"
        );
        assert!(!policy.contains("default"), "{policy}");
    }
}

#[test]
fn a_negative_number_is_a_value_out_of_range_not_an_unknown_option() {
    for option in ["--start", "--frames"] {
        let words = ["invalid value '-3'", option];
        refused(
            2,
            &["simulate", "a.foveal", "--out", "run", option, "-3"],
            &words,
        );
    }
}
