//! Roles of models, and how enhancers and metrics take a picture.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Largest side of a size rule.
const MAX_SIDE: usize = 16_384;

/// The use of a model in a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ModelRole {
    /// Repaints the light of a frame: `water.style`.
    #[default]
    Style,
    /// Enhances the picture of a frame: the method `onnx` of `enhance`.
    Enhancer,
    /// Measures a picture: `net.NAME` in `metrics`.
    Metric,
}

/// The values of black and white in the input of an enhancer or a metric, and in the output of an enhancer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
pub enum InputScale {
    /// Black is 0, white is 1.
    #[default]
    #[serde(rename = "0..1")]
    Unit,
    /// Black is 0, white is 255.
    #[serde(rename = "0..255")]
    Codes,
    /// Black is -1, white is 1.
    #[serde(rename = "-1..1")]
    Signed,
}

/// The order of the axes in the input of an enhancer or a metric, and in the output of an enhancer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
pub enum Layout {
    /// `[1, 3, height, width]`.
    #[default]
    #[serde(rename = "NCHW")]
    ChannelsFirst,
    /// `[1, height, width, 3]`.
    #[serde(rename = "NHWC")]
    ChannelsLast,
}

/// The sizes of pictures that an enhancer or a metric takes: `any`, `multiple of N` or `fixed WxH`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum SizeRule {
    /// Every size.
    #[default]
    Any,
    /// Both sides are multiples of this number. Pictures of other sizes are reflected beyond their right and lower edges, and
    /// results are cropped.
    MultipleOf(usize),
    /// Only this size.
    Fixed {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
}

/// How an enhancer or a metric takes a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PictureInput {
    /// The values of black and white.
    pub scale: InputScale,
    /// The order of the axes.
    pub layout: Layout,
    /// The sizes.
    pub size: SizeRule,
}

impl ModelRole {
    /// Every role.
    pub const ALL: [Self; 3] = [Self::Style, Self::Enhancer, Self::Metric];

    /// The word in cards and forms.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Style => "style",
            Self::Enhancer => "enhancer",
            Self::Metric => "metric",
        }
    }
}

impl InputScale {
    /// Every scale.
    pub const ALL: [Self; 3] = [Self::Unit, Self::Codes, Self::Signed];

    /// The word in cards and forms.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Unit => "0..1",
            Self::Codes => "0..255",
            Self::Signed => "-1..1",
        }
    }

    /// The network's value of an 8-bit code.
    pub(crate) fn value(self, code: u8) -> f32 {
        let code = f32::from(code);
        match self {
            Self::Unit => code / 255.0,
            Self::Codes => code,
            Self::Signed => code / 127.5 - 1.0,
        }
    }

    /// The value in 0 to 1 of a network's value; not clamped.
    pub(crate) fn to_unit(self, value: f32) -> f32 {
        match self {
            Self::Unit => value,
            Self::Codes => value / 255.0,
            Self::Signed => f32::midpoint(value, 1.0),
        }
    }
}

impl Layout {
    /// Every layout.
    pub const ALL: [Self; 2] = [Self::ChannelsFirst, Self::ChannelsLast];

    /// The word in cards and forms.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::ChannelsFirst => "NCHW",
            Self::ChannelsLast => "NHWC",
        }
    }

    /// The shape of a picture.
    pub(crate) fn shape(self, width: usize, height: usize) -> [usize; 4] {
        match self {
            Self::ChannelsFirst => [1, 3, height, width],
            Self::ChannelsLast => [1, height, width, 3],
        }
    }

    /// The axis of the channels.
    pub(crate) fn channel_axis(self) -> usize {
        match self {
            Self::ChannelsFirst => 1,
            Self::ChannelsLast => 3,
        }
    }
}

impl SizeRule {
    /// The size that the network gets for a picture, or why it takes none of this size.
    ///
    /// # Errors
    /// The limit and the remedy, for a rule of one size.
    pub fn padded(self, width: usize, height: usize) -> Result<(usize, usize), String> {
        match self {
            Self::Any => Ok((width, height)),
            Self::MultipleOf(number) => Ok((width.next_multiple_of(number), height.next_multiple_of(number))),
            Self::Fixed {
                width: columns,
                height: rows,
            } if (columns, rows) == (width, height) => Ok((width, height)),
            Self::Fixed {
                width: columns,
                height: rows,
            } => Err(format!(
                "takes pictures of {columns}×{rows} only, but the picture is {width}×{height}; give it that size, or export the \
                 network for any size"
            )),
        }
    }

    /// The only size, if there is one.
    #[must_use]
    pub fn fixed(self) -> Option<[usize; 2]> {
        match self {
            Self::Fixed { width, height } => Some([width, height]),
            Self::Any | Self::MultipleOf(_) => None,
        }
    }
}

impl fmt::Display for SizeRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Any => f.write_str("any"),
            Self::MultipleOf(number) => write!(f, "multiple of {number}"),
            Self::Fixed { width, height } => write!(f, "fixed {width}x{height}"),
        }
    }
}

impl FromStr for SizeRule {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!(
                "`{text}` is not a size rule; must be `any`, `multiple of N` with N from 1 to {MAX_SIDE}, or `fixed WxH` with sides from \
                 1 to {MAX_SIDE}"
            )
        };
        if text == "any" {
            return Ok(Self::Any);
        }
        if let Some(number) = text.strip_prefix("multiple of ") {
            return parse_side(number).map(Self::MultipleOf).ok_or_else(wrong);
        }
        let sides = text
            .strip_prefix("fixed ")
            .and_then(|sides| sides.split_once('x'));
        let sides = sides.and_then(|(width, height)| Some((parse_side(width)?, parse_side(height)?)));
        let (width, height) = sides.ok_or_else(wrong)?;
        Ok(Self::Fixed { width, height })
    }
}

fn parse_side(text: &str) -> Option<usize> {
    let is_plain = text.bytes().all(|byte: u8| byte.is_ascii_digit());
    let side = text.parse().ok().filter(|_| is_plain)?;
    (1..=MAX_SIDE).contains(&side).then_some(side)
}

impl TryFrom<String> for SizeRule {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<SizeRule> for String {
    fn from(rule: SizeRule) -> Self {
        rule.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_rule_is_read_as_it_is_written() {
        for text in ["any", "multiple of 32", "fixed 256x128"] {
            assert_eq!(text.parse::<SizeRule>().unwrap().to_string(), text);
        }
        for text in [
            "",
            "Any",
            "multiple of 0",
            "multiple of +8",
            "multiple of 32.5",
            "fixed 256",
            "fixed 0x4",
            "fixed 99999x4",
        ] {
            let error = text.parse::<SizeRule>().unwrap_err();
            assert!(error.contains("must be `any`"), "{error}");
        }
    }

    #[test]
    fn a_rule_of_one_size_refuses_others_with_the_remedy() {
        let fixed: SizeRule = "fixed 256x128".parse().unwrap();
        assert_eq!(fixed.padded(256, 128), Ok((256, 128)));
        let error = fixed.padded(128, 256).unwrap_err();
        assert!(
            error.contains("256×128 only") && error.contains("128×256"),
            "{error}"
        );
        assert_eq!(SizeRule::MultipleOf(32).padded(33, 32), Ok((64, 32)));
    }

    #[test]
    fn a_scale_returns_what_it_was_given() {
        for scale in InputScale::ALL {
            for code in 0..=255 {
                let unit = scale.to_unit(scale.value(code));
                assert!(
                    (unit * 255.0 - f32::from(code)).abs() < 1e-3,
                    "{} {code}",
                    scale.name()
                );
            }
        }
        assert_eq!([0, 255].map(|code| InputScale::Signed.value(code)), [-1.0, 1.0]);
    }
}
