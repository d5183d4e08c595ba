//! Invalid scenes are rejected with the field; holes are valid.

use crate::common::bytes::{png, png_head, range_npy, range_png};
use crate::common::start;
use crate::rejections::bad_input::nothing_changes;

/// Name of the case, form fields, pointer of the error, parts of its message.
type Refused<'a> = (&'a str, Vec<(&'a str, &'a [u8])>, &'a str, &'a [&'a str]);

#[test]
fn a_bad_upload_is_refused_with_the_field() {
    let whole = png(16, 12);
    let range = range_npy(16, 12, |x, _| 1.0 + x as f32);
    let refused: Vec<Refused> = vec![
        (
            "range of another size",
            vec![("rgb", &whole), ("range", &RANGE_8X8)],
            "/range",
            &["8×8", "16×12"],
        ),
        (
            "truncated PNG",
            vec![("rgb", &whole[..whole.len() / 2])],
            "/rgb",
            &["damaged or cut off"],
        ),
        (
            "no picture",
            vec![("rgb", b"hello")],
            "/rgb",
            &["neither PNG nor JPEG"],
        ),
        ("bomb", vec![("rgb", &BOMB)], "/rgb", &["60000", "16384"]),
        (
            "bomb as range",
            vec![
                ("rgb", &whole),
                ("range", &BOMB),
                ("unit_m", b"1"),
                ("invalid_code", b"0"),
            ],
            "/range",
            &["60000", "16384"],
        ),
        ("nothing", vec![], "/rgb", &["missing"]),
        (
            "both ranges",
            vec![("rgb", &whole), ("range", &range), ("z_depth", &range)],
            "/z_depth",
            &["exclude each other"],
        ),
        (
            "unknown field",
            vec![("rgb", &whole), ("deph", &range)],
            "/deph",
            &["z_depth"],
        ),
        (
            "unit of text",
            vec![("rgb", &whole), ("range", &range), ("unit_m", b"NaN")],
            "/unit_m",
            &["NaN", "above 0"],
        ),
        (
            "negative focal length",
            vec![("rgb", &whole), ("fx", b"-1")],
            "/fx",
            &["-1", "above 0"],
        ),
        (
            "codes without a unit",
            vec![("rgb", &whole), ("range", &RANGE_CODES)],
            "",
            &["unit_m"],
        ),
    ];
    nothing_changes(|service| {
        for (name, fields, pointer, fragments) in refused {
            let problem = service.upload(&fields).problem(422, "validation");
            let error = problem["errors"][0].to_string();
            assert!(
                error.contains(&format!(r#""pointer":"{pointer}"#)),
                "{name}: {problem}"
            );
            for fragment in fragments {
                assert!(error.contains(fragment), "{name}: {fragment} is not in {error}");
            }
        }
        service
            .post_with("/v1/scenes", &[("content-type", "multipart/form-data")], b"x")
            .problem(400, "invalid-body");
        service
            .post_with("/v1/scenes", &[("content-type", "image/png")], &whole)
            .problem(415, "unsupported-media-type");
    });
}

static RANGE_8X8: std::sync::LazyLock<Vec<u8>> = std::sync::LazyLock::new(|| range_npy(8, 8, |_, _| 1.0));
static RANGE_CODES: std::sync::LazyLock<Vec<u8>> = std::sync::LazyLock::new(|| range_png(16, 12));
static BOMB: std::sync::LazyLock<Vec<u8>> = std::sync::LazyLock::new(|| png_head(60_000, 60_000));

#[test]
fn a_range_of_only_holes_is_valid() {
    let service = start();
    let picture = png(16, 12);
    let some = range_npy(16, 12, |x, _| if x < 8 { f32::NAN } else { 2.0 });
    let all = range_npy(16, 12, |_, _| f32::NAN);
    for range in [some, all] {
        let answer = service.upload(&[("rgb", &picture), ("range", &range)]);
        assert_eq!(answer.status, 201, "{}", answer.text());
    }
}
