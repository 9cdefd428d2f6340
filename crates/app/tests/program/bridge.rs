//! Does the bridge from Pupil Core turn what that tracker says into gazes?

use crate::live_gaze::Recording;
use crate::support::{Folder, skipped};
use foveal_core::gaze::read::row::TraceRow;
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

const BRIDGE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../examples/bridges/pupil_core.py"
);

/// Stands in for Pupil Capture: says its port, answers SUB_PORT, and publishes gazes.
const FAKE_TRACKER: &str = r#"
import itertools, threading, time, msgpack, zmq
context = zmq.Context()
gazes, remote = context.socket(zmq.PUB), context.socket(zmq.REP)
port = gazes.bind_to_random_port("tcp://127.0.0.1")
print(remote.bind_to_random_port("tcp://127.0.0.1"), flush=True)
def answer():
    while True:
        assert remote.recv_string() == "SUB_PORT"
        remote.send_string(str(port))
threading.Thread(target=answer, daemon=True).start()
for n in itertools.count():
    time.sleep(0.005)
    gaze = {"norm_pos": [1.0, 0.5], "confidence": 0.9 if n % 4 else 0.1, "timestamp": 77 + n / 200}
    gazes.send_multipart([b"gaze.3d.01.", msgpack.packb(gaze)])
    gazes.send_multipart([b"pupil.0.3d", b"not for us"])
"#;

fn python(code: &str) -> Command {
    let mut python = Command::new("python3");
    python.args(["-B", "-c", code]);
    python
}

/// The record that the bridge makes of a gaze.
fn converted(gaze: &str) -> Value {
    let code = "import importlib.util as u, json, sys\n\
                spec = u.spec_from_file_location('bridge', sys.argv[1])\n\
                bridge = u.module_from_spec(spec)\n\
                spec.loader.exec_module(bridge)\n\
                gaze = json.loads(sys.argv[2])\n\
                print(json.dumps(bridge.record_from_gaze(gaze, field_deg=(90, 60))))";
    let ran = python(code).args([BRIDGE, gaze]).output();
    let ran = ran.unwrap();
    assert!(ran.status.success(), "{ran:?}");
    serde_json::from_slice(&ran.stdout).unwrap()
}

#[test]
fn places_in_the_scene_camera_become_angles_from_the_head() {
    for (place, yaw, pitch) in [
        ("[0.5, 0.5]", 0.0, 0.0),
        ("[1.0, 0.5]", 45.0, 0.0),
        ("[0.0, 0.5]", -45.0, 0.0),
        ("[0.5, 1.0]", 0.0, 30.0),
        ("[0.5, 0.0]", 0.0, -30.0),
        // A corner: the ray (1, tan 30°, 1).
        ("[1.0, 1.0]", 45.0, 22.207_654),
    ] {
        let gaze = format!(r#"{{"norm_pos":{place},"confidence":0.8,"timestamp":12.5}}"#);
        let record = converted(&gaze);
        let off = |name: &str, expected: f64| (record[name].as_f64().unwrap() - expected).abs();
        assert!(off("yaw_deg", yaw) < 1e-5, "{place}: {record}");
        assert!(off("pitch_deg", pitch) < 1e-5, "{place}: {record}");
        assert_eq!(record["t_s"], 12.5);
        assert_eq!(record["space"], "head");
        assert_eq!(record["valid"], true);
        let text = record.to_string();
        assert!(foveal_core::gaze::read::record::GazeRecord::parse(text.as_bytes()).is_ok());
    }
    let doubtful = converted(r#"{"norm_pos":[0,0],"confidence":0.2,"timestamp":1}"#);
    assert_eq!(doubtful["valid"], false);
}

/// A program that is ended with the value.
struct Ended(Child);

impl Drop for Ended {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn a_tracker_is_heard_through_the_bridge() {
    let there = python("import zmq, msgpack").stderr(Stdio::null()).status();
    if !there.is_ok_and(|status| status.success()) {
        skipped("python3 has no pyzmq and msgpack, so only the conversion was tried");
        return;
    }
    let folder = Folder::new();
    let mut tracker = python(FAKE_TRACKER).stdout(Stdio::piped()).spawn().unwrap();
    let mut port = String::new();
    let out = tracker.stdout.take().unwrap();
    let _tracker = Ended(tracker);
    BufReader::new(out).read_line(&mut port).unwrap();
    let mut recording = Recording::of("udp:0", folder.name("pupil.csv"));
    let mut bridge = Command::new("python3");
    bridge.args(["-B", BRIDGE, "--to", &recording.address()]);
    let pupil = format!("127.0.0.1:{}", port.trim());
    let _bridge = Ended(
        bridge
            .args(["--field", "90x60", "--pupil", &pupil])
            .spawn()
            .unwrap(),
    );
    recording.wait(|text| text.lines().count() > 60);
    let (trace, summary, _) = recording.stop();
    assert_eq!(summary["skipped"], 0);
    assert!(summary["source_start_s"].as_f64().unwrap() >= 77.0);
    let (valid, lost): (Vec<TraceRow>, Vec<TraceRow>) =
        trace.rows().iter().partition(|row| row.valid);
    assert!(valid.len() > lost.len() && !lost.is_empty());
    for row in valid {
        let [yaw, pitch] = row.gaze_deg.unwrap();
        assert!((yaw - 45.0).abs() < 1e-6 && pitch.abs() < 1e-6, "{row:?}");
    }
}
