//! The arrays and numbers of one call.

use imaging::codec::encode_npy_plane;

use super::*;

#[test]
fn z_depth_in_meters_and_millimeters_is_that_of_a_file() {
    let (files, camera) = (Files::new(), Camera::new());
    let whole: Vec<u16> = camera
        .meters
        .iter()
        .map(|meters| (1000.0 * meters) as u16)
        .collect();
    let meters: Vec<f32> = whole
        .iter()
        .map(|&code| (f64::from(code) * 0.001) as f32)
        .collect();
    files.add(
        "z_depth.npy",
        encode_npy_plane(&Plane::new(WIDTH, HEIGHT, meters.clone()).unwrap()),
    );
    let scene = json!({"kind": "files", "rgb": files.path("rgb.png"), "z_depth": files.path("z_depth.npy")});
    let fields = json!({"water": {"optics": "jerlov-3C"}, "camera": {"hfov_deg": 65}});
    let mut described = fields.clone();
    described["scene"] = scene;
    let expected = pixels(&render(&files.job(&described)), "rgb");
    let mut stream = open(&fields);
    for samples in [DepthSamples::Meters(&meters), DepthSamples::Millimeters(&whole)] {
        let depth = StreamDepth {
            kind: RangeKind::ZDepth,
            size: SIZE,
            samples,
        };
        let input = StreamInput {
            depth: Some(depth),
            ..camera.input(0)
        };
        assert_eq!(rgb(&mut stream, &input), expected);
    }
}

#[test]
fn everything_wrong_with_an_input_is_reported_and_the_stream_continues() {
    let camera = Camera::new();
    let mut stream = open(&json!({"water": {"optics": "jerlov-3C"}, "camera": {"hfov_deg": 60}}));
    let expected = rgb(&mut stream, &camera.input(1));
    let good = camera.input(1);
    let mut wrong = good;
    wrong.picture.samples = PictureSamples::Srgb(&camera.codes[3..]);
    wrong.depth = wrong.depth.map(|depth| StreamDepth {
        size: (5, 4),
        ..depth
    });
    wrong.camera = Some([[40.0, 0.0, 96.0], [0.0, 40.0, 16.0], [0.0, 0.0, 1.0]]);
    wrong.pose = Some([[1.0; 4]; 4]);
    let messages: Vec<String> = refused(&mut stream, &wrong)
        .iter()
        .map(ToString::to_string)
        .collect();
    let begins = [
        "`rgb` holds 4605 samples; 48×32 pixels in `rgb` need 4608",
        "`range_m` is 5×4 but `rgb` is 48×32; register",
        "`camera` has cx 96, outside of the picture of 48×32",
        "`pose` is not a matrix from camera axes to the world: the last row",
    ];
    assert_eq!(messages.len(), begins.len(), "{messages:#?}");
    for (message, begin) in messages.iter().zip(begins) {
        assert!(message.starts_with(begin), "{message}");
    }
    let matrix = |fx: f64, fy: f64| Some([[fx, 0.0, 24.0], [0.0, fy, 16.0], [0.0, 0.0, 1.0]]);
    for (camera, part) in [
        (matrix(40.0, 50.0), "must agree within 1 %"),
        (matrix(-1.0, -1.0), "above 0"),
        (matrix(f64::NAN, 1.0), "finite"),
        (
            matrix(90.0, 90.0),
            "`camera.hfov_deg` of the job is 60, which is 41.6 px",
        ),
    ] {
        let found = refused(&mut stream, &StreamInput { camera, ..good });
        assert!(found[0].message.contains(part), "{}", found[0]);
    }
    let mut light: Vec<f32> = vec![0.5; camera.codes.len()];
    light[3 * WIDTH + 7] = f32::INFINITY;
    let mut infinite = good;
    infinite.picture.samples = PictureSamples::Linear(&light);
    assert_eq!(
        refused(&mut stream, &infinite)[0].to_string(),
        "`rgb` is inf at pixel (2, 1); must be finite"
    );
    assert!(rgb(&mut stream, &good) == expected);
    assert!(
        rgb(
            &mut stream,
            &StreamInput {
                camera: matrix(41.6, 41.6),
                ..good
            }
        ) != camera.codes
    );
}
