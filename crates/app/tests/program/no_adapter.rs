//! What does a machine without any GPU driver get?

use crate::scenes::{noisy_clip, waves, write_clip};
use crate::support::{Folder, Ran, assert_refused, command, done, finish, frame_picture, json};

/// Largest difference of a channel in 255ths between the GPU's picture and its CPU twin's.
const TWIN: u8 = 3;

/// Runs the program on a machine that has no Vulkan driver.
fn without_drivers(arguments: &[&str]) -> Ran {
    let mut command = command(arguments);
    for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        command.env(variable, "/nonexistent/driver.json");
    }
    finish(command)
}

#[test]
fn without_an_adapter_the_package_to_install_is_named() {
    let folder = Folder::new();
    let clip = write_clip(&folder, "a.mkv", &waves([64, 48], 2));
    let (pack, out) = (folder.name("a.foveal"), folder.name("out"));
    done(&["prepare", "video", &clip, "--out", &pack]);
    let ran = without_drivers(&["simulate", &pack, "--out", &out]);
    assert_refused(&ran, 1, &["mesa-vulkan-drivers", "--renderer cpu"]);
    assert!(ran.stdout.is_empty());
    assert_eq!(folder.names(), ["a.foveal", "a.mkv"]);
}

#[test]
fn the_cpu_draws_nearly_the_same_without_an_adapter() {
    let folder = Folder::new();
    for (size, projection) in [([320, 180], "flat"), ([512, 256], "equirect")] {
        let clip = write_clip(&folder, "a.mkv", &noisy_clip(size, 4));
        let (pack, gpu) = (folder.name("a.foveal"), folder.name("gpu"));
        let how = ["--projection", projection, "--tile", "32", "--levels", "4"];
        let prepare = ["prepare", "video", &clip, "--out", &pack, "--force"];
        done(&[&prepare[..], &how].concat());
        let drawn = json(&["simulate", &pack, "--gaze", "20,-9", "--out", &gpu]);
        let cpu = folder.name("cpu");
        let play = [
            "simulate", &pack, "--gaze", "20,-9", "--out", &cpu, "--json",
        ];
        let ran = without_drivers(&[&play[..], &["--renderer", "cpu"]].concat());
        assert_eq!(ran.code, Some(0), "{ran:?}");
        let twin = crate::support::json_of(&ran);
        assert_eq!(twin["log_sha256"], drawn["log_sha256"]);
        for frame in 0..4 {
            let off = frame_picture(&gpu, frame).difference(&frame_picture(&cpu, frame));
            assert!(off <= TWIN, "{projection} frame {frame}: {off}");
        }
    }
}
