//! Color profiles of every format.

use imaging::Rgb8;
use imaging::codec::{encode_jpeg, encode_png, encode_webp_lossless, find_foreign_profile};

use super::png::chunk;

/// An ICC profile with a name of version 2 or 4 as its only tag.
fn profile(name: &str, version: u8) -> Vec<u8> {
    let description = match version {
        2 => [
            b"desc\0\0\0\0",
            &(name.len() as u32 + 1).to_be_bytes()[..],
            name.as_bytes(),
            &[0],
        ]
        .concat(),
        _ => {
            let text: Vec<u8> = name.encode_utf16().flat_map(u16::to_be_bytes).collect();
            let length = (text.len() as u32).to_be_bytes();
            [
                b"mluc\0\0\0\0\0\0\0\x01\0\0\0\x0cenUS",
                &length[..],
                &28u32.to_be_bytes(),
                &text,
            ]
            .concat()
        }
    };
    let mut bytes = vec![0; 128];
    bytes.extend(1u32.to_be_bytes());
    bytes.extend(b"desc");
    bytes.extend(144u32.to_be_bytes());
    bytes.extend((description.len() as u32).to_be_bytes());
    bytes.extend(description);
    bytes
}

fn picture() -> Rgb8 {
    Rgb8::from_fn(8, 6, |x, y| [x as u8, y as u8, 7])
}

/// A PNG with another chunk after its header.
fn png_with(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
    const HEADER_END: usize = 33;
    let file = encode_png(&picture().into()).unwrap();
    [&file[..HEADER_END], &chunk(kind, data), &file[HEADER_END..]].concat()
}

/// A zlib stream of one stored block.
fn stored(data: &[u8]) -> Vec<u8> {
    let length = data.len() as u16;
    let (mut low, mut high) = (1u32, 0u32);
    for &byte in data {
        low = (low + u32::from(byte)) % 65521;
        high = (high + low) % 65521;
    }
    let checksum = high << 16 | low;
    [
        &[0x78, 0x01, 1][..],
        &length.to_le_bytes(),
        &(!length).to_le_bytes(),
        data,
        &checksum.to_be_bytes(),
    ]
    .concat()
}

fn jpeg_with(profile: &[u8]) -> Vec<u8> {
    let jpeg = encode_jpeg(&picture(), 95).unwrap();
    let body = [&b"ICC_PROFILE\0\x01\x01"[..], profile].concat();
    let length = (body.len() as u16 + 2).to_be_bytes();
    [&jpeg[..2], &[0xff, 0xe2], &length, &body, &jpeg[2..]].concat()
}

#[test]
fn profiles_other_than_srgb_are_named() {
    for version in [2, 4] {
        let adobe = profile("Adobe RGB (1998)", version);
        let packed = [&b"ICC Profile\0\0"[..], &stored(&adobe)].concat();
        let expected = Some("the color profile `Adobe RGB (1998)`");
        assert_eq!(
            find_foreign_profile(&png_with(b"iCCP", &packed)).as_deref(),
            expected
        );
        assert_eq!(find_foreign_profile(&jpeg_with(&adobe)).as_deref(), expected);
        let srgb = profile("sRGB IEC61966-2.1", version);
        assert_eq!(find_foreign_profile(&jpeg_with(&srgb)), None);
    }
    assert_eq!(
        find_foreign_profile(&jpeg_with(&[7; 200])).as_deref(),
        Some("a color profile without a name")
    );
}

#[test]
fn a_gamma_is_named_unless_it_is_that_of_srgb() {
    let linear = png_with(b"gAMA", &100_000u32.to_be_bytes());
    assert_eq!(find_foreign_profile(&linear).as_deref(), Some("a gamma of 1"));
    assert_eq!(
        find_foreign_profile(&png_with(b"gAMA", &45_455u32.to_be_bytes())),
        None
    );
    let plain = [
        encode_png(&picture().into()).unwrap(),
        encode_jpeg(&picture(), 95).unwrap(),
        encode_webp_lossless(&picture()).unwrap(),
    ];
    for file in plain {
        assert_eq!(find_foreign_profile(&file), None);
        for end in 0..file.len() {
            assert_eq!(find_foreign_profile(&file[..end]), None);
        }
    }
}
