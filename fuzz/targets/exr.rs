//! An OpenEXR file: refused, or a picture or distances of bearable size; what its header announces is what comes out.
#![no_main]

use imaging::codec::{MAX_PIXELS, Radiance, announced_pixels, decode_plane, decode_radiance};
use libfuzzer_sys::fuzz_target;

const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

fuzz_target!(|bytes: &[u8]| {
    let mut file = bytes.to_vec();
    let head = file.len().min(MAGIC.len());
    file[..head].copy_from_slice(&MAGIC[..head]);
    let announced = announced_pixels(&file);
    if let Ok(Radiance::Linear(picture)) = decode_radiance(&file) {
        let (width, height) = picture.size();
        assert!(width * height <= MAX_PIXELS && announced > 0);
    }
    drop(decode_plane(&file));
});
