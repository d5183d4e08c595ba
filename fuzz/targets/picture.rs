//! The bytes of a picture, a range file or float radiance: refused, or values of the size that they say.
#![no_main]

use imaging::codec::{self, FilePlane};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(picture) = codec::decode_picture(bytes) {
        assert!(picture.width() * picture.height() <= codec::MAX_PIXELS);
    }
    match codec::decode_plane(bytes) {
        Ok(FilePlane::Codes(plane)) => assert_eq!(plane.data().len(), plane.width() * plane.height()),
        Ok(FilePlane::Wide(plane)) => assert_eq!(plane.data().len(), plane.width() * plane.height()),
        Ok(FilePlane::Floats(plane)) => assert_eq!(plane.data().len(), plane.width() * plane.height()),
        Err(_) => {}
    }
    let _ = codec::decode_radiance(bytes);
});
