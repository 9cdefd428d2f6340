//! Are labelled files read as they are meant, and refused with their line and column?

use super::*;

const SCREEN: LabelScreen = LabelScreen {
    size_m: [0.38, 0.30],
    size_px: [1024.0, 768.0],
    distance_m: 0.67,
};

fn read(text: &str) -> Result<Recording, LabelledError> {
    read_labelled("a.csv", &mut text.as_bytes(), Some(&SCREEN))
}

fn refusal(text: &str) -> String {
    read(text).unwrap_err().to_string()
}

#[test]
fn degrees_are_a_thousand_samples_a_second_of_one_coder() {
    let text = "event,valid,y_deg,x_deg,note\n1,1,0,10,x\n2,1,5,11,\n5,0,nan,nan,\n";
    let recording = read(text).unwrap();
    let trial = &recording.trials[0];
    assert_eq!(
        (recording.trials.len(), trial.rate_hz, trial.samples.len()),
        (1, 1000.0, 3)
    );
    assert_eq!(recording.coders, ["event"]);
    assert_eq!(
        trial.labels,
        [[Label::Fixation, Label::Saccade, Label::Blink]]
    );
    assert_eq!(trial.samples[2].time, Seconds(0.002));
    assert!(trial.samples[1].valid && !trial.samples[2].valid);
    assert_eq!(
        trial.samples[2].gaze_in_content,
        trial.samples[1].gaze_in_content
    );
    assert!((trial.samples[0].gaze_in_content.x - 10_f64.to_radians().sin()).abs() < 1e-12);
}

#[test]
fn pixels_become_angles_at_the_eye_and_trials_start_anew() {
    let text = "trial,fs_hz,i,x_px,y_px,coder_MN,coder_RA\n\
                a,500,0,512,384,1,1\na,500,1,1024,384,2,1\na,500,3,0,0,5,6\n\
                b,200,0,512,0,4,3\n";
    let recording = read(text).unwrap();
    assert_eq!(recording.coders, ["MN", "RA"]);
    let [a, b] = &recording.trials[..] else {
        panic!("{recording:?}")
    };
    assert_eq!(
        (a.rate_hz, b.rate_hz, a.samples.len(), b.samples.len()),
        (500.0, 200.0, 3, 1)
    );
    assert_eq!(a.samples[0].gaze_in_content, DVec3::NEG_Z);
    let edge = a.samples[1].gaze_in_content;
    assert!((edge.x / -edge.z - 0.19 / 0.67).abs() < 1e-12 && edge.y.abs() < 1e-12);
    assert!(b.samples[0].gaze_in_content.y > 0.0, "rows count downwards");
    assert!(!a.samples[2].valid && a.samples[2].time == Seconds(0.006));
    assert_eq!(
        a.labels[1],
        [Label::Fixation, Label::Fixation, Label::Undefined]
    );
    assert_eq!(b.labels, [[Label::Pursuit], [Label::Oscillation]]);
}

#[test]
fn what_is_wrong_is_said_with_file_line_and_column() {
    let degrees = "x_deg,y_deg,valid,event\n";
    let pixels = "trial,fs_hz,i,x_px,y_px,coder_A\n";
    for (text, part) in [
        ("", "a.csv, line 1: the header lacks x_deg"),
        (
            "x_deg,y_deg,event\n0,0,1\n",
            "line 1: the header lacks valid",
        ),
        ("trial,fs_hz,i,x_px,y_px\n", "lacks coder_NAME"),
        ("trial,fs_hz,x_px,y_px,coder_A\n", "lacks i"),
        (degrees, "no rows after the header"),
        (
            &format!("{degrees}0,0,1,1\nNaN,0,1,1\n"),
            "a.csv, line 3, column x_deg: found \"NaN\"",
        ),
        (
            &format!("{degrees}0,0,1\n"),
            "line 2, column event: found \"\"",
        ),
        (
            &format!("{degrees}0,0,1,7\n"),
            "column event: found \"7\", expected a label",
        ),
        (
            &format!("{degrees}0,0,1,1.5\n"),
            "column event: found \"1.5\"",
        ),
        (&format!("{degrees}0,91,1,1\n"), "column y_deg"),
        (
            &format!("{pixels}a,500,0,NaN,3,1\n"),
            "column x_px: found \"NaN\"",
        ),
        (
            &format!("{pixels}a,500,0,3,3,x\n"),
            "column coder_A: found \"x\"",
        ),
        (
            &format!("{pixels}a,500,5,3,3,1\na,500,4,3,3,1\n"),
            "line 3, column i: found \"4\"",
        ),
        (
            &format!("{pixels}a,500,5,3,3,1\na,500,5,3,3,1\n"),
            "time must grow within a trial",
        ),
        (
            &format!("{pixels}a,500,5,3,3,1\na,200,6,3,3,1\n"),
            "column fs_hz: found \"200\"",
        ),
        (
            &format!("{pixels}a,0,5,3,3,1\n"),
            "column fs_hz: found \"0\"",
        ),
    ] {
        let error = refusal(text);
        assert!(error.contains(part), "{error} for {text:?}");
    }
    let no_screen = read_labelled("a.csv", &mut pixels.as_bytes(), None).unwrap_err();
    assert!(no_screen.to_string().contains("--screen"), "{no_screen}");
}

#[test]
fn an_endless_line_is_refused_before_it_is_held() {
    let mut endless = std::io::BufReader::new(std::io::repeat(b'7'));
    let error = read_labelled("a.csv", &mut endless, None)
        .unwrap_err()
        .to_string();
    assert!(error.contains("line 1: longer than"), "{error}");
    let text = format!("x_deg,y_deg,valid,event\n0,0,1,1\n{}", "9".repeat(70_000));
    assert!(refusal(&text).contains("line 3: longer than"));
    let bytes = b"x_deg,y_deg,valid,event\n\xff\xfe,0,1,1\n";
    let error = read_labelled("a.csv", &mut &bytes[..], None)
        .unwrap_err()
        .to_string();
    assert!(error.contains("line 2: cannot be read"), "{error}");
}

#[test]
fn a_generated_corpus_of_damaged_files_never_panics() {
    let good = "trial,fs_hz,i,x_px,y_px,coder_A\na,500,0,3,3,1\na,500,1,4,3,2\nb,200,0,4,3,5\n";
    assert!(parse_anything(good.as_bytes()));
    let mut random = foveal_core::view::random::Random::new(7);
    let mut refused = 0;
    for _ in 0..5000 {
        let mut bad = good.as_bytes().to_vec();
        for _ in 0..3 {
            let place = (random.unit() * bad.len() as f64) as usize;
            bad[place] = b"0123456789.,-+eNaninf\n\xff"[(random.unit() * 23.0) as usize];
        }
        refused += usize::from(!parse_anything(&bad));
    }
    assert!((2000..5000).contains(&refused), "{refused}");
}
