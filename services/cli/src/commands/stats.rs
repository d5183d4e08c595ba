//! `fathom stats`: statistics of metrics over datasets, in groups by columns and bins, several datasets side by side.

use catalogue::compare_groups;
use cli::exit::Failure;
use cli::known;
use cli::remote::{Remote, ServerArguments, encode, with_query};
use cli::table::{cell, table};
use serde_json::Value;

/// Options of `fathom stats`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Datasets, shown side by side
    #[arg(required = true, value_name = "DATASET")]
    datasets: Vec<String>,
    /// Metrics, comma-separated
    #[arg(long, value_delimiter = ',', default_value = "uiqm,uciqe")]
    metrics: Vec<String>,
    /// Columns whose values form groups, comma-separated; with a width behind a colon the bins of a number, as in alpha:0.1
    #[arg(long, value_name = "COLUMN[:WIDTH]", value_delimiter = ',')]
    by: Vec<String>,
    /// Only images that fulfill this, such as 'water.depth_m < 10'
    #[arg(long, default_value = "")]
    filter: String,
    /// Print one JSON object per dataset, group and metric
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    server: ServerArguments,
}

/// What is shown of one dataset, and of each of several.
const ALONE: [&str; 8] = ["count", "mean", "sd", "min", "q25", "median", "q75", "max"];
const BESIDE_OTHERS: [&str; 4] = ["count", "mean", "sd", "median"];

/// A row of the table: a group and a metric.
#[derive(PartialEq)]
struct Place {
    group: Vec<Value>,
    /// Position of the metric.
    metric: usize,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let remote = Remote::new(&arguments.server);
    let answers = arguments
        .datasets
        .iter()
        .map(|name| ask(&remote, arguments, name));
    let answers = answers.collect::<Result<Vec<_>, Failure>>()?;
    if arguments.json {
        for (dataset, mut groups) in arguments.datasets.iter().zip(answers) {
            for group in &mut groups {
                group["dataset"] = dataset.as_str().into();
                println!("{group}");
            }
        }
        return Ok(());
    }
    println!("{}", side_by_side(arguments, &answers));
    Ok(())
}

/// The statistics of a dataset, one for each group and metric.
fn ask(remote: &Remote, arguments: &Arguments, dataset: &str) -> Result<Vec<Value>, Failure> {
    known::dataset(remote, dataset)?;
    let (metrics, by) = (arguments.metrics.join(","), arguments.by.join(","));
    let query = [
        ("metrics", Some(metrics.as_str())),
        ("by", Some(by.as_str())),
        ("filter", Some(arguments.filter.as_str())),
    ];
    let path = format!("/v1/datasets/{}/stats", encode(dataset));
    let mut answer = remote.get(&with_query(&path, &query))?;
    Ok(answer["groups"]
        .as_array_mut()
        .map(std::mem::take)
        .unwrap_or_default())
}

/// One line for each group and metric, one group of columns for each dataset.
fn side_by_side(arguments: &Arguments, answers: &[Vec<Value>]) -> String {
    let columns: Vec<&str> = arguments
        .by
        .iter()
        .map(|by| by.rsplit_once(':').map_or(by.as_str(), |(name, _)| name))
        .collect();
    let place = |statistics: &Value| Place {
        group: columns
            .iter()
            .map(|name| statistics["group"][name].clone())
            .collect(),
        metric: arguments
            .metrics
            .iter()
            .position(|metric| statistics["metric"] == **metric)
            .unwrap_or_default(),
    };
    let mut places: Vec<Place> = Vec::new();
    for statistics in answers.iter().flatten() {
        let place = place(statistics);
        if !places.contains(&place) {
            places.push(place);
        }
    }
    places.sort_by(|one, other| compare_groups(&one.group, &other.group).then(one.metric.cmp(&other.metric)));
    let shown = if answers.len() == 1 {
        &ALONE[..]
    } else {
        &BESIDE_OTHERS
    };
    let row = |at: &Place| {
        let mut row: Vec<String> = at.group.iter().map(cell).collect();
        row.push(arguments.metrics[at.metric].clone());
        for groups in answers {
            let found = groups.iter().find(|statistics| place(statistics) == *at);
            row.extend(
                shown
                    .iter()
                    .map(|name| cell(found.map_or(&Value::Null, |found| &found[name]))),
            );
        }
        row
    };
    let rows: Vec<Vec<String>> = places.iter().map(row).collect();
    let mut header: Vec<String> = arguments.by.clone();
    header.push("metric".to_owned());
    for dataset in &arguments.datasets {
        let prefix = if answers.len() == 1 {
            String::new()
        } else {
            format!("{dataset} ")
        };
        header.extend(shown.iter().map(|name| format!("{prefix}{name}")));
    }
    table(&header.iter().map(String::as_str).collect::<Vec<_>>(), &rows)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[derive(clap::Parser)]
    struct Line {
        #[command(flatten)]
        arguments: Arguments,
    }

    #[test]
    fn datasets_stand_side_by_side_and_what_one_lacks_is_a_dash() {
        let line = <Line as clap::Parser>::parse_from([
            "stats",
            "bay",
            "cove",
            "--by",
            "alpha:0.5",
            "--metrics",
            "uiqm",
        ]);
        let group = |alpha: Value, mean: f64| json!({"group": {"alpha": alpha}, "metric": "uiqm", "count": 2, "mean": mean, "sd": null, "median": mean});
        let bay = vec![group(json!(0.5), 2.0), group(Value::Null, 3.0)];
        let cove = vec![group(json!(0.0), 1.25)];
        let shown = side_by_side(&line.arguments, &[bay, cove]);
        let cells: Vec<Vec<&str>> = shown
            .lines()
            .map(|line| line.split_whitespace().collect())
            .collect();
        assert_eq!(
            cells[0].join(" "),
            "alpha:0.5 metric bay count bay mean bay sd bay median cove count cove mean cove sd cove median"
        );
        assert_eq!(
            cells[2],
            ["0", "uiqm", "–", "–", "–", "–", "2", "1.25", "–", "1.25"]
        );
        assert_eq!(cells[3], ["0.5", "uiqm", "2", "2", "–", "2", "–", "–", "–", "–"]);
        assert_eq!(cells[4][0], "–", "images without a value come last");
    }
}
