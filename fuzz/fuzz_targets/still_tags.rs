//! Do any bytes of a picture file, or of the XMP in one, make the search for its tags or its kind,
//! or the reading of its samples, panic, or lay a picture beyond the sphere?

#![no_main]

use std::io::Cursor;

use foveal_media::read::still::exr::head::ExrHead;
use foveal_media::read::still::float_map::read_any_float_map;
use foveal_media::read::still::qoi::why_not_whole;
use foveal_media::read::still::radiance::read_any_radiance;
use foveal_media::read::still::still_tags::StillTags;
use foveal_media::read::still::tiff_head::TiffHead;
use foveal_media::surround::photo_sphere::PhotoSphere;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let _ = read_any_radiance(data);
    let _ = read_any_float_map(data);
    let _ = ExrHead::read_any(data);
    let _ = why_not_whole(&mut Cursor::new(data));
    let _ = TiffHead::read(&mut Cursor::new(data));
    let said = StillTags::read(&mut Cursor::new(data)).photo_sphere;
    let alone = PhotoSphere::of_xmp(data).ok().flatten();
    for sphere in [said, alone].into_iter().flatten() {
        for size in [[1, 1], [64, 32], [4001, 1999]] {
            let Ok(placed) = sphere.placed(size) else {
                continue;
            };
            let part = placed.part;
            assert!(part.whole[0] >= size[0] && part.whole[1] >= size[1] + part.at[1]);
            assert!(part.at[0] <= part.whole[0] && part.at.iter().all(|at| at % 2 == 0));
            assert!(part.middle_deg(size[0]).abs() <= 180.0);
        }
    }
});
