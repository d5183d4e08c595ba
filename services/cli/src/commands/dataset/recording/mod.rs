//! Recordings of robots, which the Python package reads.

mod python;

use std::ffi::OsString;
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
    /// Use P of the camera info, not K: the pictures are rectified
    #[arg(long)]
    rectified: bool,
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
    /// Those that are given.
    pub(crate) fn list_given(&self) -> Vec<Given> {
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
            .filter_map(|(name, value)| Some(Given::new(name, value.as_ref()?)));
        given
            .chain(self.rectified.then(|| Given::flag("--rectified")))
            .collect()
    }
}

/// An option of a command line that is given.
pub(crate) struct Given {
    pub(crate) name: &'static str,
    value: Option<OsString>,
}

impl Given {
    pub(crate) fn new(name: &'static str, value: impl Into<OsString>) -> Self {
        let value = Some(value.into());
        Self { name, value }
    }

    /// An option without a value.
    pub(crate) fn flag(name: &'static str) -> Self {
        Self { name, value: None }
    }

    /// Both in one argument, so that no value passes for an option.
    pub(crate) fn join(&self) -> OsString {
        let mut joined = OsString::from(self.name);
        if let Some(value) = &self.value {
            joined.push("=");
            joined.push(value);
        }
        joined
    }
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
        assert_eq!(Given::new("--depth", "--help").join(), "--depth=--help");
        assert_eq!(Given::flag("--rectified").join(), "--rectified");
    }
}
