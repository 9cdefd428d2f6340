//! Do gazes that arrive over a network become the same samples, whatever brings them?

use crate::scenes::{waves, write_clip};
use crate::support::{Folder, Ran, assert_refused, column, command, done, json, json_of, refused};
use foveal_core::gaze::read::trace::Trace;
use foveal_core::session::log::SessionLogPart;
use foveal_core::units::Seconds;
use rosc::{OscMessage, OscPacket, OscType};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, UdpSocket};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Longest wait for something that must come.
const PATIENCE: Duration = Duration::from_secs(60);
/// Time between two samples that are sent.
const STEP: Duration = Duration::from_millis(4);

/// A program that runs while the test sends.
struct Running {
    child: Child,
    stderr: BufReader<std::process::ChildStderr>,
    said: String,
}

impl Running {
    fn new(arguments: &[&str]) -> Self {
        let mut command = command(arguments);
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let stderr = BufReader::new(child.stderr.take().unwrap());
        Self {
            child,
            stderr,
            said: String::new(),
        }
    }

    /// Where it says that it listens.
    fn address(&mut self) -> String {
        let begun = self.said.len();
        self.stderr.read_line(&mut self.said).unwrap();
        let line = self.said[begun..].trim_end();
        let (_, address) = line.split_once("listens on ").unwrap();
        address.to_owned()
    }

    /// Sends it a signal.
    fn signal(&self, name: &str) {
        let id = self.child.id().to_string();
        let sent = Command::new("kill").args([name, &id]).status().unwrap();
        assert!(sent.success());
    }

    fn finish(mut self) -> Ran {
        let mut stdout = String::new();
        let out = self.child.stdout.take();
        out.unwrap().read_to_string(&mut stdout).unwrap();
        self.stderr.read_to_string(&mut self.said).unwrap();
        let code = self.child.wait().unwrap().code();
        assert!(!self.said.contains("panicked"), "{}", self.said);
        Ran {
            code,
            stdout,
            stderr: self.said,
        }
    }
}

/// A `gaze record` that runs until it is stopped.
pub(crate) struct Recording {
    running: Running,
    out: String,
}

impl Recording {
    pub(crate) fn of(gaze: &str, out: String) -> Self {
        let running = Running::new(&["gaze", "record", "--gaze", gaze, "--out", &out, "--json"]);
        Self { running, out }
    }

    /// Where it says that it listens.
    pub(crate) fn address(&mut self) -> String {
        self.running.address()
    }

    /// Waits until `enough` of what is on disk so far.
    pub(crate) fn wait(&self, enough: impl Fn(&str) -> bool) {
        let (partial, begun) = (format!("{}.partial", self.out), Instant::now());
        while !std::fs::read_to_string(&partial).is_ok_and(|text| enough(&text)) {
            assert!(begun.elapsed() < PATIENCE, "{partial} does not grow");
            std::thread::sleep(STEP);
        }
    }

    /// Waits for every look that is seen, stops the program, and reads what it wrote.
    fn stop_after_looks(self) -> Trace {
        let valid = |line: &&str| line.split(',').nth(4) == Some("1");
        let seen = looks().iter().filter(|look| look.1).count();
        self.wait(|text| text.lines().filter(valid).count() >= seen);
        self.stop().0
    }

    pub(crate) fn stop(self) -> (Trace, Value, String) {
        self.running.signal("-INT");
        let ran = self.running.finish();
        assert_eq!(ran.code, Some(0), "{ran:?}");
        let trace = Trace::parse(&std::fs::read_to_string(&self.out).unwrap()).unwrap();
        let summary = json_of(&ran);
        assert_eq!(summary["samples"], trace.rows().len());
        (trace, summary, ran.stderr)
    }
}

/// What is sent: yaw and pitch in the head's space, and whether the eye is open.
fn looks() -> Vec<([f64; 2], bool)> {
    let look = |n: u32| {
        let at = f64::from(n);
        ([at * 0.75 - 20.0, 15.0 - at * 0.5], n % 20 != 19)
    };
    (0..60).map(look).collect()
}

/// The looks as lines of JSON.
fn lines() -> Vec<String> {
    let line = |(n, ([yaw, pitch], valid)): (u32, ([f64; 2], bool))| {
        let t = 100.0 + f64::from(n) * 0.01;
        format!(
            r#"{{"t_s":{t},"yaw_deg":{yaw},"pitch_deg":{pitch},"valid":{valid},"space":"head"}}"#
        )
    };
    (0..).zip(looks()).map(line).collect()
}

fn sender() -> UdpSocket {
    UdpSocket::bind("127.0.0.1:0").unwrap()
}

fn send_all(address: &str, messages: &[impl AsRef<[u8]>]) {
    let socket = sender();
    for message in messages {
        socket.send_to(message.as_ref(), address).unwrap();
        std::thread::sleep(STEP);
    }
}

fn recorded_over_udp(folder: &Folder) -> Trace {
    let mut recording = Recording::of("udp:0", folder.name("udp.csv"));
    send_all(&recording.address(), &lines());
    recording.stop_after_looks()
}

/// A server for one client, which gets every line, and the socket back.
fn serve(listener: &TcpListener, lines: &[String]) -> tungstenite::WebSocket<std::net::TcpStream> {
    let (stream, _) = listener.accept().unwrap();
    let mut socket = tungstenite::accept(stream).unwrap();
    for line in lines {
        // A client that refuses a message may be gone before it is sent whole.
        if socket.send(line.clone().into()).is_err() {
            break;
        }
        std::thread::sleep(STEP);
    }
    socket
}

fn recorded_over_websocket(folder: &Folder) -> Trace {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let gaze = format!("ws://{}", listener.local_addr().unwrap());
    let recording = Recording::of(&gaze, folder.name("ws.csv"));
    let open = serve(&listener, &lines());
    let trace = recording.stop_after_looks();
    drop(open);
    trace
}

fn osc(address: &str, values: &[f64]) -> Vec<u8> {
    let message = OscPacket::Message(OscMessage {
        addr: format!("/tracking/eye/{address}"),
        args: values.iter().map(|v| OscType::Float(*v as f32)).collect(),
    });
    rosc::encoder::encode(&message).unwrap()
}

fn recorded_over_osc(folder: &Folder) -> Trace {
    let mut recording = Recording::of("osc:0", folder.name("osc.csv"));
    let messages: Vec<Vec<u8>> = looks()
        .into_iter()
        .flat_map(|([yaw, pitch], valid)| {
            let lids = osc("EyesClosedAmount", &[f64::from(u8::from(!valid))]);
            let both = [-pitch, yaw, -pitch, yaw];
            let gaze = osc("LeftRightPitchYaw", &both);
            if valid { vec![lids, gaze] } else { vec![lids] }
        })
        .collect();
    send_all(&recording.address(), &messages);
    recording.stop_after_looks()
}

#[test]
fn udp_a_websocket_and_osc_give_the_same_samples() {
    let folder = Folder::new();
    let traces = [
        recorded_over_udp(&folder),
        recorded_over_websocket(&folder),
        recorded_over_osc(&folder),
    ];
    for trace in &traces {
        assert!(trace.rows().iter().all(|row| row.received >= row.time));
        // A pause of a busy machine counts as a loss: only what is seen is compared.
        let rows: Vec<_> = trace.rows().iter().filter(|row| row.valid).collect();
        let seen: Vec<[f64; 2]> = looks().into_iter().filter(|l| l.1).map(|l| l.0).collect();
        assert_eq!(rows.len(), seen.len());
        for (row, [yaw, pitch]) in rows.iter().zip(seen) {
            let found = row.gaze_deg.unwrap();
            assert!((found[0] - yaw).abs() < 1e-4 && (found[1] - pitch).abs() < 1e-4);
            assert_eq!(row.spread_deg, 1.0);
            assert!(row.time.0.is_finite() && row.head_deg.is_none());
        }
    }
    // The sender's own times, where it has some.
    for trace in &traces[..2] {
        let valid: Vec<_> = trace.rows().iter().filter(|row| row.valid).collect();
        assert!((valid[10].time.0 - 0.1).abs() < 1e-9);
    }
}

#[test]
fn garbage_and_a_flood_are_counted_and_the_rest_is_kept() {
    let folder = Folder::new();
    let mut recording = Recording::of("udp:0", folder.name("flood.csv"));
    let (address, socket) = (recording.address(), sender());
    let garbage: Vec<u8> = (0..60_000u32).map(|n| ((n * 7919) >> 5) as u8).collect();
    let line = |n: u32| {
        format!(
            r#"{{"t_s":{},"yaw_deg":5,"pitch_deg":1}}"#,
            f64::from(n) * 1e-4
        )
    };
    for n in 0..40_000u32 {
        socket.send_to(line(n).as_bytes(), &address).unwrap();
        if n.is_multiple_of(500) {
            let length = garbage.len() >> (n / 500 % 14);
            socket.send_to(&garbage[..length], &address).unwrap();
            socket.send_to(&[b'['; 3000], &address).unwrap();
            std::thread::sleep(STEP);
        }
    }
    // The way may lose some; what is sent in peace arrives.
    let last = r#"{"t_s":5,"yaw_deg":-33,"pitch_deg":1}"#;
    std::thread::sleep(Duration::from_millis(100));
    socket.send_to(last.as_bytes(), &address).unwrap();
    recording.wait(|text| text.contains(",-33,"));
    if cfg!(target_os = "linux") {
        let status = format!("/proc/{}/status", recording.running.child.id());
        let status = std::fs::read_to_string(status).unwrap();
        let peak = status
            .lines()
            .find(|line| line.starts_with("VmHWM"))
            .unwrap();
        let kib: u64 = peak.split_whitespace().nth(1).unwrap().parse().unwrap();
        assert!(kib < 300_000, "{peak}");
    }
    let (trace, summary, said) = recording.stop();
    assert!(trace.rows().len() > 1000);
    assert!(summary["skipped"].as_u64().unwrap() > 10, "{summary}");
    assert_eq!(said.matches("skipped what is no gaze").count(), 1, "{said}");
    assert_eq!(said.matches("without a gaze").count(), 1, "{said}");
}

#[test]
fn a_sender_that_stops_loses_the_eye_and_is_taken_up_again() {
    let folder = Folder::new();
    let mut recording = Recording::of("udp:0", folder.name("stops.csv"));
    let (address, lines) = (recording.address(), lines());
    // Who sends no gaze holds no source.
    send_all(&address, &["rubbish"]);
    send_all(&address, &lines[..10]);
    recording.wait(|text| text.lines().any(|line| line.split(',').nth(4) == Some("0")));
    // Another sender is left out while the first may go on.
    send_all(&address, &[r#"{"t_s":900,"yaw_deg":55,"pitch_deg":0}"#]);
    // The sender was started again, from another port: its clock restarts.
    std::thread::sleep(Duration::from_millis(1100));
    let again = r#"{"t_s":0.5,"yaw_deg":77,"pitch_deg":0}"#;
    send_all(&address, &[again]);
    recording.wait(|text| text.contains(",77,"));
    let (trace, summary, said) = recording.stop();
    assert_eq!([&summary["foreign"], &summary["anew"]], [1, 1], "{summary}"); // words: ok, a key
    assert!(said.contains("sends too"), "{said}");
    assert!(
        !trace
            .rows()
            .iter()
            .any(|row| row.gaze_deg == Some([55.0, 0.0]))
    );
    let lost = trace.rows().iter().position(|row| !row.valid).unwrap();
    let (lost, after) = (trace.rows()[lost], trace.rows()[lost + 1]);
    assert!(lost.received.0 - lost.time.0 > 0.2, "{lost:?}");
    assert_eq!(after.gaze_deg, Some([77.0, 0.0]));
    let held = trace.at(Seconds(lost.time.0 + 0.2));
    assert!(!held.valid && held.spread.to_degrees() > 2.0);
}

#[test]
fn a_server_that_is_lost_is_connected_to_again() {
    let folder = Folder::new();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let gaze = format!("ws://{}", listener.local_addr().unwrap());
    let recording = Recording::of(&gaze, folder.name("again.csv"));
    let lines = lines();
    let oversized = "x".repeat(100_000);
    let too_much = [&lines[..5], &[oversized]].concat();
    drop(serve(&listener, &too_much));
    let last = r#"{"t_s":200,"yaw_deg":77,"pitch_deg":0}"#.to_owned();
    let open = serve(&listener, &["rubbish".to_owned(), last]);
    recording.wait(|text| text.contains(",77,"));
    let (trace, summary, said) = recording.stop();
    drop(open);
    assert!(trace.rows().iter().filter(|row| row.valid).count() >= 6);
    assert_eq!(summary["skipped"], 1);
    assert!(said.contains("connection lost"), "{said}");
}

#[test]
fn a_recording_replays_bit_for_bit() {
    let folder = Folder::new();
    let trace = recorded_over_udp(&folder);
    let (one, two) = (folder.name("udp.csv"), folder.name("again.csv"));
    let copied = json(&[
        "gaze",
        "record",
        "--gaze",
        &format!("trace:{one}"),
        "--out",
        &two,
    ]);
    assert_eq!(copied["samples"], trace.rows().len());
    let [one, two] = [one, two].map(|file| std::fs::read_to_string(file).unwrap());
    assert_eq!(one, two);
    assert_eq!(Trace::parse(&two).unwrap(), trace);
}

#[test]
fn a_source_without_end_is_recorded_for_the_seconds_asked_for() {
    let folder = Folder::new();
    let out = folder.name("scan.csv");
    let how = ["gaze", "record", "--out", &out, "--gaze"];
    let made = json(&[&how[..], &["scan", "--seconds", "2", "--seed", "4"]].concat());
    assert_eq!(made["samples"], 200);
    assert_eq!(made["valid"], 200);
    refused(2, &[&how[..], &["scan"]].concat(), &["--seconds"]);
    refused(
        2,
        &[&how[..], &["scan", "--seconds", "-1"]].concat(),
        &["--seconds"],
    );
    refused(2, &[&how[..], &["mouse"]].concat(), &["window"]);
    let nowhere = folder.name("no/such/folder.csv");
    let how = [
        "gaze",
        "record",
        "--gaze",
        "scan",
        "--seconds",
        "1",
        "--out",
    ];
    refused(1, &[&how[..], &[&nowhere]].concat(), &["cannot be written"]);
}

#[test]
fn interrupted_before_anything_came_nothing_is_written() {
    let folder = Folder::new();
    let mut recording = Recording::of("udp:0", folder.name("none.csv"));
    recording.address();
    recording.running.signal("-TERM");
    let ran = recording.running.finish();
    assert_refused(&ran, 1, &["interrupted", "nothing was written"]);
    assert_eq!(folder.names(), [""; 0]);
}

#[test]
fn a_source_that_never_speaks_is_said_so() {
    let silent = [
        "select",
        "--projection",
        "cube",
        "--face-size",
        "256",
        "--gaze",
    ];
    let words = [
        "udp:127.0.0.1:0",
        "no gaze came within 10 s",
        "start the sender",
    ];
    refused(1, &[&silent[..], &["udp:0"]].concat(), &words);
    let gone = TcpListener::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap();
    let gone = format!("ws://{gone}");
    refused(
        1,
        &[&silent[..], &[&gone]].concat(),
        &[&gone, "start the server"],
    );
    let taken = sender();
    let taken = format!("udp:{}", taken.local_addr().unwrap());
    refused(
        1,
        &[&silent[..], &[&taken]].concat(),
        &[&taken, "another port"],
    );
}

/// Runs the program while a thread sends it one line again and again, with growing times.
fn run_looking_at(arguments: &[&str], line: &str) -> Ran {
    run_until(arguments, line, None)
}

/// The same, stopped by a signal after a while.
fn run_until(arguments: &[&str], line: &str, stop: Option<(Duration, &str)>) -> Ran {
    let mut running = Running::new(arguments);
    let (address, over) = (running.address(), AtomicBool::new(false));
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let (socket, begun) = (sender(), Instant::now());
            while !over.load(Ordering::Relaxed) {
                let line = line.replace("NOW", &begun.elapsed().as_secs_f64().to_string());
                let _ = socket.send_to(line.as_bytes(), &address);
                std::thread::sleep(STEP);
            }
        });
        if let Some((after, signal)) = stop {
            std::thread::sleep(after);
            running.signal(signal);
        }
        let ran = running.finish();
        over.store(true, Ordering::Relaxed);
        ran
    })
}

fn sphere_pack(folder: &Folder) -> String {
    let clip = write_clip(folder, "a.mkv", &waves([256, 128], 8));
    let pack = folder.name("a.foveal");
    let how = ["--projection", "equirect", "--tile", "64", "--levels", "2"];
    done(&[&["prepare", "video", &clip, "--out", &pack], &how[..]].concat());
    pack
}

#[test]
fn a_live_gaze_plays_a_pack() {
    let folder = Folder::new();
    let (pack, out) = (sphere_pack(&folder), folder.name("out"));
    let live = ["simulate", &pack, "--gaze", "udp:0", "--out", &out];
    let how = ["--renderer", "none", "--json", "--frames", "8"];
    let line = r#"{"t_s":NOW,"yaw_deg":10,"pitch_deg":5,"space":"head",
                   "head_yaw_deg":20,"head_pitch_deg":0}"#
        .replace('\n', "");
    let ran = run_looking_at(&[&live[..], &how].concat(), &line);
    assert_eq!(json_of(&ran)["frames"], 8, "{ran:?}");
    for (name, expected) in [
        ("gaze_yaw_deg", 30.0),
        ("gaze_pitch_deg", 5.0),
        ("head_yaw_deg", 20.0),
    ] {
        let found = column(&out, name);
        let close = |value: &f64| (value - expected).abs() < 1e-3;
        assert!(found.iter().all(close), "{name}: {found:?}");
    }
}

#[test]
fn a_live_gaze_plays_round_after_round_until_it_is_stopped() {
    let folder = Folder::new();
    let (pack, out) = (sphere_pack(&folder), folder.name("out"));
    let live = ["simulate", &pack, "--gaze", "udp:0", "--out", &out];
    let how = ["--renderer", "none", "--json", "--policy", "acuity"];
    let line = r#"{"t_s":NOW,"yaw_deg":10,"pitch_deg":5}"#;
    for signal in ["-INT", "-TERM"] {
        // Eight frames of 40 ms take a third of a second.
        let stop = Some((Duration::from_millis(1500), signal));
        let ran = run_until(&[&live[..], &how].concat(), line, stop);
        assert_eq!(ran.code, Some(0), "{ran:?}");
        let figures = json_of(&ran);
        let played = figures["frames"].as_u64().unwrap();
        assert!((9..80).contains(&played), "{figures}");
        assert_eq!(figures["gaze_error_deg_mean"], Value::Null, "{figures}");
        let frames = column(&out, "frame");
        let expected = (0..).map(|k| f64::from(k % 8)).take(frames.len());
        assert!(frames.iter().copied().eq(expected), "{frames:?}");
        let times = column(&out, "time_s");
        assert!(times.windows(2).all(|pair| pair[1] > pair[0]), "{times:?}");
        let log = format!("{out}/session.jsonl");
        assert_eq!(json(&["replay", &log, "--pack", &pack])["same"], true);
    }
}

#[test]
fn a_head_alone_is_a_gaze() {
    let folder = Folder::new();
    let (pack, out) = (sphere_pack(&folder), folder.name("out"));
    let header = "t_s,yaw_deg,pitch_deg,head_yaw_deg,head_pitch_deg\n";
    let trace = folder.holding("a.csv", format!("{header}0,80,-30,12,3\n").as_bytes());
    let gaze = format!("head:{trace}");
    let play = ["simulate", &pack, "--gaze", &gaze, "--out", &out];
    done(&[&play[..], &["--renderer", "none"]].concat());
    // What is chosen for follows the head; the eyes are known to the judge alone.
    let log = std::fs::read_to_string(format!("{out}/session.jsonl")).unwrap();
    for frame in SessionLogPart::parse(&log).unwrap().frames {
        let [x, _, z] = frame.gaze;
        assert!((x.atan2(-z).to_degrees() - 12.0).abs() < 1e-9, "{frame:?}");
    }
    assert!(
        column(&out, "gaze_yaw_deg")
            .iter()
            .all(|yaw| (yaw - 80.0).abs() < 1e-3)
    );
    // From a sender that knows no more than the head.
    let live = ["simulate", &pack, "--gaze", "udp:0", "--out", &out];
    let line = r#"{"t_s":NOW,"head_yaw_deg":-40,"head_pitch_deg":1}"#;
    let how = ["--renderer", "none", "--frames", "8"];
    let ran = run_looking_at(&[&live[..], &how].concat(), line);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    // The eyes of a head that hardly moves are near its middle.
    let near = |yaw: &f64| (yaw + 40.0).abs() < 6.0;
    let yaws = column(&out, "gaze_yaw_deg");
    assert!(yaws.iter().all(near), "{yaws:?}");
    let bare = folder.holding("b.csv", b"t_s,yaw_deg,pitch_deg\n0,1,2\n");
    let bare = format!("head:{bare}");
    let words = ["b.csv", "head_yaw_deg"];
    refused(
        1,
        &["simulate", &pack, "--gaze", &bare, "--out", &out],
        &words,
    );
}

#[test]
fn a_server_that_answers_byte_by_byte_is_waited_for_three_seconds_in_all() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let gaze = format!("ws://{}", listener.local_addr().unwrap());
    let select = ["select", "--projection", "cube", "--face-size", "256"];
    let over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let (mut stream, _) = listener.accept().unwrap();
            let greeting = b"HTTP/1.1 101 Switching Protocols\r\nX-Slow: ";
            let endless = greeting.iter().chain(std::iter::repeat(&b'a'));
            for byte in endless.take(200) {
                if over.load(Ordering::Relaxed) || stream.write_all(&[*byte]).is_err() {
                    break;
                }
                std::thread::sleep(Duration::from_millis(100));
            }
        });
        let begun = Instant::now();
        let words = [&gaze, "did not answer within 3 s"];
        refused(1, &[&select[..], &["--gaze", &gaze]].concat(), &words);
        let took = begun.elapsed();
        over.store(true, Ordering::Relaxed);
        assert!((2.9..6.0).contains(&took.as_secs_f64()), "{took:?}");
    });
}

#[test]
fn a_sender_whose_clock_leaps_again_and_again_is_dated_by_arrival() {
    let folder = Folder::new();
    let mut recording = Recording::of("udp:0", folder.name("leaps.csv"));
    let leaps: Vec<String> = (0..60)
        .map(|n| {
            let t = 9.99 * f64::from(n);
            format!(r#"{{"t_s":{t},"yaw_deg":{n},"pitch_deg":0}}"#)
        })
        .collect();
    send_all(&recording.address(), &leaps);
    recording.wait(|text| text.contains(",59,"));
    let (trace, summary, said) = recording.stop();
    assert_eq!(said.matches("clock leaps or stands").count(), 1, "{said}");
    assert!(summary["untimed"].as_u64().unwrap() >= 50, "{summary}");
    assert_eq!(summary["foreign"], 0, "{summary}");
    let times: Vec<f64> = trace.rows().iter().map(|row| row.time.0).collect();
    // But for the first leap, which may be a clock that was set.
    assert!(times[times.len() - 1] - times[2] < 10.0, "{times:?}");
}
