//! The state of a job.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// State of a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum JobState {
    /// No frame has ended yet.
    Queued,
    /// Some frames have ended.
    Running,
    /// No frame is offered to workers.
    Paused,
    /// Stopped by the user; its images stay.
    Cancelled,
    /// Every frame has its image.
    Done,
    /// Every frame has ended, some without an image.
    DoneWithFailures,
}

impl JobState {
    /// Every state with its name.
    pub const ALL: [(Self, &'static str); 6] = [
        (Self::Queued, "queued"),
        (Self::Running, "running"),
        (Self::Paused, "paused"),
        (Self::Cancelled, "cancelled"),
        (Self::Done, "done"),
        (Self::DoneWithFailures, "done_with_failures"),
    ];

    /// Its meaning.
    #[must_use]
    pub fn about(self) -> &'static str {
        match self {
            Self::Queued => "no frame has ended yet",
            Self::Running => "some frames have ended",
            Self::Paused => "workers get none of its frames until it is resumed",
            Self::Cancelled => "stopped by the user; what is there stays",
            Self::Done => "every frame has its image",
            Self::DoneWithFailures => "every frame has ended, some without an image",
        }
    }

    /// Whether the state is final.
    #[must_use]
    pub fn has_ended(self) -> bool {
        matches!(self, Self::Cancelled | Self::Done | Self::DoneWithFailures)
    }
}

impl fmt::Display for JobState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = Self::ALL.iter().find(|(state, _)| state == self);
        f.write_str(named.map_or("", |(_, name)| name))
    }
}

impl FromStr for JobState {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let known = Self::ALL.iter().find(|(_, known)| *known == name);
        known.map(|(state, _)| *state).ok_or_else(|| {
            let names = Self::ALL.map(|(_, name)| name).join(", ");
            format!("`{name}` is not a state; states are {names}")
        })
    }
}
