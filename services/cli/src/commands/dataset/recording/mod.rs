//! Recordings of robots, which the Python package reads.

mod python;

use std::ffi::{OsStr, OsString};
use std::path::Path;

pub(crate) use python::run_module;

/// Ends of the names of recordings.
const ENDS: [&str; 4] = [".bag", ".bag.active", ".mcap", ".db3"];

/// Options that select the frames of a recording. Python checks their values.
#[derive(clap::Args)]
pub(crate) struct CameraArguments {
    /// Depths along the optical axis: Image of 32FC1 meters or 16UC1 millimeters
    #[arg(long, value_name = "TOPIC")]
    depth: Option<String>,
    /// Camera of the pictures
    #[arg(long, value_name = "TOPIC")]
    camera_info: Option<String>,
    /// Longest time between a picture and its depth [default: 0.02]
    #[arg(long, value_name = "SECONDS")]
    slop_s: Option<f64>,
    /// Times of the frames: `header`, or `recorded` if headers have none [default: header]
    #[arg(long, value_name = "KIND")]
    stamps: Option<String>,
    /// Poses from /tf: the fixed frame, such as map, whose z axis points up
    #[arg(long, value_name = "FRAME")]
    world: Option<String>,
    /// Poses from a topic of PoseStamped, PoseWithCovarianceStamped or Odometry; needs --pose-axes
    #[arg(long, value_name = "TOPIC")]
    pose_topic: Option<String>,
    /// Axes of --pose-topic: `optical` (right, down, ahead) or `body` (ahead, left, up)
    #[arg(long, value_name = "AXES")]
    pose_axes: Option<String>,
}

impl CameraArguments {
    /// Those that are given, with their names.
    pub(crate) fn list_given(&self) -> Vec<(&'static str, OsString)> {
        let slop_s = self.slop_s.map(|seconds| seconds.to_string());
        let options = [
            ("--depth", &self.depth),
            ("--camera-info", &self.camera_info),
            ("--slop-s", &slop_s),
            ("--stamps", &self.stamps),
            ("--world", &self.world),
            ("--pose-topic", &self.pose_topic),
            ("--pose-axes", &self.pose_axes),
        ];
        let given = options
            .into_iter()
            .filter_map(|(name, value)| Some((name, value.as_ref()?.into())));
        given.collect()
    }
}

/// An option with its value in one argument, so that no value passes for an option.
pub(crate) fn join_option(name: &str, value: &OsStr) -> OsString {
    let mut joined = OsString::from(name);
    joined.push("=");
    joined.push(value);
    joined
}

/// Whether a path names a recording: a file of messages, or a folder with such files.
pub(crate) fn is_recording(path: &Path) -> bool {
    if !path.is_dir() {
        return has_end(path);
    }
    std::fs::read_dir(path).is_ok_and(|entries| {
        let mut entries = entries.flatten();
        entries.any(|entry| has_end(&entry.path()))
    })
}

fn has_end(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = name.strip_suffix(".zstd").unwrap_or(&name);
    ENDS.iter().any(|end| name.ends_with(end))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_and_folders_of_messages_are_recordings() {
        let folder = tempfile::tempdir().unwrap();
        assert!(!is_recording(folder.path()));
        std::fs::write(folder.path().join("dive_0.db3.zstd"), "").unwrap();
        assert!(is_recording(folder.path()));
        for (name, expected) in [("dive.bag", true), ("dive.mcap", true), ("dive.png", false)] {
            assert_eq!(is_recording(Path::new(name)), expected, "{name}");
        }
    }

    #[test]
    fn a_value_that_looks_like_an_option_stays_a_value() {
        assert_eq!(join_option("--depth", OsStr::new("--help")), "--depth=--help");
    }
}
