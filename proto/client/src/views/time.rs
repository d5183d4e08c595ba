//! Times: stored as milliseconds, shown as RFC 3339.

use std::fmt;

use chrono::{DateTime, SecondsFormat, Utc};
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Milliseconds since 1970 in UTC. Serialized and displayed as RFC 3339 with milliseconds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct UnixMs(pub u64);

impl fmt::Display for UnixMs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let time = i64::try_from(self.0)
            .ok()
            .and_then(DateTime::<Utc>::from_timestamp_millis);
        // Times beyond the calendar come only from a broken clock.
        let time = time.unwrap_or(DateTime::<Utc>::MAX_UTC);
        f.write_str(&time.to_rfc3339_opts(SecondsFormat::Millis, true))
    }
}

impl Serialize for UnixMs {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for UnixMs {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let time = DateTime::parse_from_rfc3339(&text).map_err(D::Error::custom)?;
        let since = u64::try_from(time.timestamp_millis());
        since
            .map(Self)
            .map_err(|_| D::Error::custom(format!("{text} is before 1970")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_utc_with_milliseconds_whatever_the_clock_says() {
        assert_eq!(UnixMs(1_700_000_000_123).to_string(), "2023-11-14T22:13:20.123Z");
        assert!(UnixMs(u64::MAX).to_string().ends_with('Z'));
    }

    #[test]
    fn a_time_is_read_as_it_was_written() {
        let read = |text: &str| serde_json::from_str::<UnixMs>(text);
        let written = serde_json::to_string(&UnixMs(1_700_000_000_123)).unwrap();
        assert_eq!(read(&written).unwrap(), UnixMs(1_700_000_000_123));
        let message = read("\"1969-12-31T23:59:59Z\"").unwrap_err().to_string();
        assert!(message.contains("before 1970"), "{message}");
    }
}
