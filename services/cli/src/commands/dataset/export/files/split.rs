//! Splits of a dataset into parts for training and for testing, by the scene of each frame.
//!
//! The place of a scene is a number u in 0 ≤ u < 1: the first 64 bits of the SHA-256 of `fathom split`, a line break, and the
//! scene's identity, over 2^64. The parts divide that interval by their shares. So a frame never changes its part when the dataset
//! grows, and frames of one scene are never in two parts, in any water.

use client::ImageRow;
use spec::sha256;

/// Columns that identify a scene.
pub(crate) const IDENTITY: [&str; 4] = ["scene.kind", "scene.family", "scene.seed", "scene.id"];
/// The kind of an uploaded scene, as JSON.
const UPLOADED: &str = "\"uploaded\"";
/// Tolerance of the sum of shares, which are written with a few decimals.
const TOLERANCE: f64 = 1e-6;

/// The parts in their order.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Splits(Vec<Part>);

#[derive(Debug, Clone, PartialEq)]
struct Part {
    name: String,
    share: f64,
}

impl Splits {
    /// Reads `train=.8,val=.1,test=.1`.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let parts = text.split(',').map(part).collect::<Result<Vec<_>, _>>()?;
        for (index, part) in parts.iter().enumerate() {
            if parts[..index].iter().any(|other| other.name == part.name) {
                return Err(format!("`{}` is named twice", part.name));
            }
        }
        let sum: f64 = parts.iter().map(|part| part.share).sum();
        if (sum - 1.0).abs() > TOLERANCE {
            return Err(format!("the shares add up to {sum}, not to 1"));
        }
        Ok(Self(parts))
    }

    /// The names of the parts.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|part| part.name.as_str())
    }

    /// Position of the part of an image, from its row of columns.
    pub(crate) fn part_of(&self, row: &ImageRow) -> usize {
        let identity = IDENTITY.iter().filter_map(|column| {
            let value = Some(row.value(column)).filter(|value| !value.is_null())?;
            // The same scene, whether a job names it or its collection.
            let value = if value == "collection" {
                UPLOADED
            } else {
                &value.to_string()
            };
            Some(format!("\n{column}={value}"))
        });
        let place = place(&identity.collect::<String>());
        let mut end = 0.0;
        let position = self.0.iter().position(|part| {
            end += part.share;
            place < end
        });
        position.unwrap_or(self.0.len() - 1)
    }
}

impl std::fmt::Display for Splits {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let parts = self.0.iter().map(|part| format!("{}={}", part.name, part.share));
        f.write_str(&parts.collect::<Vec<_>>().join(","))
    }
}

fn part(text: &str) -> Result<Part, String> {
    let Some((name, share)) = text.split_once('=') else {
        return Err(format!("`{text}` is not NAME=SHARE, such as train=.8"));
    };
    if name.is_empty()
        || name.len() > 32
        || !name
            .chars()
            .all(|c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_' || c == '-')
    {
        return Err(format!("`{name}` is not 1 to 32 of a-z 0-9 _ -"));
    }
    match share.parse::<f64>() {
        Ok(share) if share > 0.0 && share <= 1.0 => Ok(Part {
            name: name.to_owned(),
            share,
        }),
        _ => Err(format!("{name}: `{share}` is not a share above 0 and at most 1")),
    }
}

/// The position of a scene in 0..1.
fn place(identity: &str) -> f64 {
    let digest = sha256(format!("fathom split{identity}").as_bytes());
    let first = u64::from_str_radix(&digest[..16], 16).unwrap_or_default();
    // The 53 bits that a double holds, so that the result is below 1.
    (first >> 11) as f64 / (1u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    fn row(columns: Value) -> ImageRow {
        serde_json::from_value(columns).unwrap()
    }

    fn scene(seed: u64) -> Value {
        json!({"job": "job_1", "frame": seed, "alpha": 0.5, "scene.kind": "procedural", "scene.family": "structure", "scene.seed": seed})
    }

    #[test]
    fn the_part_follows_the_scene_alone() {
        let splits = Splits::parse("train=.8,val=.1,test=.1").unwrap();
        for seed in 0..50 {
            let mut other = scene(seed);
            other["job"] = json!("job_2");
            other["frame"] = json!(7);
            other["alpha"] = json!(0.1);
            other["water.optics"] = json!("jerlov-3C");
            assert_eq!(splits.part_of(&row(other)), splits.part_of(&row(scene(seed))));
        }
    }

    #[test]
    fn a_scene_stays_in_its_part_when_a_collection_names_it() {
        let splits = Splits::parse("train=.5,test=.5").unwrap();
        for number in 0..50 {
            let named = |kind: &str| row(json!({"scene.kind": kind, "scene.id": format!("scn_{number}")}));
            assert_eq!(
                splits.part_of(&named("collection")),
                splits.part_of(&named("uploaded"))
            );
        }
    }

    #[test]
    fn parts_have_their_shares_of_many_scenes() {
        let splits = Splits::parse("train=.8,val=.1,test=.1").unwrap();
        let mut counts = [0; 3];
        (0..10_000).for_each(|seed| counts[splits.part_of(&row(scene(seed)))] += 1);
        // Four standard deviations.
        assert!((7840..=8160).contains(&counts[0]), "{counts:?}");
        assert!(
            (880..=1120).contains(&counts[1]) && (880..=1120).contains(&counts[2]),
            "{counts:?}"
        );
    }

    #[test]
    fn the_place_of_a_scene_is_what_the_documentation_says() {
        // python3: int(hashlib.sha256(b"fathom split\nscene.kind=\"uploaded\"\nscene.id=\"scn_1\"").hexdigest()[:16], 16) / 2**64
        let place = place("\nscene.kind=\"uploaded\"\nscene.id=\"scn_1\"");
        assert!((place - PLACE_OF_SCN_1).abs() < 1e-12, "{place}");
    }

    const PLACE_OF_SCN_1: f64 = 0.19219946296207124;

    #[test]
    fn wrong_splits_say_what_is_wrong() {
        for (text, part) in [
            ("train", "NAME=SHARE"),
            ("train=.5,test=.4", "0.9"),
            ("a=.5,a=.5", "twice"),
            ("../x=1", "a-z"),
            ("a=2", "at most 1"),
            ("a=NaN", "at most 1"),
        ] {
            let message = Splits::parse(text).unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}
