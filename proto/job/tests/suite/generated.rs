//! Generated documentation. `FATHOM_WRITE=1 cargo test -p spec` updates it.

const FOLDER: &str = env!("CARGO_MANIFEST_DIR");

/// Compares a page with the committed one, or writes it.
pub(crate) fn check_page(file: &str, generate: impl FnOnce(&str) -> String) {
    let path = format!("{FOLDER}/{file}");
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    let page = generate(&committed);
    if std::env::var_os("FATHOM_WRITE").is_some() {
        std::fs::write(&path, page).unwrap();
    } else {
        assert!(
            committed == page,
            "{file} is out of date: run FATHOM_WRITE=1 cargo test -p spec and review the change"
        );
    }
}

/// The page with the table that begins with `head` replaced.
fn replace_table(page: &str, head: &str, table: &str) -> String {
    let start = page.find(head).unwrap();
    let end = page[start..]
        .find("\n\n")
        .map_or(page.len(), |end| start + end + 1);
    format!("{}{table}{}", &page[..start], &page[end..])
}

#[test]
fn the_field_table_is_up_to_date() {
    check_page("FIELDS.md", |page| {
        replace_table(page, "| field | kind |", &spec::table::markdown())
    });
}

#[test]
fn the_migration_table_is_up_to_date() {
    check_page("../../docs/reference/migration.md", |page| {
        replace_table(page, "| up to 0.1 |", &spec::migration::markdown())
    });
}
