//! Which goldens are there, and what was measured for each?

use crate::score::golden::case::{Golden, GoldenGaze, TestPicture};

/// A path across a small video.
const PATH: GoldenGaze = GoldenGaze::Along([60.0, 60.0], [260.0, 180.0]);
/// A path across a wide one.
const WIDE_PATH: GoldenGaze = GoldenGaze::Along([480.0, 300.0], [1440.0, 780.0]);

/// Foveated round a place, by the radius of what stays and the side of a tile.
const fn foveated(round: GoldenGaze, [radius, tile]: [f64; 2], late: u32) -> TestPicture {
    TestPicture::Foveated {
        round,
        radius,
        tile: tile as usize,
        late,
    }
}

/// A still on a headset, foveated round its middle.
const STILL: Golden = Golden {
    id: "",
    size: [256, 256],
    frames: 1,
    fps: None,
    display: "standard_hmd",
    speed: 0.0,
    test: foveated(GoldenGaze::At([128.0, 128.0]), [24.0, 16.0], 0),
    gaze: GoldenGaze::Everywhere,
    sha256: ["3b29524bc642acd5", "7a3e2e0210da293e"],
    psnr_db: 20.106,
    jod: 0.0,
    jod_fine_table: 0.0,
    jod_right_border: 0.0,
    sustained: &[],
    transient: &[],
};
/// A video on a headset, foveated along a path.
const VIDEO: Golden = Golden {
    size: [320, 240],
    frames: 12,
    fps: Some(30.0),
    speed: 3.0,
    test: foveated(PATH, [24.0, 16.0], 0),
    sha256: ["98ba0562dc03ed53", "1b81662422eff780"],
    psnr_db: 20.180,
    ..STILL
};
/// The photograph on a headset, foveated round the face.
const PORTRAIT: Golden = Golden {
    size: [512, 512],
    test: foveated(GoldenGaze::At([255.0, 120.0]), [48.0, 32.0], 0),
    sha256: ["a8c429c18afa7b0f", "d2186d813104748e"],
    psnr_db: 20.913,
    ..STILL
};

/// Every case whose reference comes from a formula.
pub(super) const GOLDENS: [Golden; 13] = [
    Golden {
        id: "G1",
        display: "standard_fhd",
        jod: 6.27135,
        jod_fine_table: 6.2685,
        jod_right_border: 6.2713,
        sustained: &[56.75, 4934.74, 3089.71, 909.129, 805.322, 71.3477],
        ..STILL
    },
    Golden {
        id: "G2",
        gaze: GoldenGaze::At([128.0, 128.0]),
        jod: 8.42211,
        jod_fine_table: 8.4170,
        jod_right_border: 8.4221,
        sustained: &[2.67358, 238.944, 972.828, 439.004, 652.503],
        ..STILL
    },
    Golden {
        id: "G3",
        gaze: GoldenGaze::At([40.0, 60.0]),
        jod: 8.10340,
        jod_fine_table: 8.0971,
        jod_right_border: 8.1034,
        sustained: &[3.23315, 909.876, 1142.65, 490.047, 601.3],
        ..STILL
    },
    Golden {
        id: "G4",
        size: [321, 243],
        display: "standard_fhd",
        test: foveated(GoldenGaze::At([160.0, 121.0]), [24.0, 16.0], 0),
        gaze: GoldenGaze::At([200.0, 100.0]),
        sha256: ["d8709b93610a9c0e", "694c6ef1ae195a43"],
        psnr_db: 20.149,
        jod: 7.87191,
        jod_fine_table: 7.8666,
        jod_right_border: 7.8212,
        sustained: &[0.468631, 341.922, 1708.87, 861.933, 516.954, 393.32],
        ..STILL
    },
    Golden {
        id: "G7",
        size: [1920, 1080],
        display: "standard_fhd",
        test: foveated(GoldenGaze::At([480.0, 300.0]), [96.0, 32.0], 0),
        gaze: GoldenGaze::At([480.0, 300.0]),
        sha256: ["fa9032c53902e6da", "e463ec90ebea1353"],
        psnr_db: 19.590,
        jod: 6.54563,
        jod_fine_table: 6.5369,
        jod_right_border: 6.5263,
        sustained: &[0.239237, 245.916, 2091.33, 2827.71, 2851.93, 654.31],
        ..STILL
    },
    Golden {
        id: "G8",
        size: [1440, 1600],
        display: "htc_vive_pro",
        test: foveated(GoldenGaze::At([720.0, 800.0]), [96.0, 32.0], 0),
        gaze: GoldenGaze::At([720.0, 800.0]),
        sha256: ["5061e2ef398cc1cb", "57380f6af237a4d6"],
        psnr_db: 19.246,
        jod: 7.28755,
        jod_fine_table: 7.2790,
        jod_right_border: 7.2875,
        sustained: &[4.97664, 714.527, 1982.88, 1543.06, 1516.69],
        ..STILL
    },
    Golden {
        id: "G9",
        gaze: PATH,
        jod: 7.67200,
        jod_fine_table: 7.6650,
        jod_right_border: 7.6324,
        sustained: &[2.96084, 284.973, 1356.39, 1064.16, 571.929],
        transient: &[0.925473, 88.2105, 350.907, 421.017, 617.472],
        ..VIDEO
    },
    Golden {
        id: "G10",
        test: foveated(PATH, [24.0, 16.0], 4),
        gaze: PATH,
        sha256: ["98ba0562dc03ed53", "52d4a2b0fb858d9e"],
        psnr_db: 20.120,
        jod: 7.14491,
        jod_fine_table: 7.1383,
        jod_right_border: 7.0764,
        sustained: &[6.41326, 653.99, 1788.91, 1499.85, 707.643],
        transient: &[2.48855, 198.587, 333.309, 658.913, 834.697],
        ..VIDEO
    },
    Golden {
        id: "G11",
        gaze: GoldenGaze::At([160.0, 120.0]),
        jod: 7.33896,
        jod_fine_table: 7.3327,
        jod_right_border: 7.2937,
        sustained: &[8.18706, 477.639, 1652.98, 1269.55, 656.985],
        transient: &[3.65367, 195.624, 437.479, 544.613, 779.478],
        ..VIDEO
    },
    Golden {
        id: "G12",
        fps: Some(90.0),
        display: "standard_fhd",
        jod: 4.84014,
        jod_fine_table: 4.8365,
        jod_right_border: 4.7680,
        sustained: &[35.9064, 4921.19, 3971.54, 2438.98, 997.383, 279.902],
        transient: &[5.64513, 1590.76, 1351.98, 824.832, 1096.03, 858.765],
        ..VIDEO
    },
    Golden {
        id: "G13",
        speed: 0.0,
        test: TestPicture::Pop(6),
        gaze: GoldenGaze::At([160.0, 120.0]),
        sha256: ["5a236210f6b97bdf", "9e93ec4baf6ecbf2"],
        psnr_db: 25.678,
        jod: 9.57975,
        jod_fine_table: 9.5776,
        jod_right_border: 9.5798,
        sustained: &[5.34936, 56.9592, 34.8792, 13.1416, 13.2966],
        transient: &[0.719211, 27.5228, 60.5125, 196.48, 103.648],
        ..VIDEO
    },
    Golden {
        id: "G14",
        size: [1920, 1080],
        frames: 3,
        display: "standard_fhd",
        speed: 4.0,
        test: foveated(WIDE_PATH, [96.0, 32.0], 0),
        gaze: WIDE_PATH,
        sha256: ["41efa151b9e864f3", "e516382bc2c8e20d"],
        psnr_db: 19.672,
        jod: 5.69033,
        jod_fine_table: 5.6822,
        jod_right_border: 5.6630,
        sustained: &[0.354129, 528.762, 2555.71, 2825.18, 2958.28, 568.907],
        transient: &[0.0558348, 82.1993, 555.04, 987.87, 1393.73, 1298.6],
        ..VIDEO
    },
    Golden {
        id: "G15",
        test: TestPicture::Same,
        gaze: GoldenGaze::At([128.0, 128.0]),
        sha256: ["3b29524bc642acd5", "3b29524bc642acd5"],
        psnr_db: f64::INFINITY,
        jod: 10.00000,
        jod_fine_table: 10.0000,
        jod_right_border: 10.0000,
        ..STILL
    },
];

/// The cases whose reference is a photograph: `astronaut` of scikit-image (NASA, public domain).
pub(super) const PHOTOGRAPHED: [Golden; 2] = [
    Golden {
        id: "G5",
        gaze: GoldenGaze::At([255.0, 120.0]),
        jod: 8.43239,
        jod_fine_table: 8.4286,
        jod_right_border: 8.4324,
        sustained: &[3.30155, 413.069, 777.376, 590.613, 496.238],
        ..PORTRAIT
    },
    Golden {
        id: "G6",
        display: "standard_4k",
        jod: 7.51087,
        jod_fine_table: 7.5063,
        jod_right_border: 7.5109,
        sustained: &[
            2.04132, 1013.26, 1637.16, 1063.91, 559.215, 682.475, 25.1039,
        ],
        ..PORTRAIT
    },
];
