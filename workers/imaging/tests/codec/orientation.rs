//! Orientation tags of every format.

use imaging::codec::{self, FilePlane, Orientation};
use imaging::{Plane, Raster, Rgb8};

use super::png::chunk;

/// A TIFF structure with the orientation as its only tag.
fn exif(tag: u8, is_big_endian: bool) -> Vec<u8> {
    match is_big_endian {
        true => [
            &b"MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0"[..],
            &[tag],
            &[0; 6],
        ]
        .concat(),
        false => [
            &b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0"[..],
            &[tag],
            &[0; 7],
        ]
        .concat(),
    }
}

fn tagged_png(file: &[u8], tag: u8) -> Vec<u8> {
    const HEADER_END: usize = 33;
    [
        &file[..HEADER_END],
        &chunk(b"eXIf", &exif(tag, true)),
        &file[HEADER_END..],
    ]
    .concat()
}

fn tagged_jpeg(file: &[u8], tag: u8) -> Vec<u8> {
    let body = [&b"Exif\0\0"[..], &exif(tag, false)].concat();
    let length = (body.len() as u16 + 2).to_be_bytes();
    [&file[..2], &[0xff, 0xe1], &length, &body, &file[2..]].concat()
}

fn tagged_webp(file: &[u8], tag: u8) -> Vec<u8> {
    let exif = exif(tag, false);
    let mut file = [file, b"EXIF", &(exif.len() as u32).to_le_bytes(), &exif].concat();
    let length = (file.len() as u32 - 8).to_le_bytes();
    file[4..8].copy_from_slice(&length);
    file
}

/// Codes of the shown picture for each tag, of the stored picture 0 1 2 / 3 4 5.
const SHOWN: [(u8, [usize; 2], [u8; 6]); 8] = [
    (1, [3, 2], [0, 1, 2, 3, 4, 5]),
    (2, [3, 2], [2, 1, 0, 5, 4, 3]),
    (3, [3, 2], [5, 4, 3, 2, 1, 0]),
    (4, [3, 2], [3, 4, 5, 0, 1, 2]),
    (5, [2, 3], [0, 3, 1, 4, 2, 5]),
    (6, [2, 3], [3, 0, 4, 1, 5, 2]),
    (7, [2, 3], [5, 2, 4, 1, 3, 0]),
    (8, [2, 3], [2, 5, 1, 4, 0, 3]),
];

#[test]
fn every_tag_turns_the_picture_as_viewers_show_it() {
    let stored = Raster::from(Plane::new(3, 2, vec![0u8, 1, 2, 3, 4, 5]).unwrap());
    let png = codec::encode_png(&stored).unwrap();
    for (tag, [width, height], codes) in SHOWN {
        let bytes = tagged_png(&png, tag);
        assert_eq!(Orientation::read(&bytes).tag(), tag);
        let shown = codec::decode_picture(&bytes).unwrap();
        assert_eq!(
            shown,
            Raster::from(Plane::new(width, height, codes.to_vec()).unwrap()),
            "{tag}"
        );
        let codes = codes.map(u16::from).to_vec();
        let plane = Plane::new(width, height, codes).unwrap();
        assert_eq!(codec::decode_mask(&bytes).unwrap(), plane);
        assert_eq!(codec::decode_plane(&bytes).unwrap(), FilePlane::Codes(plane));
    }
}

#[test]
fn the_tag_is_read_from_jpeg_webp_and_damaged_files_have_none() {
    let picture = Rgb8::from_fn(3, 2, |x, y| [(x * 80) as u8, (y * 90) as u8, 7]);
    let jpeg = tagged_jpeg(&codec::encode_jpeg(&picture, 90).unwrap(), 6);
    let webp = tagged_webp(&codec::encode_webp_lossless(&picture).unwrap(), 8);
    for (file, tag) in [(&jpeg, 6), (&webp, 8)] {
        assert_eq!(Orientation::read(file).tag(), tag);
        for cut in 0..file.len() {
            assert!([1, tag].contains(&Orientation::read(&file[..cut]).tag()));
        }
    }
    let shown = codec::decode_picture(&jpeg).unwrap();
    assert_eq!((shown.width(), shown.height()), (2, 3));
    for tag in [0, 9, 255] {
        let png = codec::encode_png(&Raster::from(picture.clone())).unwrap();
        assert_eq!(Orientation::read(&tagged_png(&png, tag)), Orientation::STORED);
    }
}
