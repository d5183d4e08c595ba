//! The options of the published robot node, and the fields of a job that replace them.

/// An option of the node.
pub(super) struct NodeOption {
    pub(super) name: &'static str,
    pub(super) meaning: &'static str,
    /// Paths as in the table of fields; empty without a counterpart.
    pub(super) fields: &'static [&'static str],
    pub(super) translation: &'static str,
}

const fn option(
    name: &'static str,
    meaning: &'static str,
    fields: &'static [&'static str],
    translation: &'static str,
) -> NodeOption {
    NodeOption {
        name,
        meaning,
        fields,
        translation,
    }
}

/// Every option of the node.
pub(super) const OPTIONS: [NodeOption; 11] = [
    option(
        "topic",
        "camera pictures",
        &["scene(files).rgb"],
        "a file for each frame",
    ),
    option(
        "depth-topic",
        "depth pictures; none skips attenuation and blur",
        &[
            "scene(files).z_depth",
            "scene(files).unit_m",
            "scene(files).invalid_code",
        ],
        "depth along the optical axis, its unit and its code for a missing return, 0 in the node; without it leave out `water.optics`",
    ),
    option(
        "scale",
        "divisor of the picture's sides, 2",
        &["camera.width", "camera.height"],
        "for procedural scenes; pictures from files keep their size",
    ),
    option(
        "model",
        "style network",
        &["water.style"],
        "a shipped style, or one added with `fathom styles add`",
    ),
    option(
        "cuda",
        "run the network on a GPU",
        &[],
        "none: networks run on the CPU",
    ),
    option(
        "attenuation",
        "blur per meter, 0.1",
        &[
            "water.optics.beam_attenuation_per_m",
            "water.optics.forward_scatter.spread_px_per_m",
            "water.range_scale",
        ],
        "the node blurs and never darkens: `spread_px_per_m` is its blur, the others are Eq. 7 of the paper",
    ),
    option(
        "winsize",
        "window of the Gaussian blur, 17 px",
        &["water.optics.forward_scatter.model"],
        "`simplified`: the kernel of Eq. 9 at each pixel, without a window",
    ),
    option(
        "alpha",
        "share of the picture before the style, 0",
        &["alpha"],
        "1 − alpha: the share of the styled picture",
    ),
    option(
        "nlights",
        "number of lights, 2",
        &["lights"],
        "one entry `{\"kind\": \"haze\", …}` for each light",
    ),
    option(
        "light-pose",
        "two letters for each light, BRBL",
        &["lights[](haze).x", "lights[](haze).y", "lights[](haze).size"],
        "x is 0 for L and 1 for R, y is 0 for T and 1 for B; size 0.2",
    ),
    option(
        "input-bag, output-bag",
        "recordings to repaint",
        &[],
        "`fathom bag IN OUT` reads a ROS 1 or ROS 2 recording and writes it with the pictures in water",
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_option_leads_to_known_fields() {
        let rows = spec::table::rows();
        for field in OPTIONS.iter().flat_map(|option| option.fields) {
            assert!(
                rows.iter().any(|row| is_same(&row.path, field)),
                "no field `{field}`"
            );
        }
        assert!(!rows.iter().any(|row| is_same(&row.path, "scene(procedural).rgb")));
    }

    /// Whether a path of the table, which lists kinds in parentheses, is that of a field of one kind.
    fn is_same(path: &str, field: &str) -> bool {
        let (Some((start, kinds, end)), Some((known_start, kind, known_end))) = (split(path), split(field))
        else {
            return path == field;
        };
        (start, end) == (known_start, known_end) && kinds.split(", ").any(|known| known == kind)
    }

    /// The path before, within and after its parentheses.
    fn split(path: &str) -> Option<(&str, &str, &str)> {
        let (start, rest) = path.split_once('(')?;
        let (kinds, end) = rest.split_once(')')?;
        Some((start, kinds, end))
    }
}
