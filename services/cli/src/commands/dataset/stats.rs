//! `fathom stats`: statistics of metrics over datasets, in groups by columns and bins, several datasets side by side.

use catalogue::compare_groups;
use cli::exit::Failure;
use cli::filter::expand_jobs;
use cli::known;
use cli::remote::ServerArguments;
use cli::table::{cell, optional_decimal, table};
use client::{Client, GroupStats, StatisticsQuery};
use serde_json::{Value, json};

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

/// A statistic in a column of the table.
type Statistic = (&'static str, fn(&GroupStats) -> Option<f64>);

const COUNT: Statistic = ("count", |group| Some(group.count as f64));
const MEAN: Statistic = ("mean", |group| group.mean);
const SD: Statistic = ("sd", |group| group.sd);
const MEDIAN: Statistic = ("median", |group| group.median);
/// The columns of a single dataset, and of each of several.
const DETAILED: [Statistic; 8] = [
    COUNT,
    MEAN,
    SD,
    ("min", |group| group.min),
    ("q25", |group| group.q25),
    MEDIAN,
    ("q75", |group| group.q75),
    ("max", |group| group.max),
];
const BRIEF: [Statistic; 4] = [COUNT, MEAN, SD, MEDIAN];

/// A row of the table: a group and a metric.
#[derive(PartialEq)]
struct RowKey {
    group: Vec<Value>,
    /// Position of the metric.
    metric: usize,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let client = arguments.server.client();
    let groups = arguments
        .datasets
        .iter()
        .map(|name| statistics(&client, arguments, name));
    let groups = groups.collect::<Result<Vec<_>, Failure>>()?;
    if !arguments.json {
        println!("{}", comparison_table(arguments, &groups));
        return Ok(());
    }
    for (dataset, groups) in arguments.datasets.iter().zip(groups) {
        for group in groups {
            let mut line = json!(group);
            line["dataset"] = dataset.as_str().into();
            println!("{line}");
        }
    }
    Ok(())
}

/// The statistics of a dataset, one entry for each group and metric.
fn statistics(client: &Client, arguments: &Arguments, dataset: &str) -> Result<Vec<GroupStats>, Failure> {
    known::dataset(client, dataset)?;
    let query = StatisticsQuery {
        metrics: &arguments.metrics.join(","),
        by: &arguments.by.join(","),
        filter: &expand_jobs(client, &arguments.filter)?,
        ..StatisticsQuery::default()
    };
    Ok(client.statistics(dataset, query)?.groups)
}

/// One line for each group and metric, one group of columns for each dataset.
fn comparison_table(arguments: &Arguments, datasets: &[Vec<GroupStats>]) -> String {
    let mut keys: Vec<RowKey> = Vec::new();
    for group in datasets.iter().flatten() {
        let key = RowKey::new(arguments, group);
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    keys.sort_by(|one, other| compare_groups(&one.group, &other.group).then(one.metric.cmp(&other.metric)));
    let statistics = match datasets {
        [_] => &DETAILED[..],
        _ => &BRIEF,
    };
    let rows: Vec<Vec<String>> = keys
        .iter()
        .map(|key| {
            let mut cells: Vec<String> = key.group.iter().map(cell).collect();
            cells.push(arguments.metrics[key.metric].clone());
            for groups in datasets {
                let group = groups.iter().find(|group| RowKey::new(arguments, group) == *key);
                let values = statistics.iter().map(|(_, value)| group.and_then(value));
                cells.extend(values.map(optional_decimal));
            }
            cells
        })
        .collect();
    let mut header: Vec<String> = arguments.by.clone();
    header.push("metric".to_owned());
    for dataset in &arguments.datasets {
        let prefix = match datasets {
            [_] => String::new(),
            _ => format!("{dataset} "),
        };
        header.extend(statistics.iter().map(|(name, _)| format!("{prefix}{name}")));
    }
    table(&header.iter().map(String::as_str).collect::<Vec<_>>(), &rows)
}

impl RowKey {
    fn new(arguments: &Arguments, group: &GroupStats) -> Self {
        let columns = arguments
            .by
            .iter()
            .map(|by| by.rsplit_once(':').map_or(by.as_str(), |(name, _)| name));
        let position = arguments
            .metrics
            .iter()
            .position(|metric| *metric == group.metric);
        Self {
            group: columns.map(|name| group.group[name].clone()).collect(),
            metric: position.unwrap_or_default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(clap::Parser)]
    struct Line {
        #[command(flatten)]
        arguments: Arguments,
    }

    #[test]
    fn datasets_have_columns_side_by_side_with_dashes_for_missing_groups() {
        let line = <Line as clap::Parser>::parse_from([
            "stats",
            "bay",
            "cove",
            "--by",
            "alpha:0.5",
            "--metrics",
            "uiqm",
        ]);
        let group = |alpha: Value, mean: f64| GroupStats {
            group: json!({"alpha": alpha}),
            metric: "uiqm".to_owned(),
            count: 2,
            mean: Some(mean),
            sd: None,
            min: None,
            q25: None,
            median: Some(mean),
            q75: None,
            max: None,
        };
        let bay = vec![group(json!(0.5), 2.0), group(Value::Null, 3.0)];
        let cove = vec![group(json!(0.0), 1.25)];
        let shown = comparison_table(&line.arguments, &[bay, cove]);
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
        assert_eq!(cells[4][0], "–", "images without a value are last");
    }
}
