//! Whether a JPEG file is whole. The decoder silently fills the missing part of a truncated file with gray.

/// Whether the file reaches its end-of-image marker, walking from segment to segment.
pub(super) fn is_whole(file: &[u8]) -> bool {
    let mut rest = file;
    loop {
        // Between segments, and in entropy-coded data, everything up to the next 0xFF is passed over.
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

    /// An application segment that holds an end marker of its own (a thumbnail's), then a scan with a stuffed byte, a
    /// restart marker and a fill byte.
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
