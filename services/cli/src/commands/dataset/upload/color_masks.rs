//! Masks whose objects or classes have colors instead of numbers.

use std::collections::{BTreeMap, BTreeSet};

use cli::exit::Failure;
use imaging::codec::{decode_mask, decode_picture, encode_png};
use imaging::{Plane, Raster};
use serde_json::{Map, Value, json};

/// Most colors of a mask: a blurred or compressed mask has more.
const MAX_COLORS: usize = 4096;

/// A mask of numbers, with the names of its objects.
pub(super) struct NumberedMask {
    pub(super) png: Vec<u8>,
    /// JSON of the classes by number.
    pub(super) classes: Option<Vec<u8>>,
}

/// The classes of SUIM by the bits of their color: red, green, blue.
const SUIM_CLASSES: [&str; 7] = [
    "human diver",
    "aquatic plant",
    "wreck",
    "robot",
    "reef",
    "fish",
    "sea floor",
];

/// Numbers the classes of a SUIM mask 1 to 7; a channel above half is a set bit, as in the tools of the data set.
pub(super) fn number_suim(bytes: &[u8]) -> Result<NumberedMask, Failure> {
    let picture = decode_picture(bytes).map_err(Failure::input)?.to_rgb8();
    let mask = Plane::from_fn(picture.width(), picture.height(), |x, y| {
        let bits = picture.pixel(x, y).map(|channel| u16::from(channel > 127));
        bits[0] << 2 | bits[1] << 1 | bits[2]
    });
    let shown: BTreeSet<u16> = mask.data().iter().copied().filter(|&number| number > 0).collect();
    let names = shown.iter().map(|&number| {
        let name = SUIM_CLASSES[usize::from(number) - 1];
        (number.to_string(), json!(name))
    });
    Ok(NumberedMask {
        png: encode(mask)?,
        classes: encode_classes(names.collect()),
    })
}

/// Numbers the colors of a mask in their order; black and transparent are the background. `names` are the classes by
/// color `(r, g, b, a)` or by number, as Isaac Sim writes them. A mask of numbers keeps them.
pub(super) fn number_colors(bytes: &[u8], names: Option<&Value>) -> Result<NumberedMask, Failure> {
    if let Ok(mask) = decode_mask(bytes) {
        let shown: BTreeSet<u16> = mask.data().iter().copied().filter(|&number| number > 0).collect();
        let classes = shown.iter().filter_map(|number| {
            let name = find_class(names?.get(number.to_string())?)?;
            Some((number.to_string(), json!(name)))
        });
        return Ok(NumberedMask {
            png: bytes.to_vec(),
            classes: encode_classes(classes.collect()),
        });
    }
    let raster = decode_picture(bytes).map_err(Failure::input)?;
    let alpha = raster.alpha().map(|alpha| alpha.to_u8());
    let picture = raster.to_rgb8();
    let (width, height) = (picture.width(), picture.height());
    let colors: Vec<[u8; 3]> = (0..width * height)
        .map(|pixel| match &alpha {
            Some(alpha) if alpha[pixel] == 0 => [0; 3],
            _ => picture.pixel(pixel % width, pixel / width),
        })
        .collect();
    let shown: BTreeSet<[u8; 3]> = colors.iter().copied().filter(|color| *color != [0; 3]).collect();
    if shown.len() > MAX_COLORS {
        return Err(Failure::BadInput(format!(
            "the mask has {} colors; must be at most {MAX_COLORS}: save it without compression or blur",
            shown.len()
        )));
    }
    let numbers: BTreeMap<[u8; 3], u16> = shown.into_iter().zip(1..).collect();
    let classes = numbers.iter().filter_map(|([red, green, blue], number)| {
        let names = names?;
        let key = format!("({red}, {green}, {blue}, 255)");
        let name = find_class(names.get(&key).or_else(|| names.get(key.replace(", ", ",")))?)?;
        Some((number.to_string(), json!(name)))
    });
    let codes = colors
        .iter()
        .map(|color| numbers.get(color).copied().unwrap_or(0));
    let mask = Plane::new(width, height, codes.collect()).map_err(Failure::input)?;
    Ok(NumberedMask {
        png: encode(mask)?,
        classes: encode_classes(classes.collect()),
    })
}

/// The class of an entry of a mapping: a text, or an object with `class`. The background has none.
fn find_class(entry: &Value) -> Option<&str> {
    let name = entry.as_str().or_else(|| entry.get("class")?.as_str())?;
    (!name.eq_ignore_ascii_case("background") && !name.eq_ignore_ascii_case("unlabelled")).then_some(name)
}

fn encode_classes(classes: Map<String, Value>) -> Option<Vec<u8>> {
    (!classes.is_empty()).then(|| Value::Object(classes).to_string().into_bytes())
}

fn encode(mask: Plane<u16>) -> Result<Vec<u8>, Failure> {
    encode_png(&Raster::from(mask)).map_err(Failure::input)
}

#[cfg(test)]
mod tests {
    use imaging::{Channels, Rgb8, Samples};

    use super::*;

    #[test]
    fn the_colors_of_suim_are_its_classes() {
        let colors = [[0, 0, 0], [0, 0, 255], [255, 0, 0], [250, 255, 3]];
        let picture = Rgb8::from_fn(4, 1, |x, _| colors[x]);
        let mask = number_suim(&encode_png(&picture.into()).unwrap()).unwrap();
        assert_eq!(decode_mask(&mask.png).unwrap().data(), [0, 1, 4, 6]);
        let classes: Value = serde_json::from_slice(&mask.classes.unwrap()).unwrap();
        assert_eq!(classes, json!({"1": "human diver", "4": "robot", "6": "fish"}));
    }

    #[test]
    fn colors_and_numbers_get_the_classes_of_the_mapping() {
        let samples = vec![0, 0, 0, 140, 25, 255, 25, 255, 140, 140, 25, 255];
        let raster = Raster::new(
            4,
            1,
            Channels::Rgb,
            Samples::U8(samples),
            Some(Samples::U8(vec![0, 255, 255, 255])),
        );
        let bytes = encode_png(&raster.unwrap()).unwrap();
        let names =
            json!({"(140, 25, 255, 255)": {"class": "cube"}, "(0, 0, 0, 0)": {"class": "BACKGROUND"}});
        let mask = number_colors(&bytes, Some(&names)).unwrap();
        assert_eq!(decode_mask(&mask.png).unwrap().data(), [0, 2, 1, 2]);
        let classes: Value = serde_json::from_slice(&mask.classes.unwrap()).unwrap();
        assert_eq!(classes, json!({"2": "cube"}));
        let numbers = encode_png(&Raster::from(Plane::new(2, 1, vec![0u16, 300]).unwrap())).unwrap();
        let mask = number_colors(
            &numbers,
            Some(&json!({"300": {"class": "pile"}, "0": "BACKGROUND"})),
        )
        .unwrap();
        assert_eq!(mask.png, numbers);
        let classes: Value = serde_json::from_slice(&mask.classes.unwrap()).unwrap();
        assert_eq!(classes, json!({"300": "pile"}));
    }
}
