//! The look of the waters: transmittance over range, a grey card at growing range, visibility over range and turbidity.

use imaging::{Plane, Rgb, transfer};
use optics::chain;
use optics::forward_scatter::KernelCache;
use optics::medium::Medium;
use optics::plan::{Plan, SceneBounds};
use optics::preset::{Channels, Preset, all_known, find, presets};
use optics::visibility;
use optics::water::{Water, properties};
use plotters::style::RGBColor;
use spec::{Fidelity, Optics};

use crate::plot::{Axis, Card, Cards, Form, Lines, Mark, Panel, Panels, Series};

const RED: RGBColor = RGBColor(204, 51, 51);
const GREEN: RGBColor = RGBColor(30, 140, 60);
const BLUE: RGBColor = RGBColor(40, 90, 200);
const FARTHEST_M: f64 = 15.0;
const DEEPEST_M: f64 = 30.0;
const POINTS: usize = 60;
/// Jerlov's types from the clearest ocean to the most turbid coast, each from its default source.
pub const TYPES: [&str; 10] = ["I", "IA", "IB", "II", "III", "1C", "3C", "5C", "7C", "9C"];

/// exp(-c Z) of every renderable water.
#[must_use]
pub fn transmittance() -> Panels {
    let waters = presets().iter().filter(|preset| preset.unrenderable().is_none());
    Panels {
        title: "Transmittance exp(-c Z) along a camera ray: red, green and blue light".to_owned(),
        foot: "Range Z in meters. Waters with a known beam attenuation c; narrow-band red, green, blue."
            .to_owned(),
        most: FARTHEST_M,
        ticks: vec![0.0, 5.0, 10.0, 15.0],
        panels: waters
            .map(|preset| panel(preset, preset.beam_attenuation, FARTHEST_M))
            .collect(),
        columns: 4,
    }
}

/// exp(-K_d h) of the waters that are defined only by K_d.
#[must_use]
pub fn daylight() -> Panels {
    let waters = presets().iter().filter(|preset| preset.name.starts_with("kd-"));
    Panels {
        title: "Daylight left at a depth, exp(-Kd h): not what a camera ray loses, which is more".to_owned(),
        foot: "Depth h in meters. Waters that are listed with Kd alone and cannot be rendered.".to_owned(),
        most: DEEPEST_M,
        ticks: vec![0.0, 10.0, 20.0, 30.0],
        panels: waters
            .map(|preset| panel(preset, preset.diffuse_attenuation, DEEPEST_M))
            .collect(),
        columns: 5,
    }
}

fn panel(preset: &Preset, coefficient: Channels, most: f64) -> Panel {
    let curve = |(color, k): (RGBColor, Option<f64>)| {
        let at = |i: usize| most * i as f64 / POINTS as f64;
        Some((
            color,
            k.map(|k| (0..=POINTS).map(|i| (at(i), (-k * at(i)).exp())).collect())?,
        ))
    };
    Panel {
        title: preset.name.clone(),
        curves: [RED, GREEN, BLUE]
            .into_iter()
            .zip(coefficient)
            .filter_map(curve)
            .collect(),
    }
}

/// A white, grey and black card at growing range in every renderable water, lit as in air.
#[must_use]
pub fn grey_cards() -> Cards {
    const RANGES_M: [f64; 11] = [0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 11.0, 15.0];
    const STRIPES: [f64; 3] = [0.9, 0.18, 0.03];
    let row = |preset: &Preset| {
        let c = all_known(preset.beam_attenuation)?;
        let veil = properties(preset).veiling_light?;
        let seen = |j: f64, z: f64| {
            let light = [0, 1, 2].map(|i| j * (-c[i] * z).exp() - veil[i] * (-c[i] * z).exp_m1());
            color(light)
        };
        let card = |z: &f64| Card {
            around: color(veil),
            stripes: STRIPES.map(|j| seen(j, *z)).to_vec(),
        };
        Some((preset.name.clone(), RANGES_M.iter().map(card).collect()))
    };
    let mut waters: Vec<&Preset> = presets()
        .iter()
        .filter(|preset| preset.unrenderable().is_none())
        .collect();
    let place = |preset: &Preset| {
        TYPES
            .iter()
            .position(|kind| Some(*kind) == preset.jerlov_type.as_deref())
    };
    waters.sort_by_key(|preset| place(preset).unwrap_or(TYPES.len()));
    Cards {
        title: "A card of white 0.9, grey 0.18 and black 0.03 at growing range, before open water".to_owned(),
        foot: "Lit as in air; the veil is that of a camera 5 m below the surface, exposed to 0.3.".to_owned(),
        columns: RANGES_M.iter().map(|z| format!("{z} m")).collect(),
        rows: waters.into_iter().filter_map(row).collect(),
    }
}

fn color(light: [f64; 3]) -> RGBColor {
    let code = |v: f64| (255.0 * transfer::encode(v.clamp(0.0, 1.0)) + 0.5) as u8;
    RGBColor(code(light[0]), code(light[1]), code(light[2]))
}

/// Visibility of a bright card on a wall over its range, in each type of water.
#[must_use]
pub fn visibility_over_range() -> Lines {
    const RANGES_M: [f64; 13] = [
        0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 11.0, 15.0,
    ];
    // Limited to the number of distinguishable colors.
    let types = TYPES.into_iter().filter(|kind| !["IA", "7C"].contains(kind));
    let series = types.filter_map(|kind| {
        let name = format!("jerlov-{kind}");
        let preset = find(&name).filter(|preset| preset.unrenderable().is_none())?;
        let marks = RANGES_M
            .iter()
            .filter_map(|&z| Some(mark(z, score(&preset.name, z, 1.0)?)));
        Some(Series {
            name,
            marks: marks.collect(),
            form: Form::Joined,
        })
    });
    Lines {
        title: "Visibility of a bright card on a wall: contrast after the water over contrast before"
            .to_owned(),
        x: Axis {
            title: "range in meters".to_owned(),
            logarithmic: false,
        },
        y: Axis {
            title: "visibility".to_owned(),
            logarithmic: false,
        },
        series: series.collect(),
    }
}

/// Visibility of the same card in one water of growing turbidity.
#[must_use]
pub fn visibility_over_turbidity() -> Lines {
    const TURBIDITIES: [f64; 11] = [0.125, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0];
    let series = [0.5, 1.0, 2.0, 4.0, 8.0].map(|z| {
        let marks = TURBIDITIES
            .iter()
            .filter_map(|&t| Some(mark(t, score("jerlov-1C", z, t)?)));
        Series {
            name: format!("card at {z} m"),
            marks: marks.collect(),
            form: Form::Joined,
        }
    });
    Lines {
        title: "The same card in jerlov-1C, all of its coefficients multiplied".to_owned(),
        x: Axis {
            title: "turbidity: factor of every coefficient (range_scale)".to_owned(),
            logarithmic: true,
        },
        y: Axis {
            title: "visibility".to_owned(),
            logarithmic: false,
        },
        series: series.to_vec(),
    }
}

fn mark(x: f64, y: f64) -> Mark {
    Mark {
        x,
        y,
        reach: None,
        label: String::new(),
        ringed: false,
    }
}

/// The visibility of a card of 0.6 on a wall of 0.2, both at one range, through the whole chain.
fn score(preset: &str, range_m: f64, turbidity: f64) -> Option<f64> {
    const SIZE: (usize, usize) = (96, 64);
    const CARD: [usize; 4] = [36, 22, 60, 42];
    const FOCAL_PX: f64 = 60.0;
    let request = Medium {
        range_scale: turbidity,
        ..Optics {
            preset: Some(preset.to_owned()),
            ..Optics::default()
        }
        .into()
    };
    let water = Water::resolve(&request, FOCAL_PX).ok()?;
    let numbers = Plane::from_fn(SIZE.0, SIZE.1, |x, y| {
        u16::from((CARD[0]..CARD[2]).contains(&x) && (CARD[1]..CARD[3]).contains(&y))
    });
    let before = Rgb::from_fn(SIZE.0, SIZE.1, |x, y| {
        [if numbers.pixel(x, y) == 1 { 0.6f32 } else { 0.2 }; 3]
    });
    let range = Plane::filled(SIZE.0, SIZE.1, range_m as f32);
    let stats = SceneBounds::measure(&before, &range, &water);
    let plan = Plan::for_water(&stats, &water, Fidelity::Tolerance(1e-4));
    let layers = chain::water(&before, &range, &water, &plan, &mut KernelCache::default()).ok()?;
    visibility(&before, &layers.scattered, &numbers, 1, CARD)?.score()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::plot::{Figure, picture};

    #[test]
    fn every_water_has_its_panel_and_its_row() {
        let renderable = presets()
            .iter()
            .filter(|preset| preset.unrenderable().is_none())
            .count();
        assert_eq!(transmittance().panels.len(), renderable);
        assert!(transmittance().panels.iter().all(|panel| panel.curves.len() == 3));
        assert_eq!(
            (daylight().panels.len(), grey_cards().rows.len()),
            (30, renderable)
        );
        let drawn = picture(&transmittance()).unwrap();
        let (width, height) = transmittance().size();
        assert_eq!((drawn.width(), drawn.height()), (width as usize, height as usize));
    }

    #[test]
    fn a_card_at_no_range_is_itself_and_far_away_it_is_the_water() {
        for (name, cells) in grey_cards().rows {
            assert_eq!(cells[0].stripes[1], color([0.18; 3]), "{name}");
            let thick = find(&name)
                .unwrap()
                .beam_attenuation
                .iter()
                .flatten()
                .all(|&c| c > 0.9);
            let last = cells.last().unwrap();
            assert!(
                !thick || last.stripes.iter().all(|stripe| *stripe == last.around),
                "{name}"
            );
        }
    }

    #[test]
    fn visibility_falls_with_range_and_with_turbidity() {
        for lines in [visibility_over_range(), visibility_over_turbidity()] {
            for series in lines.series {
                let falls = series.marks.windows(2).all(|pair| pair[1].y <= pair[0].y + 1e-4);
                assert!(
                    series.marks.len() > 9 && falls,
                    "{}: {:?}",
                    series.name,
                    series.marks
                );
            }
        }
    }
}
