//! Metrics of frames along a camera path, through the registry.

use imaging::{Plane, Rgb8};
use quality::{
    CameraMotion, FrameFeatures, MetricId, Motion, Needs, PreviousFrame, QualityError, Sequence, Subject,
    TRACK_FRAMES, measure, measure_subject,
};

use crate::room::{Camera, HEIGHT, PIXEL_RAD, WIDTH, ray};

const SEQUENCE: [&str; 8] = [
    "matches",
    "matches_default",
    "matches_correct",
    "matches_correct_default",
    "matches_precision",
    "track_length",
    "pose_error_deg",
    "pose_error_m",
];

fn parse(names: &[&str]) -> Vec<MetricId> {
    names.iter().map(|name| MetricId::parse(name).unwrap()).collect()
}

/// The last frames of a path, the newest first, rendered as given.
struct Path {
    pictures: Vec<Rgb8>,
    features: Vec<FrameFeatures>,
    motions: Vec<Motion>,
}

impl Path {
    fn new(frames: usize, render: impl Fn(&Camera) -> Rgb8) -> Self {
        let cameras: Vec<Camera> = (0..frames).rev().map(Camera::on_path).collect();
        let pictures: Vec<Rgb8> = cameras.iter().map(render).collect();
        Self {
            features: pictures
                .iter()
                .map(|picture| FrameFeatures::find(picture, None))
                .collect(),
            pictures,
            motions: cameras
                .windows(2)
                .map(|pair| pair[0].motion_from(&pair[1]))
                .collect(),
        }
    }

    fn measure(&self, names: &[&str]) -> Vec<(String, f64)> {
        let frames = self.features[1..].iter().zip(&self.motions);
        let previous: Vec<PreviousFrame> = frames
            .map(|(features, motion)| PreviousFrame { features, motion })
            .collect();
        let newest = self.features.len() - 1;
        let camera = (newest > 0).then(|| CameraMotion {
            current: &ray,
            previous: &ray,
            pose: Camera::on_path(newest).pose_from(&Camera::on_path(newest - 1)),
            pixel_rad: PIXEL_RAD,
            seed: 1,
        });
        let sequence = Sequence {
            features: &self.features[0],
            previous: &previous,
            camera,
        };
        let subject = Subject {
            sequence: Some(&sequence),
            ..Subject::new(&self.pictures[0])
        };
        let values = measure_subject(&subject, &parse(names)).unwrap();
        values
            .into_iter()
            .map(|(id, value)| (id.to_string(), value))
            .collect()
    }
}

#[test]
fn a_clear_path_is_matched_followed_and_its_pose_found() {
    let path = Path::new(4, |camera| camera.render(240.0, 120.0, 4.0));
    let values = path.measure(&SEQUENCE);
    let names: Vec<&str> = values.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, SEQUENCE);
    let [
        matches,
        matches_default,
        correct,
        correct_default,
        precision,
        track,
        deg,
        m,
    ] = std::array::from_fn(|i| values[i].1);
    assert!(matches > 600.0 && matches_default > 600.0, "{values:?}");
    assert!(
        (0.9..1.0).contains(&precision) && precision == correct / matches,
        "{values:?}"
    );
    assert!(correct_default > 600.0);
    // Three frames are before this one, and most features are found in each.
    assert!(
        (1.0..3.0).contains(&track) && track > correct / 1000.0,
        "{values:?}"
    );
    // The translation is 0.09 m.
    assert!(deg < 1.0 && m < 0.07, "{values:?}");
}

#[test]
fn a_static_camera_is_followed_over_all_frames() {
    let still = Camera::on_path(0).render(240.0, 120.0, 0.0);
    let path = Path::new(TRACK_FRAMES + 3, |_| still.clone());
    let stays = Motion {
        positions: Plane::from_fn(still.width(), still.height(), |x, y| {
            [x as f32 + 0.5, y as f32 + 0.5]
        }),
    };
    let path = Path {
        motions: vec![stays; TRACK_FRAMES + 2],
        ..path
    };
    let values = path.measure(&["matches_precision", "track_length"]);
    // Features of equal descriptors have one match.
    assert!(
        values[0].1 > 0.99 && values[1].1 > 0.98 * TRACK_FRAMES as f64,
        "{values:?}"
    );
    assert!(values[1].1 <= TRACK_FRAMES as f64);
}

#[test]
fn frames_without_texture_have_no_matches_and_the_largest_errors() {
    let values = Path::new(3, |_| Rgb8::from_fn(WIDTH, HEIGHT, |_, _| [90; 3])).measure(&SEQUENCE);
    let length = Camera::on_path(2)
        .pose_from(&Camera::on_path(1))
        .translation
        .length();
    let expected = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 180.0, 2.0 * length];
    assert_eq!(
        values.iter().map(|(_, value)| *value).collect::<Vec<_>>(),
        expected
    );
}

#[test]
fn the_first_frame_of_a_path_has_features_alone() {
    let path = Path::new(1, |camera| camera.render(240.0, 120.0, 0.0));
    let values = path.measure(&[&SEQUENCE[..], &["features", "entropy"]].concat());
    let names: Vec<&str> = values.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["features", "entropy"]);
    assert_eq!(values[0].1, 1000.0);
}

#[test]
fn features_are_those_of_the_sequence() {
    let path = Path::new(2, |camera| camera.render(60.0, 120.0, 4.0));
    let alone = measure(&path.pictures[0], None, &parse(&["features", "features_default"])).unwrap();
    let values = path.measure(&["features", "features_default"]);
    assert_eq!(
        values.iter().map(|(_, value)| *value).collect::<Vec<_>>(),
        alone.iter().map(|(_, value)| *value).collect::<Vec<_>>()
    );
    assert_eq!((values[0].1, values[1].1), (1000.0, 0.0));
}

#[test]
fn a_missing_input_is_an_error_that_names_it() {
    let picture = Camera::on_path(0).render(60.0, 120.0, 0.0);
    let message = |name: &str| {
        let error: QualityError = measure(&picture, None, &parse(&[name])).unwrap_err();
        error.to_string()
    };
    assert_eq!(
        message("matches"),
        "matches needs the previous frame of a camera path, which is missing"
    );
    assert_eq!(
        message("illumination_residual"),
        "illumination_residual needs the true illumination, which is missing"
    );
    let info = parse(&["track_length"])[0].info();
    assert_eq!(info.needs, Needs::PreviousFrames(TRACK_FRAMES));
}
