//! Does `foveal score --pairs` score every pair of a table, or say in its row why it has no score?

use crate::score_conditions::pair;
use crate::support::{Folder, done, json, refused};

/// Rows of a table, each as its cells by the names of their columns.
fn read(path: &str) -> Vec<impl Fn(&str) -> String + use<>> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let columns = reader.headers().unwrap().clone();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let cells = |row: csv::StringRecord| {
        let columns = columns.clone();
        move |column: &str| {
            let at = columns.iter().position(|name| name == column);
            row[at.unwrap_or_else(|| panic!("no {column} in {columns:?}"))].to_owned()
        }
    };
    rows.into_iter().map(cells).collect()
}

#[test]
fn every_pair_of_a_table_has_the_score_that_it_has_alone() {
    let folder = Folder::new();
    let [reference, test] = pair(&folder);
    folder.holding(
        "mine.toml",
        b"name = \"mine\"\nsize_px = [640, 480]\nfov_diagonal_deg = 60\npeak_cd_m2 = 90\n\
          contrast = 400\n",
    );
    folder.holding("path.csv", b"frame,x_px,y_px\n0,300,-20\n");
    let table = "\u{feff}who,reference,test,gaze_x,gaze_y,gaze_trace,display\n\
                 \"Ada, L.\",reference.png,test.png,,,,\n\
                 B, reference.png , test.png ,-70,12.5,,mine.toml\n\
                 C,reference.png,test.png,,,path.csv,standard_hmd\n";
    let pairs = folder.holding("pairs.csv", table.as_bytes());
    let out = folder.name("scores.csv");
    let given = ["--display", "standard_fhd", "--gaze", "3,4"];
    let found = json(&[&["score", "--pairs", &pairs, "--out", &out], &given[..]].concat());
    assert_eq!(found["pairs"], 3);
    assert_eq!(found["out"], *out);
    let rows = read(&out);
    let alone = |options: &[&str]| json(&[&["score", &reference, &test], options].concat());
    let (mine, path) = (folder.name("mine.toml"), folder.name("path.csv"));
    let wanted = [
        alone(&given),
        alone(&["--display", &mine, "--gaze", "-70,12.5"]),
        alone(&["--display", "standard_hmd", "--gaze-trace", &path]),
    ];
    for (row, wanted) in rows.iter().zip(&wanted) {
        for column in ["jod", "metric", "version", "mode", "ppd", "gaze", "frames"] {
            let text = wanted[column].as_str().map(str::to_owned);
            assert_eq!(
                row(column),
                text.unwrap_or(wanted[column].to_string()),
                "{column}"
            );
        }
        assert_eq!(row("shown_on"), wanted["display"].as_str().unwrap());
        assert_eq!([row("fps"), row("error")], ["", ""]);
    }
    assert_eq!(rows.len(), 3);
    assert_eq!(rows[0]("who"), "Ada, L.");
    // Other measures have a column of their own.
    let psnr = [
        "score", "--pairs", &pairs, "--out", &out, "--metric", "psnr",
    ];
    assert!(
        done(&[&psnr[..], &given[..]].concat())
            .stdout
            .contains("3 pairs scored")
    );
    let row = &read(&out)[0];
    let wanted = alone(&["--display", "standard_fhd", "--metric", "psnr"]);
    assert_eq!(row("value"), wanted["value"].to_string());
    assert_eq!([row("unit"), row("metric")], ["dB", "psnr"]);
}

#[test]
fn a_pair_without_a_score_says_why_and_the_others_are_scored() {
    let folder = Folder::new();
    pair(&folder);
    let table = "reference,test,gaze_x,gaze_y,display\n\
                 reference.png,gone.png,,,\n\
                 reference.png,,,,\n\
                 reference.png,test.png,1,,\n\
                 reference.png,test.png,nan,1,\n\
                 reference.png,test.png,1,1,standard_8k\n\
                 reference.png,test.png\n\
                 reference.png,test.png,1,1,\n";
    let pairs = folder.holding("pairs.csv", table.as_bytes());
    let out = folder.name("scores.csv");
    let score = [
        "score",
        "--pairs",
        &pairs,
        "--out",
        &out,
        "--display",
        "standard_hmd",
    ];
    refused(
        1,
        &score,
        &["pairs.csv", "6 of 7 pairs", "scores.csv", "column error"],
    );
    let rows = read(&out);
    let words: [&[&str]; 6] = [
        &["gone.png"],
        &["line 3", "column test", "name a file"],
        &["line 4", "column gaze_y", "expected a finite number"],
        &["line 5", "column gaze_x", "\"nan\""],
        &["--display", "standard_8k", "standard_4k"],
        &["line 7", "2 fields", "5"],
    ];
    for (row, words) in rows.iter().zip(words) {
        let error = row("error");
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
        assert_eq!([row("jod"), row("reference")], ["", "reference.png"]);
    }
    assert_eq!(rows[6]("error"), "");
    assert!(rows[6]("jod").parse::<f64>().unwrap() < 10.0);
    assert!(!folder.names().iter().any(|name| name.ends_with(".partial")));
}

#[test]
fn a_table_that_cannot_be_read_or_written_is_refused() {
    let folder = Folder::new();
    let [reference, _] = pair(&folder);
    let pairs = folder.holding("pairs.csv", b"reference,test\nreference.png,test.png\n");
    let out = folder.name("scores.csv");
    refused(2, &["score", "--pairs", &pairs], &["--out"]);
    refused(
        2,
        &["score", &reference, &reference, "--out", &out],
        &["--pairs"],
    );
    refused(
        2,
        &["score", "--pairs", &pairs, "--out", &pairs],
        &["pairs.csv", "another place"],
    );
    refused(
        2,
        &["score", "--pairs", &pairs, "--out", &reference],
        &["another place"],
    );
    refused(
        2,
        &[
            "score",
            "--pairs",
            &pairs,
            "--display",
            "standard_fhd",
            "--out",
            &folder.name("."),
        ],
        &["--out", "folder"],
    );
    // What no row can be scored without is asked for once, before any work.
    let score = ["score", "--pairs", &pairs, "--out", &out];
    refused(2, &score, &["--display is missing"]);
    let nowhere = [&score[..], &["--display", "nope"]].concat();
    refused(2, &nowhere, &["--display", "nope"]);
    // Nor is the table written over while the scores grow.
    let growing = folder.holding("scores.csv.partial", b"reference,test\na.png,a.png\n");
    let score = ["score", "--pairs", &growing, "--out", &out];
    refused(2, &score, &["scores.csv.partial", "another place"]);
    for (table, words) in [
        ("reference,other\na,b\n", ["line 1", "test"]),
        (
            "reference,test,jod\na,b,c\n",
            ["column jod", "another name"],
        ),
        ("reference,test\n", ["0 rows", "give 1"]),
    ] {
        let pairs = folder.holding("bad.csv", table.as_bytes());
        refused(
            1,
            &["score", "--pairs", &pairs, "--out", &out],
            &[&["bad.csv"], &words[..]].concat(),
        );
    }
}
