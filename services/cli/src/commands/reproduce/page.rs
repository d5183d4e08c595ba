//! The page: figures, Table 1 and the options of the published node, as HTML without scripts.

use std::fmt::Write;

use super::declaration::Figure;
use super::options::{NodeOption, OPTIONS};
use super::table::{METHODS, Method, Published, Spread, Summary};

/// A picture next to the page.
pub(super) struct Picture {
    /// Path from the page.
    pub(super) file: String,
    pub(super) label: String,
    pub(super) width: usize,
    pub(super) height: usize,
}

/// A figure with its pictures.
pub(super) struct DrawnFigure<'a> {
    pub(super) declared: &'a Figure,
    pub(super) pictures: Vec<Picture>,
    /// Descriptions of its jobs.
    pub(super) jobs: Vec<String>,
}

/// Table 1 and its frames.
pub(super) struct MeasuredTable {
    pub(super) frames: u64,
    /// Description of its job.
    pub(super) job: String,
    /// One for each of [`METHODS`].
    pub(super) summaries: Vec<Summary>,
}

const PAPER: &str = "O. Álvarez-Tuñón, A. Jardón and C. Balaguer: \
    <a href=\"https://doi.org/10.3390/s19245497\">Generation and Processing of Simulated Underwater Images for \
    Infrastructure Visual Inspection with UUVs</a>. Sensors 19 (24), 5497, 2019";
const CAPTIONS: &str = "The authors' pictures, captions and frames are not included. Each caption states in substance what \
    the description of the method shows at this point, not the words of the paper, and the numbers of the figures \
    follow the order of that description. Every picture is rendered by this program from the job below its figure.";
const TABLE_NOTE: &str = "Mean, standard deviation in parentheses, published numbers below. The published frames are \
    photographs that are not public; these are simulated like those of Figure 10, so compare order and magnitude, not \
    digits. Light uniformity is 1 for an evenly lit picture. Noise of the sensor and fine texture raise UISM. UIConM divides by the darkest pixels of small blocks: \
    single dark pixels next to bright ones change it more than the method does. Published seconds are from the authors' \
    machine; the command prints those of yours.";

/// The whole page.
pub(super) fn write_page(figures: &[DrawnFigure], table: &MeasuredTable) -> String {
    let links = figures.iter().map(|figure| {
        let number = figure.declared.number;
        format!("<a href=\"#figure-{number}\">Figure {number}</a>")
    });
    let links: String = links.collect::<Vec<_>>().join(" ");
    let figures: String = figures.iter().map(write_figure).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>The published method, reproduced</title>\n<style>\n{}</style>\n</head>\n<body>\n\
         <h1>Figures 3 to 11 and Table 1 of the published method</h1>\n\
         <p>{PAPER}. Made by <code>fathom reproduce</code>, fathom {}.</p>\n<p class=\"note\">{CAPTIONS}</p>\n\
         <nav>{links} <a href=\"#table-1\">Table 1</a> <a href=\"#options\">Options of the node</a></nav>\n\
         {figures}{}{}</body>\n</html>\n",
        include_str!("page.css"),
        env!("CARGO_PKG_VERSION"),
        write_table(table),
        write_options(),
    )
}

fn write_figure(figure: &DrawnFigure) -> String {
    let Figure {
        number,
        title,
        caption,
        differs,
        columns,
        ..
    } = figure.declared;
    let (title, caption, differs) = (escape(title), escape(caption), escape(differs));
    let mut text = format!(
        "<section id=\"figure-{number}\">\n<h2>Figure {number}. {title}</h2>\n<p>{caption}</p>\n\
         <p class=\"note\">Here: {differs}</p>\n<div class=\"panels\" style=\"--columns: {columns}\">\n"
    );
    for Picture {
        file,
        label,
        width,
        height,
    } in &figure.pictures
    {
        let label = escape(label);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "<figure><a href=\"{file}\"><img src=\"{file}\" width=\"{width}\" height=\"{height}\" \
             alt=\"{title}: {label}\" loading=\"lazy\"></a><figcaption>{label}</figcaption></figure>"
        );
    }
    text + "</div>\n" + &write_jobs(&figure.jobs) + "</section>\n"
}

fn write_jobs(jobs: &[String]) -> String {
    let title = if jobs.len() == 1 { "Its job" } else { "Its jobs" };
    let texts = jobs.iter().map(|job| format!("<pre>{}</pre>", escape(job)));
    format!(
        "<details><summary>{title}</summary>\n{}\n</details>\n",
        texts.collect::<String>()
    )
}

fn write_table(table: &MeasuredTable) -> String {
    let rows = METHODS.iter().zip(&table.summaries);
    let published: String = rows
        .clone()
        .map(|(method, summary)| write_row(method, summary))
        .collect();
    let usual: String = rows
        .map(|(method, summary)| {
            let cells: String = summary
                .usual_profile
                .iter()
                .map(|spread| write_cell(*spread, None))
                .collect();
            let (warned, frames) = (summary.warned, table.frames);
            format!(
                "<tr><th scope=\"row\">{}</th>{cells}<td class=\"number\">{warned} of {frames}</td></tr>\n",
                method.title
            )
        })
        .collect();
    let head = ["Entropy", "UICM", "UISM", "UIConM", "UIQM"]
        .map(|name| format!("<th class=\"number\">{name}</th>"))
        .concat();
    format!(
        "<section id=\"table-1\">\n<h2>Table 1. Enhancement methods by quality metrics</h2>\n\
         <p>{} simulated frames of six sites, without masks, in the arithmetic of the published table (profile <code>table1</code>).</p>\n\
         <p class=\"note\">{TABLE_NOTE}</p>\n<div class=\"wide\"><table>\n\
         <tr><th>Method</th>{head}<th class=\"number\">s, published</th><th>What differs, besides the frames</th></tr>\n\
         {published}</table></div>\n\
         <p>The same frames in the usual arithmetic (profile <code>panetta</code>):</p>\n<div class=\"wide\"><table>\n\
         <tr><th>Method</th>{head}<th class=\"number\">Light uniformity</th><th class=\"number\">Frames with a warning</th></tr>\n{usual}</table></div>\n{}</section>\n",
        table.frames,
        write_jobs(std::slice::from_ref(&table.job)),
    )
}

fn write_row(method: &Method, summary: &Summary) -> String {
    let published = method.published.as_ref();
    let cells = summary
        .published_profile
        .iter()
        .enumerate()
        .map(|(metric, spread)| {
            let below = published.map(
                |Published {
                     means,
                     entropy_deviation,
                     ..
                 }| match metric {
                    0 => format!("{:.2} ({entropy_deviation:.2})", means[0]),
                    _ => format!("{:.2}", means[metric]),
                },
            );
            write_cell(*spread, below)
        });
    let seconds = published.map_or_else(|| "–".to_owned(), |published| published.seconds.to_string());
    format!(
        "<tr><th scope=\"row\">{}</th>{}<td class=\"number\">{seconds}</td><td>{}</td></tr>\n",
        method.title,
        cells.collect::<String>(),
        method.differs
    )
}

fn write_cell(Spread { mean, deviation }: Spread, below: Option<String>) -> String {
    let below = below.map_or_else(String::new, |text| format!("<small>{text}</small>"));
    format!("<td class=\"number\">{mean:.2} ({deviation:.2}){below}</td>")
}

fn write_options() -> String {
    let rows = OPTIONS.iter().map(|NodeOption { name, meaning, fields, translation }| {
        let fields = fields.iter().map(|field| format!("<code>{field}</code>"));
        let fields = fields.collect::<Vec<_>>().join("<br>");
        let fields = if fields.is_empty() { "–".to_owned() } else { fields };
        let translation = escape(translation).replace('`', "");
        format!("<tr><th scope=\"row\">{name}</th><td>{meaning}</td><td>{fields}</td><td>{translation}</td></tr>\n")
    });
    format!(
        "<section id=\"options\">\n<h2>Options of the published node and fields of a job</h2>\n<div class=\"wide\"><table>\n\
         <tr><th>Option</th><th>Meaning and default</th><th>Fields</th><th>Translation</th></tr>\n{}</table></div>\n</section>\n",
        rows.collect::<String>()
    )
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
