//! Artifacts as pictures that a person can read: masks in colors, ranges as a ramp, linear layers encoded.

use cli::classes::Named;
use cli::colors;
use cli::exit::Failure;
use cli::sheet::Legend;
use imaging::codec::{self, FilePlane, Radiance};
use imaging::{Plane, Rgb8, transfer};
use scenes::categories::FINDINGS;

/// Meters of one code of a stored range.
const RANGE_UNIT_M: f64 = 1e-3;
/// Codes for each pixel of a motion: 32 px to either side.
const MOTION_CODES: f32 = 4.0;
/// Numbers below the ramp.
const TICKS: usize = 5;
/// The color of pixels without a return.
const HOLE: [u8; 3] = [0, 0, 0];

/// An artifact as it was stored.
pub(crate) enum Stored {
    Picture(Rgb8),
    Range(Plane<u16>),
    Semantics(Plane<u16>),
    Instances(Plane<u16>),
    Findings(Plane<u16>),
}

impl Stored {
    /// Reads an artifact of a kind.
    pub(crate) fn read(kind: &str, bytes: &[u8]) -> Result<Self, Failure> {
        let codes = || match codec::decode_plane(bytes) {
            Ok(FilePlane::Codes(codes)) => Ok(codes),
            Ok(_) => Err(Failure::input(format!(
                "{kind} is stored as floats, not as codes"
            ))),
            Err(error) => Err(unreadable(kind, &error)),
        };
        Ok(match kind {
            "range" => Self::Range(codes()?),
            "semantics" | "semantics.visible" => Self::Semantics(codes()?),
            "instances" => Self::Instances(codes()?),
            "findings" => Self::Findings(codes()?),
            "normals" => Self::Picture(linear(kind, bytes, |axes| {
                axes.map(|v| ((0.5 + 0.5 * v) * 255.0) as u8)
            })?),
            "flow" | "disparity" => Self::Picture(linear(kind, bytes, |motion| {
                motion.map(|v| (127.5 + MOTION_CODES * v) as u8)
            })?),
            "transmittance" => {
                Self::Picture(linear(kind, bytes, |shares| shares.map(|v| (v * 255.0) as u8))?)
            }
            "direct" | "forward_scatter" | "backscatter" => Self::Picture(linear(kind, bytes, |light| {
                light.map(|v| (transfer::encode(f64::from(v.clamp(0.0, 1.0))) * 255.0).round() as u8)
            })?),
            "boxes" => {
                return Err(Failure::input(
                    "boxes are not a picture; use `--kind semantics` to see their objects",
                ));
            }
            _ => {
                let picture = codec::decode_picture(bytes).map_err(|error| unreadable(kind, &error))?;
                Self::Picture(picture.to_rgb8())
            }
        })
    }
}

fn unreadable(kind: &str, error: &dyn std::fmt::Display) -> Failure {
    anyhow::anyhow!("artifact {kind} cannot be read: {error}").into()
}

/// A layer of floats as a picture.
fn linear(kind: &str, bytes: &[u8], paint: impl Fn([f32; 3]) -> [u8; 3]) -> Result<Rgb8, Failure> {
    match codec::decode_radiance(bytes) {
        Ok(Radiance::Linear(layer)) => Ok(Rgb8::from_fn(layer.width(), layer.height(), |x, y| {
            paint(layer.pixel(x, y))
        })),
        Ok(Radiance::Encoded(picture)) => Ok(picture.to_rgb8()),
        Err(error) => Err(unreadable(kind, &error)),
    }
}

/// The common scale of a sheet's artifacts, which makes them comparable.
pub(crate) struct Paint {
    /// Nearest and farthest range on the sheet, in meters.
    near_m: f64,
    far_m: f64,
}

impl Paint {
    pub(crate) fn new<'a>(all: impl Iterator<Item = &'a Stored>) -> Self {
        let mut limits: Option<(u16, u16)> = None;
        for stored in all {
            if let Stored::Range(codes) = stored {
                for &code in codes.data().iter().filter(|&&code| code != 0) {
                    let (near, far) = limits.get_or_insert((code, code));
                    (*near, *far) = ((*near).min(code), (*far).max(code));
                }
            }
        }
        let (near, far) = limits.unwrap_or_default();
        Self {
            near_m: f64::from(near) * RANGE_UNIT_M,
            far_m: f64::from(far) * RANGE_UNIT_M,
        }
    }

    /// The picture of an artifact.
    pub(crate) fn picture(&self, stored: &Stored) -> Rgb8 {
        let paint = |codes: &Plane<u16>, color: &dyn Fn(u16) -> [u8; 3]| {
            Rgb8::from_fn(codes.width(), codes.height(), |x, y| color(codes.pixel(x, y)))
        };
        match stored {
            Stored::Picture(picture) => picture.clone(),
            Stored::Range(codes) => paint(codes, &|code| self.range(code)),
            Stored::Semantics(codes) => paint(codes, &|code| colors::category(code as u8)),
            Stored::Instances(codes) => paint(codes, &colors::instance),
            Stored::Findings(codes) => paint(codes, &|bits| {
                colors::finding(bits as u8).unwrap_or_else(|| colors::category(0))
            }),
        }
    }

    /// By the logarithm: an object a meter away and the ground at the limit of sight share a picture.
    fn range(&self, code: u16) -> [u8; 3] {
        if code == 0 {
            return HOLE;
        }
        let range_m = f64::from(code) * RANGE_UNIT_M;
        let share = (range_m / self.near_m).ln() / (self.far_m / self.near_m).ln();
        colors::ramp(if share.is_finite() { share } else { 0.0 })
    }

    /// Ranges at equal steps of the ramp.
    fn ticks(&self) -> Vec<String> {
        let range_m =
            |step: usize| self.near_m * (self.far_m / self.near_m).powf(step as f64 / (TICKS - 1) as f64);
        (0..TICKS).map(|step| format!("{:.2} m", range_m(step))).collect()
    }

    /// The legend of a sheet; `classes` are those of its scenes.
    pub(crate) fn legend(&self, all: &[Stored], classes: &Named) -> Option<Legend> {
        match all.first()? {
            Stored::Picture(_) | Stored::Instances(_) => None,
            Stored::Range(_) if self.far_m > 0.0 => Some(Legend::Ramp {
                color: colors::ramp,
                ticks: self.ticks(),
                hole: Some((HOLE, "no return".to_owned())),
            }),
            Stored::Range(_) => None,
            Stored::Semantics(_) => {
                let is_shown = |number: u8| {
                    all.iter()
                        .any(|stored| has(stored, |code| code == u16::from(number)))
                };
                let shown = classes.iter().filter(|(number, _)| is_shown(*number));
                let named = shown.map(|(number, name)| (colors::category(*number), name.clone()));
                Some(Legend::Colors(named.collect()))
            }
            Stored::Findings(_) => {
                let shown = FINDINGS.iter();
                let shown = shown.filter(|(finding, _)| {
                    all.iter()
                        .any(|stored| has(stored, |bits| bits as u8 & finding.bit() != 0))
                });
                Some(Legend::Colors(
                    shown
                        .filter_map(|(finding, name)| {
                            Some((colors::finding(finding.bit())?, (*name).to_owned()))
                        })
                        .collect(),
                ))
            }
        }
    }
}

/// Whether a pixel of a mask has this property.
fn has(stored: &Stored, is_it: impl Fn(u16) -> bool) -> bool {
    match stored {
        Stored::Semantics(codes) | Stored::Findings(codes) => codes.data().iter().any(|&code| is_it(code)),
        Stored::Picture(_) | Stored::Range(_) | Stored::Instances(_) => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(codes: &[u16]) -> Plane<u16> {
        Plane::new(codes.len(), 1, codes.to_vec()).unwrap()
    }

    #[test]
    fn ranges_of_one_sheet_share_their_scale_and_holes_stay_black() {
        let all = [
            Stored::Range(plane(&[0, 1000, 2000])),
            Stored::Range(plane(&[5000, 0])),
        ];
        let paint = Paint::new(all.iter());
        let (first, second) = (paint.picture(&all[0]), paint.picture(&all[1]));
        assert_eq!([first.pixel(0, 0), second.pixel(1, 0)], [HOLE; 2]);
        assert_eq!(
            [first.pixel(1, 0), second.pixel(0, 0)],
            [colors::ramp(0.0), colors::ramp(1.0)]
        );
        assert_eq!(first.pixel(2, 0), colors::ramp(2f64.ln() / 5f64.ln()));
        let Some(Legend::Ramp { ticks, .. }) = paint.legend(&all, &Named::new()) else {
            panic!("no legend");
        };
        assert_eq!(ticks, ["1.00 m", "1.50 m", "2.24 m", "3.34 m", "5.00 m"]);
    }

    #[test]
    fn one_range_alone_or_none_at_all_is_no_trouble() {
        for codes in [[0, 0], [1500, 1500]] {
            let all = [Stored::Range(plane(&codes))];
            let paint = Paint::new(all.iter());
            let expected = if codes[0] == 0 { HOLE } else { colors::ramp(0.0) };
            assert_eq!(paint.picture(&all[0]).pixel(1, 0), expected);
            assert_eq!(paint.legend(&all, &Named::new()).is_some(), codes[0] > 0);
        }
    }

    #[test]
    fn the_legend_names_the_classes_in_view() {
        let classes = [(0, "background"), (1, "seabed"), (2, "pile"), (6, "pipe")];
        let classes: Named = classes.map(|(number, name)| (number, name.to_owned())).into();
        let all = [
            Stored::Semantics(plane(&[0, 2])),
            Stored::Semantics(plane(&[2, 6])),
        ];
        let Some(Legend::Colors(shown)) = Paint::new(all.iter()).legend(&all, &classes) else {
            panic!("no legend");
        };
        let names: Vec<&str> = shown.iter().map(|(_, name)| name.as_str()).collect();
        assert_eq!(names, ["background", "pile", "pipe"]);
        assert_eq!(shown[1].0, colors::category(2));
    }
}
