//! The embedded schema of the catalogue. It is listed by hand, because sqlx's macro for a folder needs a second SQLite at build time.

use sqlx::SqlSafeStr;
use sqlx::migrate::{Migration, MigrationType, Migrator};

/// The files of `migrations/`, in order: description and text. A file's version is its place, from 1.
const FILES: [(&str, &str); 19] = [
    (
        "catalogue",
        include_str!("../../../../migrations/0001_catalogue.sql"),
    ),
    (
        "deletion",
        include_str!("../../../../migrations/0002_deletion.sql"),
    ),
    ("records", include_str!("../../../../migrations/0003_records.sql")),
    (
        "warnings",
        include_str!("../../../../migrations/0004_warnings.sql"),
    ),
    ("waters", include_str!("../../../../migrations/0005_waters.sql")),
    (
        "unfilled",
        include_str!("../../../../migrations/0006_unfilled.sql"),
    ),
    ("classes", include_str!("../../../../migrations/0007_classes.sql")),
    ("sets", include_str!("../../../../migrations/0008_sets.sql")),
    (
        "collections",
        include_str!("../../../../migrations/0009_collections.sql"),
    ),
    (
        "descriptions",
        include_str!("../../../../migrations/0010_descriptions.sql"),
    ),
    (
        "versions",
        include_str!("../../../../migrations/0011_versions.sql"),
    ),
    ("poses", include_str!("../../../../migrations/0012_poses.sql")),
    ("digests", include_str!("../../../../migrations/0013_digests.sql")),
    ("folder", include_str!("../../../../migrations/0014_folder.sql")),
    ("mirror", include_str!("../../../../migrations/0015_mirror.sql")),
    (
        "scene_numbers",
        include_str!("../../../../migrations/0016_scene_numbers.sql"),
    ),
    ("prices", include_str!("../../../../migrations/0017_prices.sql")),
    ("proofs", include_str!("../../../../migrations/0018_proofs.sql")),
    (
        "restarts",
        include_str!("../../../../migrations/0019_restarts.sql"),
    ),
];

/// The migrator that brings any older catalogue up to date.
pub(crate) fn migrator() -> Migrator {
    Migrator::with_migrations(
        (1..)
            .zip(&FILES)
            .map(
                |(version, &(description, sql)): (i64, &(&'static str, &'static str))| {
                    let kind = MigrationType::Simple;
                    Migration::new(version, description.into(), kind, sql.into_sql_str(), false)
                },
            )
            .collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_of_the_folder_is_embedded_under_its_name_and_number() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../migrations");
        let mut found: Vec<_> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        found.sort();
        assert_eq!(
            migrator()
                .iter()
                .map(|m: &Migration| format!("{:04}_{}.sql", m.version, m.description))
                .collect::<Vec<_>>(),
            found
        );
    }
}
