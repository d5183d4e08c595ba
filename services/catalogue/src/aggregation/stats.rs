//! Statistics of metrics over a dataset, group by group.

use client::{CountedSource, GroupColumn, GroupStats, Statistics};
use columnar::{GroupBy, Summary};
use serde_json::{Map, Value};

use crate::aggregation::aggregate::{ImageSet, counted_source, number_column};
use crate::aggregation::groups::{Key, MOST_GROUPS, compare_groups, group_value, keys};
use crate::catalogue::Catalogue;
use crate::error::CatalogueError;

/// A query for statistics.
struct StatsQuery<'a> {
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
        let key = group_by
            .map(|name| Key::plain(&self.columns, name, "group_by"))
            .transpose()?;
        let (mut groups, source) = self
            .groups(&StatsQuery {
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
            groups: metric_views(&groups, metrics, |mut key| key.pop().unwrap_or_default()),
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
            .groups(&StatsQuery {
                dataset,
                metrics,
                keys: &keys,
                filter,
                most_groups: Some(MOST_GROUPS),
            })
            .await?;
        groups.sort_by(|one, other| compare_groups(&one.key, &other.key));
        let by: Vec<GroupColumn> = keys.into_iter().map(|key| key.shown).collect();
        Ok(Statistics {
            groups: metric_views(&groups, metrics, |key| {
                let names = by.iter().map(|column| column.column.clone());
                Value::Object(names.zip(key).collect::<Map<_, _>>())
            }),
            by: Some(by),
            source,
        })
    }

    async fn groups(&self, query: &StatsQuery<'_>) -> Result<(Vec<Group>, CountedSource), CatalogueError> {
        let StatsQuery { metrics, keys, .. } = *query;
        if metrics.len() > MOST_METRICS {
            let message = format!("has {} names; must be at most {MOST_METRICS}", metrics.len());
            return Err(CatalogueError::refused_parameter("metrics", &message));
        }
        let mut selected = Vec::with_capacity(metrics.len() + keys.len());
        for metric in metrics {
            selected.push(number_column(&self.columns, metric, "metrics")?);
        }
        selected.extend(keys.iter().map(|key| key.column.clone()));
        let images = ImageSet {
            dataset: query.dataset,
            columns: &selected,
            filter: query.filter,
        };
        let by: Vec<GroupBy> = keys
            .iter()
            .enumerate()
            .map(|(position, key)| GroupBy {
                column: metrics.len() + position,
                bins: key.bins,
            })
            .collect();
        let (count, most) = (metrics.len(), query.most_groups);
        let aggregated = self.aggregate(&images, move |query| columnar::stats(query, count, &by, most));
        let (groups, source) = aggregated.await?;
        let groups = groups.into_iter().map(|(key, values)| Group {
            key: key
                .iter()
                .zip(keys)
                .map(|(cell, key)| group_value(cell, key.is_json))
                .collect(),
            values,
        });
        Ok((groups.collect(), counted_source(source)))
    }
}

/// Upper limit: more than there are metrics.
const MOST_METRICS: usize = 64;

/// A group of images: the value of each `by` column, and a summary of each metric.
struct Group {
    key: Vec<Value>,
    values: Vec<Summary>,
}

/// Views of the groups metric by metric, with keys in the form of `view_of_key`.
fn metric_views(
    groups: &[Group],
    metrics: &[String],
    view_of_key: impl Fn(Vec<Value>) -> Value,
) -> Vec<GroupStats> {
    let keys: Vec<Value> = groups
        .iter()
        .map(|group| view_of_key(group.key.clone()))
        .collect();
    let mut views = Vec::with_capacity(metrics.len() * groups.len());
    for (position, metric) in metrics.iter().enumerate() {
        for (group, key) in groups.iter().zip(&keys) {
            views.push(group_view(key.clone(), metric, &group.values[position]));
        }
    }
    views
}

fn group_view(group: Value, metric: &str, summary: &Summary) -> GroupStats {
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
