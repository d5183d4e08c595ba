//! The page of the published figures: complete, equal in every run, and refused before any work where its folder is wrong.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use fathom_tests::run;

fn reproduce(out: &Path) -> std::process::Output {
    let out = out.to_str().expect("text");
    run(&["reproduce", "--out", out, "--frames", "2", "--width", "96"])
}

/// Every file below a folder with its bytes.
fn read_all(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        if path.is_dir() {
            let inner = read_all(&path).into_iter();
            files.extend(inner.map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)));
        } else {
            files.insert(name, fs::read(&path).expect("a file"));
        }
    }
    files
}

/// The values of an attribute in the order of the page.
fn attributes<'a>(page: &'a str, name: &str) -> Vec<&'a str> {
    let start = format!("{name}=\"");
    let values = page.split(&start).skip(1);
    values
        .map(|rest| rest.split('"').next().unwrap_or_default())
        .collect()
}

#[test]
fn two_runs_write_the_same_page_and_every_picture_it_shows() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let pages = ["one", "two"].map(|name| {
        let out = folder.path().join(name);
        let output = reproduce(&out);
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        read_all(&out)
    });
    let [files, again] = &pages;
    assert!(files == again, "the bytes of two runs differ");
    let page = String::from_utf8(files["index.html"].clone()).expect("UTF-8");
    for number in 3..=11 {
        assert!(
            page.contains(&format!("<h2>Figure {number}. ")),
            "figure {number}"
        );
    }
    let shown = attributes(&page, "img src");
    assert_eq!(shown.len(), files.len() - 1, "a picture is not shown");
    for file in shown {
        assert!(files.contains_key(file), "{file}");
    }
    assert!(attributes(&page, "alt").iter().all(|text| text.len() > 10));
    assert!(page.contains("4.62 (0.43)") && !page.contains("NaN") && !page.contains("inf<"));
    assert!(!page.contains("<script"));
}

#[test]
fn a_wrong_folder_is_refused_before_any_work() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("file");
    fs::write(&file, "mine").expect("a writable folder");
    for (out, reason) in [(folder.path(), "is not empty"), (file.as_path(), "cannot create")] {
        let output = reproduce(out);
        let printed = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{printed}");
        assert!(printed.contains("--out") && printed.contains(reason), "{printed}");
        assert_eq!(printed.lines().count(), 1, "{printed}");
    }
    assert_eq!(read_all(folder.path()).len(), 1);
}
