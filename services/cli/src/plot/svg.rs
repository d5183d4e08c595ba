//! SVG text of simple shapes.

/// The color of text and axes.
pub(super) const INK: &str = "#1e2226";
/// The color of grid lines.
pub(super) const FAINT: &str = "#d6dade";
/// Colors that are distinguishable with color vision deficiency (Okabe and Ito 2008).
const PALETTE: [&str; 8] = [
    "#0072b2", "#e69f00", "#009e73", "#cc79a7", "#d55e00", "#56b4e9", "#787828", "#3c3c3c",
];

/// The color of a series or bar.
pub(super) fn color(index: usize) -> &'static str {
    PALETTE[index % PALETTE.len()]
}

/// A white sheet.
pub(super) struct Svg(String);

impl Svg {
    pub(super) fn new(width: f64, height: f64, title: &str) -> Self {
        let mut svg = Self(format!(
            "<svg width=\"{width:.0}\" height=\"{height:.0}\" xmlns=\"http://www.w3.org/2000/svg\" font-family=\"monospace\" \
             font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
        ));
        svg.text((12.0, 24.0), title, "start");
        svg
    }

    pub(super) fn line(&mut self, points: &[(f64, f64)], color: &str, width: f64) {
        let points: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let (points, style) = (
            points.join(" "),
            format!("stroke=\"{color}\" stroke-width=\"{width}\""),
        );
        self.0 += &format!("<polyline points=\"{points}\" fill=\"none\" {style}/>\n");
    }

    pub(super) fn rectangle(&mut self, (x, y): (f64, f64), (width, height): (f64, f64), style: &str) {
        let sides = format!("width=\"{width:.1}\" height=\"{height:.1}\"");
        self.0 += &format!("<rect x=\"{x:.1}\" y=\"{y:.1}\" {sides} {style}/>\n");
    }

    pub(super) fn circle(&mut self, (x, y): (f64, f64), radius: f64, style: &str) {
        self.0 += &format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" {style}/>\n");
    }

    /// Text on a base line; `anchor` is start, middle or end.
    pub(super) fn text(&mut self, position: (f64, f64), text: &str, anchor: &str) {
        self.styled_text(position, text, anchor, &format!("fill=\"{INK}\""));
    }

    pub(super) fn styled_text(&mut self, (x, y): (f64, f64), text: &str, anchor: &str, style: &str) {
        let text = text.replace('&', "&amp;").replace('<', "&lt;");
        self.0 +=
            &format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" {style}>{text}</text>\n");
    }

    pub(super) fn finish(self) -> String {
        self.0 + "</svg>\n"
    }
}
