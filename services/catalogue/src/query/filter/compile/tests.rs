//! Compiled and refused filters.

use super::*;
use proptest::prelude::*;

fn lookup(name: &str) -> Option<Column> {
    let kind = match name {
        "uiqm" | "alpha" => Kind::Number,
        "holes" => Kind::Whole,
        "seed" => Kind::Large,
        "style" | "labels.run" => Kind::Text,
        "failed" => Kind::Bool,
        _ => return None,
    };
    let binds = if name == "labels.run" {
        vec![Bind::Text("$.run".into())]
    } else {
        Vec::new()
    };
    let sql = if binds.is_empty() {
        name.to_owned()
    } else {
        "label(?)".to_owned()
    };
    Some(Column {
        sql,
        binds,
        kind,
        unit: None,
        always: false,
        join: None,
        found: None,
        replica_name: Some(name.to_owned()),
        place: "?",
    })
}

fn compiled(text: &str) -> Result<Compiled, FilterError> {
    compile(
        text,
        &lookup,
        &[
            "uiqm".to_owned(),
            "alpha".to_owned(),
            "style".to_owned(),
            "failed".to_owned(),
        ],
    )
}

#[test]
fn not_binds_tighter_than_and_and_that_tighter_than_or() {
    let sql = compiled("failed or not failed and uiqm > 1").unwrap().sql;
    assert_eq!(
        sql,
        "(coalesce(failed, 0) OR ((NOT coalesce(failed, 0)) AND coalesce(uiqm > ?, 0)))"
    );
}

#[test]
fn values_are_bound_in_the_order_of_their_places() {
    let text = "labels.run = \"a\\\"b\" and alpha between 0.2 and 6e-1 and style not in ('x', \"y\")";
    let condition = compiled(text).unwrap();
    assert_eq!(condition.sql.matches('?').count(), condition.binds.len());
    let text = |text: &str| Bind::Text(text.into());
    let expected = [
        text("$.run"),
        text("a\"b"),
        Bind::Number(0.2),
        Bind::Number(0.6),
        text("x"),
        text("y"),
    ];
    assert_eq!(condition.binds, expected);
}

#[test]
fn an_unknown_column_has_its_place_and_its_neighbor() {
    let error = compiled("alpha > 0 and uiqn > 1").unwrap_err();
    assert_eq!(
        (error.position, error.did_you_mean.as_deref()),
        (Some(14), Some("uiqm"))
    );
    assert!(error.to_string().contains("unknown column `uiqn`"));
}

#[test]
fn places_are_counted_in_characters() {
    let error = compiled("style = \"Größe\" and uiqn > 1").unwrap_err();
    assert_eq!(error.position, Some(20));
    let error = compiled("style = \"日本\" and alpha > ü").unwrap_err();
    assert_eq!(error.position, Some(25));
    assert_eq!(compiled("style = \"ä\" and").unwrap_err().position, Some(15));
    assert_eq!(compiled(&"ä".repeat(3000)).unwrap_err().position, Some(2048));
}

#[test]
fn whole_numbers_are_compared_exactly() {
    let bind = |text: &str| compiled(text).unwrap().binds.remove(0);
    assert_eq!(bind("seed = 0"), Bind::Whole(i64::MIN));
    assert_eq!(bind("seed = 9223372036854775808"), Bind::Whole(0));
    assert_eq!(bind("seed >= 18446744073709551615"), Bind::Whole(i64::MAX));
    assert_eq!(
        bind("seed = 9007199254740993"),
        Bind::Whole((1_i64 << 53) + 1 - i64::MAX - 1)
    );
    assert_eq!(bind("seed < 18446744073709551616"), Bind::Number(f64::INFINITY));
    assert_eq!(bind("seed > -1"), Bind::Number(f64::NEG_INFINITY));
    assert_eq!(bind("seed < 1e19"), Bind::Whole(776_627_963_145_224_192));
    assert_eq!(bind("holes = 3"), Bind::Whole(3));
    assert_eq!(bind("holes < 3.5"), Bind::Number(3.5));
    assert!(compiled("seed = 1.5").is_err());
    assert!(compiled("seed between 18446744073709551615 and 18446744073709551614").is_err());
}

#[test]
fn what_does_not_fit_is_refused() {
    for text in [
        "",
        "uiqm",
        "uiqm >",
        "uiqm > 'a'",
        "style < 'a'",
        "style = 1",
        "alpha between 2 and 1",
        "(failed",
        "failed)",
        "uiqm in ()",
        "uiqm > nan",
        "uiqm > 1e999",
        "style = 'open",
        "uiqm ; drop",
        "is null",
        "alpha not 1",
    ] {
        assert!(compiled(text).is_err(), "{text}");
    }
    assert!(compiled(&"(".repeat(10_000)).is_err());
    assert!(compiled(&format!("{}failed", "not ".repeat(900))).is_err());
    assert!(compiled(&format!("uiqm in (1{})", ",1".repeat(300))).is_err());
}

proptest! {
    #[test]
    fn no_text_panics(text in ".{0,80}") {
        let _ = compiled(&text);
    }

    #[test]
    fn no_row_of_words_panics(words in proptest::collection::vec(0usize..16, 0..20)) {
        let all = ["uiqm", "style", "failed", "and", "or", "not", "in", "between", "(", ")", ",", "1", "'a'", "<", "is", "null"];
        let text: Vec<&str> = words.iter().map(|&index| all[index]).collect();
        if let Ok(condition) = compiled(&text.join(" ")) {
            prop_assert_eq!(condition.sql.matches('?').count(), condition.binds.len());
        }
    }
}
