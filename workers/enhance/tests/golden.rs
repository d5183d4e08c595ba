//! Every stage of HSCM against reference output, each from the reference output of the previous stage, and the complete
//! chain from the input.

mod cases;
#[path = "cases/method.rs"]
mod method;
#[path = "golden/water.rs"]
mod water;

use std::fs;
use std::path::Path;

use cases::Case;
use enhance::hscm::homomorphic::{self, Filter};
use enhance::hscm::{Luma, clahe, median, merge};
use enhance::mask::{black_out, circle_plane};
use enhance::{Method, Variant, enhance, refuse_network, run_variant};
use imaging::codec::{FilePlane, decode_plane, encode_png};
use imaging::{Plane, Raster};
use spec::{Circle, Enhancement, Hscm, Mask};

/// Tolerance of the filtered logarithm: half a code at white.
const LOG_TOLERANCE: f64 = 2e-3;
/// Share of the pixels whose homomorphic code may differ by one: values near a rounding tie.
const HOMOMORPHIC_ODD_SHARE: f64 = 0.01;
/// The same after CLAHE, from the same median.
const CLAHE_ODD_SHARE: f64 = 0.005;
/// Mean difference of the complete chain in codes. One code before CLAHE can grow, on few pixels.
const CHAIN_MEAN_CODES: f64 = 0.5;
/// The same for a picture of one luma: its single code can be a tie (black is), and CLAHE moves all of it.
const FLAT_CHAIN_MEAN_CODES: f64 = 2.0;
const VARIANTS: [Variant; 2] = [Variant::Fast, Variant::Reference];

fn filter_of(luma: &Luma) -> Filter {
    Filter::new(&Hscm::default(), luma.codes().width())
}

fn paper() -> Circle {
    Circle::PAPER
}

fn gray(case: &Case, stage: &str) -> Plane<u8> {
    case.picture(stage).to_rgb8().to_gray8()
}

fn is_flat(plane: &Plane<u8>) -> bool {
    plane.data().iter().all(|code| *code == plane.data()[0])
}

/// Checks that codes differ by at most one, on at most `share` of them. On failure the expected picture, the difference
/// and the actual one are written next to each other.
fn assert_close(case: &Case, stage: &str, actual: &[u8], expected: &[u8], share: f64) {
    assert_eq!(actual.len(), expected.len(), "{}.{stage}", case.name);
    let differences: Vec<u8> = actual.iter().zip(expected).map(|(a, e)| a.abs_diff(*e)).collect();
    let odd = differences.iter().filter(|&&difference| difference > 0).count();
    let largest = differences.iter().max().copied().unwrap_or(0);
    let allowed = (share * expected.len() as f64) as usize;
    if largest > 1 || odd > allowed {
        let seen = written(case, stage, [expected, &differences, actual]);
        panic!(
            "{}.{stage}: {odd} codes differ ({allowed} may), by up to {largest}; see {seen}",
            case.name
        );
    }
}

fn written(case: &Case, stage: &str, panels: [&[u8]; 3]) -> String {
    let (width, height) = (gray(case, "input").width(), gray(case, "input").height());
    let channels = panels[0].len() / (width * height);
    let sheet = imaging::Rgb8::from_fn(3 * width, height, |x, y| {
        let code = |channel: usize| {
            panels[x / width][(y * width + x % width) * channels + channel.min(channels - 1)]
        };
        [code(0), code(1), code(2)]
    });
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{}.{stage}.png", case.name));
    let file = encode_png(&Raster::from(sheet)).expect("any picture can be a PNG file");
    fs::write(&path, file).expect("the test folder is writable");
    path.display().to_string()
}

#[test]
fn golden_filtered_logarithm() {
    for case in cases::all() {
        let FilePlane::Floats(expected) = decode_plane(&case.bytes("logfiltered.npy")).unwrap() else {
            panic!("{}: logfiltered.npy holds no floats", case.name);
        };
        let luma = Luma::new(&case.picture("input"));
        for variant in VARIANTS {
            let actual = homomorphic::filtered_log(&luma, &filter_of(&luma), variant);
            assert_eq!(actual.size(), expected.size(), "{}", case.name);
            let pairs = actual.data().iter().zip(expected.data());
            let largest = pairs.map(|(a, e)| f64::from((a - e).abs())).fold(0.0, f64::max);
            assert!(
                largest <= LOG_TOLERANCE,
                "{} {variant:?}: off by {largest}",
                case.name
            );
        }
    }
}

#[test]
fn golden_homomorphic_codes() {
    for case in cases::all() {
        let expected = gray(&case, "homomorphic");
        let luma = Luma::new(&case.picture("input"));
        for variant in VARIANTS {
            let actual = homomorphic::homomorphic(&luma, &filter_of(&luma), variant);
            // A picture of one luma has one code; at a tie either neighbor is correct.
            let share = if is_flat(&expected) && is_flat(&actual) {
                1.0
            } else {
                HOMOMORPHIC_ODD_SHARE
            };
            assert_close(&case, "homomorphic", actual.data(), expected.data(), share);
        }
    }
}

#[test]
fn golden_median() {
    for case in cases::all() {
        let (input, expected) = (gray(&case, "homomorphic"), gray(&case, "median"));
        for variant in VARIANTS {
            let actual = median::median(&input, 5, variant);
            assert_close(&case, "median", actual.data(), expected.data(), 0.0);
        }
    }
}

#[test]
fn golden_clahe() {
    for case in cases::all() {
        let actual = clahe::clahe(&gray(&case, "median"), [8, 8], 2.0);
        assert_close(
            &case,
            "clahe",
            actual.data(),
            gray(&case, "clahe").data(),
            CLAHE_ODD_SHARE,
        );
    }
}

#[test]
fn golden_merge() {
    for case in cases::all() {
        let actual = merge::merge(
            case.picture("input").to_rgb8().data(),
            gray(&case, "clahe").data(),
        );
        assert_close(
            &case,
            "color",
            &actual,
            case.picture("color").to_rgb8().data(),
            0.0,
        );
    }
}

#[test]
fn golden_mask_and_masked_pictures() {
    for case in cases::all() {
        let expected = gray(&case, "mask");
        let mask = circle_plane(expected.width(), expected.height(), &paper());
        assert_close(&case, "mask", mask.data(), expected.data(), 0.0);
        let mut masked = gray(&case, "clahe").into_data();
        black_out(
            &mut masked,
            1,
            &circle_plane(expected.width(), expected.height(), &paper()),
        );
        assert_close(
            &case,
            "masked_gray",
            &masked,
            gray(&case, "masked_gray").data(),
            0.0,
        );
        let mut masked = case.picture("color").to_rgb8().data().to_vec();
        black_out(
            &mut masked,
            3,
            &circle_plane(expected.width(), expected.height(), &paper()),
        );
        assert_close(
            &case,
            "masked_color",
            &masked,
            case.picture("masked_color").to_rgb8().data(),
            0.0,
        );
    }
}

#[test]
fn golden_padding_cutoff_and_mask_size() {
    for case in cases::all() {
        let (width, height) = gray(&case, "input").size();
        for (key, value) in case.members(&case.expected["hscm"]) {
            match key {
                "padded_width" => assert_eq!(homomorphic::padded_side(width) as u64, case.integer(value)),
                "padded_height" => assert_eq!(homomorphic::padded_side(height) as u64, case.integer(value)),
                "delta" => assert_eq!(Some(Filter::new(&Hscm::default(), width).delta), value.as_f64()),
                "mask_kept_pixels" => {
                    let mask = circle_plane(width, height, &paper());
                    let kept = mask.data().iter().filter(|&&code| code == 255).count();
                    assert_eq!(kept as u64, case.integer(value), "{}", case.name);
                }
                other => panic!("{}: unknown key hscm.{other}", case.name),
            }
        }
    }
}

#[test]
fn golden_whole_chain() {
    for case in cases::all() {
        let input = case.picture("input");
        let allowed = if is_flat(&gray(&case, "homomorphic")) {
            FLAT_CHAIN_MEAN_CODES
        } else {
            CHAIN_MEAN_CODES
        };
        let mean = |actual: &Raster, stage: &str| {
            let (actual, expected) = (actual.to_rgb8(), case.picture(stage).to_rgb8());
            assert_eq!(
                actual.data().len(),
                expected.data().len(),
                "{}.{stage}",
                case.name
            );
            let sum: u64 = actual
                .data()
                .iter()
                .zip(expected.data())
                .map(|(a, e)| u64::from(a.abs_diff(*e)))
                .sum();
            let mean = sum as f64 / actual.data().len() as f64;
            assert!(
                mean <= allowed,
                "{}.{stage}: off by {mean} codes in the mean",
                case.name
            );
        };
        let hscm = Enhancement {
            mask: Mask::Paper,
            ..Enhancement::of_method("hscm").unwrap()
        };
        let color = enhance(&hscm, &input, &[], &mut refuse_network).unwrap();
        mean(&color.unmasked, "color");
        mean(&color.picture, "masked_color");
        assert_eq!(color.mask, Some(gray(&case, "mask")), "{}", case.name);

        let exact = run_variant(&Method::parse("hscm").unwrap(), &input, Variant::Reference).unwrap();
        mean(&exact.picture, "color");
    }
}
