//! Folders and names of the files of a frame.

use crate::commands::dataset::export::format::Format;
use crate::commands::dataset::export::role::Role;

/// The place of a frame in the sequences of a part.
#[derive(Debug, Clone)]
pub(crate) struct SequencePlace {
    /// The name of the sequence, `JOB-NUMBER`.
    pub(crate) sequence: String,
    /// Number of the sequence in the part, from 0.
    pub(crate) number: usize,
    /// Exported frames before it in the sequence.
    pub(crate) position: usize,
    pub(crate) stamp_ns: u64,
}

/// Seconds with nine decimals, without rounding.
pub(crate) fn format_seconds(stamp_ns: u64) -> String {
    format!("{}.{:09}", stamp_ns / 1_000_000_000, stamp_ns % 1_000_000_000)
}

/// A number with a decimal point and without exponent, which every reader of YAML takes for a real number.
pub(crate) fn format_real(number: f64) -> String {
    let text = number.to_string();
    if text.contains('.') { text } else { text + ".0" }
}

/// The folder of a sequence below the part.
pub(crate) fn sequence_folder(format: Format, sequence: &str, number: usize) -> Vec<String> {
    match format {
        Format::Kitti => vec!["sequences".to_owned(), format!("{number:02}")],
        _ => vec![sequence.to_owned()],
    }
}

/// The name of a frame's files without extension.
pub(crate) fn stem(format: Format, place: &SequencePlace) -> String {
    match format {
        Format::Kitti => format!("{:06}", place.position),
        Format::Euroc => place.stamp_ns.to_string(),
        _ => format_seconds(place.stamp_ns),
    }
}

/// The folder of the files of a kind below that of the sequence. `is_first`: whether they are the pictures of the sequence.
pub(crate) fn kind_folder(format: Format, kind: &str, is_first: bool) -> Vec<String> {
    let role = Role::of_checked(kind);
    match format {
        Format::Kitti => vec![match role {
            Role::Picture if is_first => "image_2".to_owned(),
            Role::RightPicture => "image_3".to_owned(),
            Role::Depth => "depth_2".to_owned(),
            _ => format!("{kind}_2"),
        }],
        Format::Euroc => {
            let sensor = match role {
                Role::Picture if is_first => "cam0".to_owned(),
                Role::RightPicture => "cam1".to_owned(),
                Role::Depth => "depth0".to_owned(),
                _ => format!("{kind}0"),
            };
            vec!["mav0".to_owned(), sensor, "data".to_owned()]
        }
        _ => vec![match role {
            Role::Picture if is_first => "rgb".to_owned(),
            Role::Depth => "depth".to_owned(),
            _ => kind.to_owned(),
        }],
    }
}

/// Codes of a depth picture for each meter.
pub(crate) fn depth_codes_per_m(format: Format) -> f64 {
    match format {
        Format::Kitti => 256.0,
        Format::Euroc => 1000.0,
        _ => 5000.0,
    }
}

/// Whether readers of the format expect pictures to be PNG.
pub(crate) fn needs_png(format: Format) -> bool {
    matches!(format, Format::Euroc | Format::Kitti)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_numbers_are_written_in_full() {
        assert_eq!(format_seconds(1_403_636_579_763_555_584), "1403636579.763555584");
        assert_eq!(format_seconds(40_000_000), "0.040000000");
        assert_eq!([50.0, 1e-7, -0.5].map(format_real), ["50.0", "0.0000001", "-0.5"]);
    }

    #[test]
    fn each_kind_has_its_folder_in_each_format() {
        for (format, kind, is_first, folder) in [
            (Format::Tum, "clean", true, "rgb"),
            (Format::Tum, "range", false, "depth"),
            (Format::Euroc, "rgb_right", false, "mav0/cam1/data"),
            (Format::Euroc, "instances", false, "mav0/instances0/data"),
            (Format::Kitti, "rgb_right", false, "image_3"),
            (Format::Kitti, "clean", false, "clean_2"),
        ] {
            assert_eq!(kind_folder(format, kind, is_first).join("/"), folder);
        }
    }
}
