//! The width of tables and remarks, and short ids.

use std::process::Output;

use fathom_tests::{Service, run, run_in_columns};
use serde_json::{Value, json};

/// Asserts that no line is wider.
fn assert_fits(what: &str, output: &Output, columns: usize) {
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success() && !printed.is_empty(), "{what}");
    for line in printed.lines() {
        let width = line.chars().count();
        assert!(width <= columns, "{what}: {width} columns in {line}");
    }
}

/// The names of everything in a list that `fathom list` prints as JSON.
fn names(arguments: &[&str]) -> Vec<String> {
    let entries: Vec<Value> = serde_json::from_slice(&run(arguments).stdout).expect("JSON");
    let names = entries.iter().filter_map(|entry| entry["name"].as_str());
    names.map(str::to_owned).collect()
}

/// Failure: a note, a model error or the promise of a plan is on one long line.
#[test]
fn the_plan_of_every_site_has_at_most_100_columns() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let sites = names(&["list", "sites", "--json"]);
    assert!(sites.len() > 6, "{sites:?}");
    let mut wrapped = 0;
    for site in sites {
        let spec = folder.path().join(&site);
        let spec = spec.to_str().expect("text");
        assert!(run(&["new", &site, "--out", spec]).status.success());
        let plan = run(&["plan", spec]);
        assert_fits(&site, &plan, 100);
        let printed = String::from_utf8_lossy(&plan.stdout).into_owned();
        assert_fits(&site, &run_in_columns(72, &["plan", spec]), 72);
        let wide = run(&["plan", spec, "--wide"]);
        let wide = String::from_utf8_lossy(&wide.stdout).into_owned();
        let mut remarks = wide.lines().filter(|line| line.starts_with("  "));
        if remarks.any(|remark| remark.chars().count() > 100) {
            assert!(printed.contains("\n    "), "no hanging indent: {printed}");
            wrapped += 1;
        }
        assert_eq!(
            printed.split_whitespace().count(),
            wide.split_whitespace().count()
        );
    }
    assert!(wrapped > 3, "{wrapped} sites have long remarks");
}

/// Failure: the wide names of a list take the place of its meanings.
#[test]
fn every_list_shows_its_meanings_in_80_columns() {
    let all = run_in_columns(80, &["list"]);
    assert_fits("list", &all, 80);
    let header = String::from_utf8_lossy(&all.stdout).into_owned();
    assert!(
        header
            .lines()
            .next()
            .is_some_and(|line| line.contains("what it names"))
    );
    for list in names(&["list", "--json"]) {
        if ["scenes", "collections", "datasets", "jobs"].contains(&list.as_str()) {
            continue;
        }
        let shown = run_in_columns(80, &["list", &list]);
        assert_fits(&list, &shown, 80);
        let shown = String::from_utf8_lossy(&shown.stdout).into_owned();
        let header = shown.lines().next().unwrap_or_default();
        assert!(header.ends_with("meaning"), "{list}: {header}");
        assert!(!shown.contains("not shown"), "{list}: {shown}");
    }
}

/// Failure: the ids of jobs fill a narrow terminal, a command prints a beginning that it does not accept, or scripts get a beginning.
#[test]
fn jobs_are_shown_and_named_by_the_beginning_of_their_id() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let service = Service::start(&folder.path().join("data"), &["--workers", "1"]);
    let job = json!({"dataset": "bay", "count": 2, "site": "tank", "camera": {"width": 48, "height": 32},
        "artifacts": ["rgb"], "metrics": ["uiqm"]});
    let id = service.submit(&job);
    let short = &id[..16];
    let call = |words: &[&str]| {
        let output = run_in_columns(80, &[words, &["--server", &service.url]].concat());
        let text = |bytes| String::from_utf8_lossy(bytes).into_owned();
        let (printed, complaint) = (text(&output.stdout), text(&output.stderr));
        assert!(output.status.success(), "{words:?}: {complaint}");
        printed
    };
    let waited = call(&["wait", short]);
    assert!(
        waited.starts_with(&format!("{short} · dataset bay · done")),
        "{waited}"
    );
    assert!(call(&["wait", short, "--wide"]).starts_with(&id));
    let rows = call(&["query"]);
    assert!(rows.lines().all(|line| line.chars().count() <= 80), "{rows}");
    let header: Vec<&str> = rows
        .lines()
        .next()
        .unwrap_or_default()
        .split_whitespace()
        .collect();
    assert!(header.contains(&"uiqm"), "{header:?}");
    assert!(!header.contains(&"water.style"), "without a value: {header:?}");
    assert!(rows.contains(short) && !rows.contains(&id), "{rows}");
    let filter = format!("job == \"{short}\" and frame < 1");
    for scripted in [["query", &filter, "--wide"], ["query", &filter, "--json"]] {
        let rows = call(&scripted);
        assert_eq!(rows.matches(&id).count(), 1, "{rows}");
    }
    let statistics = call(&["stats", "bay", "--metrics", "uiqm", "--filter", &filter]);
    let row: Vec<&str> = statistics
        .lines()
        .last()
        .unwrap_or_default()
        .split_whitespace()
        .collect();
    assert_eq!(row[..2], ["uiqm", "1"], "{statistics}");
    let path = |name: &str| folder.path().join(name).to_str().expect("text").to_owned();
    call(&["sheet", "bay", "--filter", &filter, "--out", &path("sheet.png")]);
    call(&["export", "bay", "--filter", &filter, "--out", &path("export")]);
    let exported = std::fs::read_to_string(folder.path().join("export/metadata.jsonl")).expect("a list");
    assert_eq!(exported.lines().count(), 1, "{exported}");
    let unknown = run(&["query", "job = 'job_ffffffff'", "--server", &service.url]);
    assert_eq!(unknown.status.code(), Some(2), "no such job");
    assert!(call(&["rm", short, "--yes"]).contains(&id));
}
