//! Detects truncated JPEG files, whose missing part the decoder would silently fill with gray.

/// Whether the segments lead to an end-of-image marker.
pub(super) fn is_whole(file: &[u8]) -> bool {
    let mut rest = file;
    loop {
        // Between segments, and in entropy-coded data, skip everything up to the next 0xFF.
        let Some(at) = rest.iter().position(|&byte| byte == 0xff) else {
            return false;
        };
        rest = &rest[at + 1..];
        match rest {
            [0xd9, ..] => return true,
            // A data byte of 0xFF, a fill byte, and the markers without a segment.
            [0x00 | 0x01 | 0xd0..=0xd8, ..] => rest = &rest[1..],
            [0xff, ..] => {}
            [_, high, low, ..] => {
                let length = usize::from(u16::from_be_bytes([*high, *low]));
                let Some(behind) = rest.get(1 + length..) else {
                    return false;
                };
                rest = behind;
            }
            _ => return false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An application segment with an end marker inside (of a thumbnail), then a scan with a stuffed byte, a restart
    /// marker and a fill byte.
    const FILE: &[u8] = &[
        0xff, 0xd8, 0xff, 0xe1, 0, 4, 0xff, 0xd9, 0xff, 0xda, 0, 3, 1, 7, 0xff, 0, 8, 0xff, 0xd0, 9, 0xff,
        0xff, 0xd9,
    ];

    #[test]
    fn a_file_is_whole_at_its_own_end_marker_and_nowhere_before() {
        assert!(is_whole(FILE));
        assert!(is_whole(&[FILE, &[0, 1, 2]].concat()));
        for cut in 0..FILE.len() {
            assert!(!is_whole(&FILE[..cut]), "{cut}");
        }
    }
}
