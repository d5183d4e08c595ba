//! The look of the waters: transmittance over range, a grey card at growing range, visibility over range and turbidity.

use cli::exit::Failure;
use cli::sheet::{Tile, sheet};
use imaging::{Plane, Rgb, Rgb8, transfer};
use optics::chain;
use optics::forward_scatter::KernelCache;
use optics::medium::Medium;
use optics::plan::{Plan, SceneBounds};
use optics::preset::{Channels, Preset, all_known, find, presets};
use optics::visibility;
use optics::water::{Water, properties};
use spec::{Fidelity, Optics};

use crate::plot::{Axis, Chart, Form, Lines, Panels, Series};
use crate::report::Report;
use crate::setup::Setup;

const COLORS: [&str; 3] = ["#cc3333", "#1e8c3c", "#285ac8"];
const POINTS: usize = 60;
/// Jerlov's types from the clearest ocean to the most turbid coast, each from its default source.
const TYPES: [&str; 10] = ["I", "IA", "IB", "II", "III", "1C", "3C", "5C", "7C", "9C"];
/// Ranges of the grey cards, m.
const CARDS_M: [f64; 11] = [0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 11.0, 15.0];
const CARD_PX: (usize, usize) = (84, 60);
/// Reflectances of the stripes of a card.
const STRIPES: [f64; 3] = [0.9, 0.18, 0.03];

/// Draws the waters.
///
/// # Errors
/// None.
pub fn run(_: &Setup) -> Result<Report, Failure> {
    let mut report = Report::new(
        "Waters by wavelength, range and turbidity.".to_owned(),
        Vec::new(),
    );
    for (name, chart) in [
        ("transmittance", draw_transmittance()),
        ("daylight", draw_daylight()),
        ("visibility-range", draw_visibility_over_range()),
        ("visibility-turbidity", draw_visibility_over_turbidity()),
    ] {
        report.add_chart(name, chart);
    }
    report.pictures.push(("grey-cards".to_owned(), draw_cards()));
    Ok(report)
}

fn renderable() -> impl Iterator<Item = &'static Preset> {
    presets().iter().filter(|preset| preset.unrenderable().is_none())
}

/// exp(-c Z) of every renderable water.
fn draw_transmittance() -> Chart {
    let panels = renderable().map(|preset| draw_decay(preset, preset.beam_attenuation, 15.0));
    Chart::Panels(Panels {
        title: "Transmittance exp(-c Z) over range Z in meters along a camera ray: red, green and blue light"
            .to_owned(),
        panels: panels.collect(),
        columns: 4,
    })
}

/// exp(-K_d h) of the waters that are defined only by K_d.
fn draw_daylight() -> Chart {
    let waters = presets().iter().filter(|preset| preset.name.starts_with("kd-"));
    Chart::Panels(Panels {
        title: "Daylight left at depth h in meters, exp(-Kd h); a camera ray loses more".to_owned(),
        panels: waters
            .map(|preset| draw_decay(preset, preset.diffuse_attenuation, 30.0))
            .collect(),
        columns: 5,
    })
}

fn draw_decay(preset: &Preset, coefficient: Channels, most: f64) -> Lines {
    let series = COLORS.into_iter().zip(coefficient).filter_map(|(color, k)| {
        let k = k?;
        let meters = (0..=POINTS).map(|i| most * i as f64 / POINTS as f64);
        Some(Series::new(
            "",
            meters.map(|z| (z, (-k * z).exp())),
            Form::Curve(color),
        ))
    });
    Lines {
        title: preset.name.clone(),
        x: Axis::linear(""),
        y: Axis::linear(""),
        series: series.collect(),
    }
}

/// A white, grey and black card at growing range in front of the open water of every renderable water, lit as in air.
fn draw_cards() -> Rgb8 {
    let mut waters: Vec<&Preset> = renderable().collect();
    waters.sort_by_key(|preset| {
        let kind = TYPES
            .iter()
            .position(|kind| Some(*kind) == preset.jerlov_type.as_deref());
        kind.unwrap_or(TYPES.len())
    });
    let tiles = waters.into_iter().filter_map(|preset| {
        let (c, veil) = (
            all_known(preset.beam_attenuation)?,
            properties(preset).veiling_light?,
        );
        let picture = Rgb8::from_fn(CARDS_M.len() * CARD_PX.0, CARD_PX.1, |x, y| {
            let (left, z) = (x % CARD_PX.0, CARDS_M[x / CARD_PX.0]);
            let is_card = (16..CARD_PX.0 - 16).contains(&left) && (9..CARD_PX.1 - 9).contains(&y);
            match is_card {
                true => card_color(STRIPES[(y - 9) * STRIPES.len() / (CARD_PX.1 - 18)], z, c, veil),
                false => encode(veil),
            }
        });
        let meters = CARDS_M.map(|z| z.to_string()).join(", ");
        Some(Tile {
            picture,
            caption: vec![format!("{}: {meters} m", preset.name)],
        })
    });
    sheet(&tiles.collect::<Vec<_>>(), 1, CARDS_M.len() * CARD_PX.0)
}

/// The color of a surface at a range.
fn card_color(reflectance: f64, z: f64, c: [f64; 3], veil: [f64; 3]) -> [u8; 3] {
    encode([0, 1, 2].map(|i| reflectance * (-c[i] * z).exp() - veil[i] * (-c[i] * z).exp_m1()))
}

fn encode(light: [f64; 3]) -> [u8; 3] {
    light.map(|v| (255.0 * transfer::encode(v.clamp(0.0, 1.0)) + 0.5) as u8)
}

/// Visibility of a bright card on a wall over its range, in each type of water.
fn draw_visibility_over_range() -> Chart {
    const RANGES_M: [f64; 13] = [
        0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 11.0, 15.0,
    ];
    // Limited to the number of distinguishable colors.
    let types = TYPES.into_iter().filter(|kind| !["IA", "7C"].contains(kind));
    let series = types.filter_map(|kind| {
        let name = format!("jerlov-{kind}");
        let preset = find(&name).filter(|preset| preset.unrenderable().is_none())?;
        let points = RANGES_M
            .iter()
            .filter_map(|&z| Some((z, measure_visibility(&preset.name, z, 1.0)?)));
        Some(Series::new(name, points, Form::Joined))
    });
    Chart::Lines(Lines {
        title: "Visibility of a bright card on a wall: contrast after the water over contrast before"
            .to_owned(),
        x: Axis::linear("range in meters"),
        y: Axis::linear("visibility"),
        series: series.collect(),
    })
}

/// Visibility of the same card in one water of growing turbidity.
fn draw_visibility_over_turbidity() -> Chart {
    const TURBIDITIES: [f64; 11] = [0.125, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0];
    let series = [0.5, 1.0, 2.0, 4.0, 8.0].map(|z| {
        let points = TURBIDITIES
            .iter()
            .filter_map(|&t| Some((t, measure_visibility("jerlov-1C", z, t)?)));
        Series::new(format!("card at {z} m"), points, Form::Joined)
    });
    Chart::Lines(Lines {
        title: "The same card in jerlov-1C, all of its coefficients multiplied".to_owned(),
        x: Axis::logarithmic("turbidity: factor of every coefficient (range_scale)"),
        y: Axis::linear("visibility"),
        series: series.to_vec(),
    })
}

/// The visibility of a card of 0.6 on a wall of 0.2, both at one range, through the whole chain.
fn measure_visibility(preset: &str, range_m: f64, turbidity: f64) -> Option<f64> {
    const SIZE: (usize, usize) = (96, 64);
    const CARD: [usize; 4] = [36, 22, 60, 42];
    let optics = Optics {
        preset: Some(preset.to_owned()),
        ..Optics::default()
    };
    let request = Medium {
        range_scale: turbidity,
        ..optics.into()
    };
    let water = Water::resolve(&request, 60.0).ok()?;
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
    use super::*;

    #[test]
    fn every_water_has_its_panel_and_its_cards() {
        let Chart::Panels(panels) = draw_transmittance() else {
            unreachable!("panels")
        };
        assert_eq!(panels.panels.len(), renderable().count());
        assert!(panels.panels.iter().all(|panel| panel.series.len() == 3));
        let Chart::Panels(panels) = draw_daylight() else {
            unreachable!("panels")
        };
        assert_eq!(panels.panels.len(), 30);
        let cards = draw_cards();
        assert_eq!(cards.width(), 16 + CARDS_M.len() * CARD_PX.0);
        assert!(cards.height() > renderable().count() * CARD_PX.1);
    }

    #[test]
    fn a_card_at_no_range_is_itself_and_far_away_it_is_the_water() {
        for preset in renderable() {
            let c = all_known(preset.beam_attenuation).unwrap();
            let veil = properties(preset).veiling_light.unwrap();
            assert_eq!(
                card_color(0.18, 0.0, c, veil),
                encode([0.18; 3]),
                "{}",
                preset.name
            );
            if c.iter().all(|&c| c > 0.9) {
                assert_eq!(card_color(0.9, 15.0, c, veil), encode(veil), "{}", preset.name);
            }
        }
    }

    #[test]
    fn visibility_falls_with_range_and_with_turbidity() {
        for chart in [draw_visibility_over_range(), draw_visibility_over_turbidity()] {
            let Chart::Lines(lines) = chart else {
                unreachable!("lines")
            };
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
