//! The size of the small pictures.

/// Columns and rows of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PictureSize {
    pub(super) width: usize,
    pub(super) height: usize,
}

/// Sides of a traced picture, px: smaller ones have too few blocks, larger ones take minutes for each frame.
const SIDES_PX: std::ops::RangeInclusive<usize> = 16..=512;

/// Reads columns and rows, such as 64x41.
pub(super) fn parse_size(text: &str) -> Result<PictureSize, String> {
    let sides = text.split_once('x').and_then(|(width, height)| {
        let [width, height] = [width, height].map(|side| side.parse::<usize>().ok());
        Some(PictureSize {
            width: width?,
            height: height?,
        })
    });
    let size = sides.ok_or_else(|| "must be columns and rows, such as 64x41".to_owned())?;
    if [size.width, size.height]
        .iter()
        .all(|side| SIDES_PX.contains(side))
    {
        return Ok(size);
    }
    Err(format!(
        "both sides must be {} to {} px",
        SIDES_PX.start(),
        SIDES_PX.end()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_has_two_sides_within_limits() {
        let size = parse_size("64x41").unwrap();
        assert_eq!((size.width, size.height), (64, 41));
        for wrong in ["64", "64x", "x41", "8x8", "4000x41", "64x41x2", "-3x20"] {
            assert!(parse_size(wrong).is_err(), "{wrong}");
        }
    }
}
