//! Statistics of metrics over a dataset, group by group.

use client::{CountedSource, GroupColumn, GroupStats, Statistics};
use std::collections::HashMap;

use columnar::{ColumnarError, GroupBy, Summary, summary};
use futures::TryStreamExt;
use serde_json::{Map, Value};
use sqlx::sqlite::SqliteConnection;

use crate::catalogue::{Catalogue, within};
use crate::columns::Columns;
use crate::counting::{Asked, check_dataset, counted_source, number_column, too_many_groups};
use crate::error::CatalogueError;
use crate::groups::{Key, MOST_GROUPS, compare_groups, keys, of_cell};
use crate::named::double;
use crate::select::Select;

/// What is asked for.
struct Question<'a> {
    dataset: &'a str,
    metrics: &'a [String],
    keys: &'a [Key],
    filter: Option<&'a str>,
    most_groups: Option<usize>,
}

impl Catalogue {
    /// Statistics of metrics over a dataset, for each value of a column.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`] for the dataset, [`CatalogueError::Filter`] for names and filter.
    pub async fn stats(
        &self,
        dataset: &str,
        metrics: &[String],
        group_by: Option<&str>,
        filter: Option<&str>,
    ) -> Result<Statistics, CatalogueError> {
        let key = group_by.map(|name| Key::plain(&self.columns, name)).transpose()?;
        let (mut groups, source) = self
            .groups(&Question {
                dataset,
                metrics,
                keys: key.as_slice(),
                filter,
                most_groups: None,
            })
            .await?;
        // The order of the first version.
        groups.sort_by_cached_key(|group| group.key.iter().map(ToString::to_string).collect::<String>());
        Ok(Statistics {
            by: None,
            groups: shown(&groups, metrics, |mut key| key.pop().unwrap_or_default()),
            source,
        })
    }

    /// Statistics of metrics over a dataset, for each group by columns and bins such as `water.optics,alpha:0.1`: images
    /// with the same water whose α is in the same bin of width 0.1.
    ///
    /// # Errors
    /// [`CatalogueError::NotFound`] for the dataset; [`CatalogueError::Filter`] for names, bins and filter, and for more groups
    /// than a table should have.
    pub async fn grouped_stats(
        &self,
        dataset: &str,
        metrics: &[String],
        by: &str,
        filter: Option<&str>,
    ) -> Result<Statistics, CatalogueError> {
        let keys = keys(&self.columns, by)?;
        let (mut groups, source) = self
            .groups(&Question {
                dataset,
                metrics,
                keys: &keys,
                filter,
                most_groups: Some(MOST_GROUPS),
            })
            .await?;
        groups.sort_by(|one, other| compare_groups(&one.key, &other.key));
        let by: Vec<GroupColumn> = keys.into_iter().map(|key| key.shown).collect();
        let names = || by.iter().map(|key| key.column.clone());
        let named = |key: Vec<Value>| Value::Object(names().zip(key).collect::<Map<_, _>>());
        Ok(Statistics {
            groups: shown(&groups, metrics, named),
            by: Some(by),
            source,
        })
    }

    async fn groups(&self, question: &Question<'_>) -> Result<(Vec<Group>, CountedSource), CatalogueError> {
        let Question { metrics, keys, .. } = *question;
        check_dataset(&mut *self.reader().await?, question.dataset).await?;
        if metrics.len() > MOST_METRICS {
            let message = format!("{} metrics; there may be {MOST_METRICS}", metrics.len());
            return Err(CatalogueError::refused(message));
        }
        let mut selected = Vec::with_capacity(metrics.len() + keys.len());
        for metric in metrics {
            selected.push(number_column(&self.columns, metric)?);
        }
        selected.extend(keys.iter().map(|key| key.column.clone()));
        let asked = Asked {
            dataset: question.dataset,
            columns: &selected,
            filter: question.filter,
        };
        let by = |(at, key): (usize, &Key)| GroupBy {
            column: metrics.len() + at,
            bins: key.bins,
        };
        let by: Vec<GroupBy> = keys.iter().enumerate().map(by).collect();
        let (count, most) = (metrics.len(), question.most_groups);
        let counted = self.count(&asked, move |question| {
            match columnar::stats(question, count, &by, most.unwrap_or(MOST_GROUPS)) {
                // Without a limit the tables are asked, which need as much memory as there are values.
                Err(ColumnarError::TooManyGroups(_)) if most.is_none() => Err(ColumnarError::NotFinite),
                counted => counted,
            }
        });
        if let Some((groups, source)) = counted.await? {
            let group = |(key, values): (Vec<_>, _)| Group {
                key: key.iter().map(of_cell).collect(),
                values,
            };
            return Ok((groups.into_iter().map(group).collect(), counted_source(source)));
        }
        let mut reader = self.reader().await?;
        let read = read(&mut reader, &self.columns, &asked, question);
        let (groups, rows) = within(read).await?;
        let source = CountedSource {
            mirror: 0,
            catalogue: rows,
        };
        Ok((groups.summarized(), source))
    }
}

/// Upper limit: more than there are metrics.
const MOST_METRICS: usize = 64;

/// One pass over the images for all metrics; returns how many there are, too. The quartiles need every value, and SQLite takes longer
/// to sort them than to hand them over: with three groups 3.3 us a value for aggregates and ranks, against 0.6 us.
async fn read(
    connection: &mut SqliteConnection,
    columns: &Columns,
    asked: &Asked<'_>,
    question: &Question<'_>,
) -> Result<(Groups, u64), CatalogueError> {
    let Question { metrics, keys, .. } = question;
    let sql = Select::new(columns, asked.columns, asked.filter, Some(asked.dataset))?;
    let (mut groups, mut count) = (Groups::default(), 0);
    let mut rows = sql.statement().fetch(connection);
    while let Some(row) = rows.try_next().await? {
        count += 1;
        let key = keys.iter().enumerate();
        let key = key.map(|(at, key)| key.group(&row, metrics.len() + at));
        let values = groups.values_of(key.collect::<Result<_, _>>()?, metrics.len());
        for (at, (values, column)) in values.iter_mut().zip(asked.columns).enumerate() {
            values.extend(double(&row, at, column.kind)?);
        }
        if let Some(most) = question.most_groups.filter(|most| groups.all.len() > *most) {
            return Err(too_many_groups(most));
        }
    }
    drop(rows);
    Ok((groups, count))
}

/// A group of images: what they have in common, column by column, and a value for each metric.
struct Group<V = Summary> {
    key: Vec<Value>,
    values: Vec<V>,
}

/// Groups in the order in which they were met, with all values of each metric.
#[derive(Default)]
struct Groups {
    all: Vec<Group<Vec<f64>>>,
    /// Their places by the text of their key.
    places: HashMap<String, usize>,
    /// Neighbors are often of one group.
    last: usize,
}

impl Groups {
    fn values_of(&mut self, key: Vec<Value>, metrics: usize) -> &mut Vec<Vec<f64>> {
        if self.all.get(self.last).is_none_or(|last| last.key != key) {
            let text = key.iter().map(|value| format!("{value}\n")).collect();
            self.last = *self.places.entry(text).or_insert_with(|| {
                let values = vec![Vec::new(); metrics];
                self.all.push(Group { key, values });
                self.all.len() - 1
            });
        }
        &mut self.all[self.last].values
    }

    fn summarized(self) -> Vec<Group> {
        let group = |group: Group<Vec<f64>>| Group {
            key: group.key,
            values: group.values.into_iter().map(summary).collect(),
        };
        self.all.into_iter().map(group).collect()
    }
}

/// Metric by metric, in the order of the groups, whose keys are shown as `named` says.
fn shown(groups: &[Group], metrics: &[String], named: impl Fn(Vec<Value>) -> Value) -> Vec<GroupStats> {
    let keys: Vec<Value> = groups.iter().map(|group| named(group.key.clone())).collect();
    let of_metric = |(at, metric): (usize, &String)| {
        let groups = groups.iter().zip(&keys);
        groups
            .map(|(group, key)| of_group(key.clone(), metric, &group.values[at]))
            .collect::<Vec<_>>()
    };
    metrics.iter().enumerate().flat_map(of_metric).collect()
}

fn of_group(group: Value, metric: &str, summary: &Summary) -> GroupStats {
    GroupStats {
        group,
        metric: metric.to_owned(),
        count: summary.count,
        mean: summary.mean,
        sd: summary.sd,
        min: summary.min,
        q25: summary.q25,
        median: summary.median,
        q75: summary.q75,
        max: summary.max,
    }
}
