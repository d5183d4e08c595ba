//! `fathom demo`: the main use of the program, end to end on one machine.
//!
//! Starts a service with its own workers on a free port, submits a job of 24 frames, waits for it, prints the dataset's
//! metrics and writes a contact sheet, by way of HTTP, leases and commits as in production. With `--open` the service stays,
//! and a browser shows its page.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::Context;
use cli::engine::EngineArguments;
use cli::exit::Failure;
use cli::images::Question;
use cli::remote::{LOCAL_SERVICE, Remote, ServerArguments, with_query};
use cli::styles::StyleArguments;
use cli::table::{cell, table, table_of};
use serde_json::Value;

use super::{serve, sheet, submit};

/// Options of `fathom demo`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Folder for the catalogue, the artifacts and the contact sheet
    #[arg(long, value_name = "DIR", default_value = "data/demo")]
    out: PathBuf,
    /// Open the set on the page of the service in a browser, and serve it until Ctrl-C
    #[arg(long)]
    open: bool,
    #[command(flatten)]
    style: StyleArguments,
}

/// The job of the demonstration, which is also the example in the README.
const TOUR: &str = include_str!("../../../../examples/tour.json");
const ROW_FIELDS: [&str; 9] = [
    "frame",
    "water.optics",
    "water.style",
    "alpha",
    "entropy",
    "uicm",
    "uiqm",
    "uciqe",
    "hscm.uiqm",
];
const GROUP_METRICS: [&str; 6] = ["entropy", "uicm", "uism", "uiconm", "uiqm", "uciqe"];

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    serve::start_log("warn");
    let runtime = tokio::runtime::Runtime::new().context("cannot start the asynchronous runtime")?;
    let config = serve::config(serve::Arguments {
        data: arguments.out.clone(),
        listen: ([127, 0, 0, 1], 0).into(),
        workers: 1,
        slots: None,
        token: None,
        hosts: Vec::new(),
        style_trial_s: 60,
        frame_limit_s: 600.0,
        mix_workers: false,
        spot_check: 0,
        stores: Vec::new(),
        engine: EngineArguments {
            engine: None,
            engine_token: None,
            lease_s: 60.0,
            replicas: 1,
        },
        style: arguments.style.clone(),
    })?;
    let service = runtime.block_on(api::start(config)).map_err(Failure::input)?;
    let remote = Remote::new(&ServerArguments {
        server: format!("http://{}", service.address()),
        token: None,
    });
    let shown = show(&remote, &arguments.out);
    if arguments.open && shown.is_ok() {
        let page = page_of(&format!("http://{}", service.address()));
        println!("its page       {page}");
        open_browser(&page);
        runtime.block_on(serve::stop_signal())?;
    }
    runtime.block_on(service.stop()).map_err(anyhow::Error::from)?;
    shown
}

fn show(remote: &Remote, out: &Path) -> Result<(), Failure> {
    let begun = Instant::now();
    let job = submit::submit(remote, TOUR.as_bytes(), None, false)?;
    let job = submit::wait(remote, &job)?;
    let text = |name: &str| cell(&job[name]);
    let (id, dataset) = (text("id"), text("dataset"));
    println!(
        "\njob {id}: {} of {} frames in {:.1} s\n",
        text("done"),
        text("frames"),
        begun.elapsed().as_secs_f64()
    );

    let fields = ROW_FIELDS.map(str::to_owned);
    let filter = format!("job == \"{id}\"");
    let mut question = Question {
        dataset: Some(&dataset),
        filter: &filter,
        order_by: Some("frame"),
        fields: &fields,
        limit: 1000,
    };
    println!("{}\n", table_of(&fields, &question.ask(remote)?));
    println!("{}\n", by_style(remote, &dataset, &filter)?);

    let picture = out.join("contact-sheet.png");
    let fields = sheet::FIELDS.map(str::to_owned);
    question.fields = &fields;
    sheet::draw(remote, &question, "rgb", &picture)?;
    println!("contact sheet  {}", picture.display());
    println!("catalogue      {}", out.join("catalogue.sqlite").display());
    println!("images         {}", out.join("packs").display());
    println!("digest         {}", text("digest"));
    println!("serve it again fathom serve --data {}", out.display());
    println!("and look       {}", page_of(LOCAL_SERVICE));
    submit::all_rendered(&job)
}

/// Where the page of a service shows the set of the demonstration.
fn page_of(server: &str) -> String {
    format!("{server}/#/set/tour")
}

/// Has the desktop open an address. Where there is no desktop, the address that was printed has to do.
fn open_browser(address: &str) {
    let opener = if cfg!(target_os = "macos") {
        "open"
    } else {
        "xdg-open"
    };
    let started = Command::new(opener)
        .arg(address)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    if started.is_err() {
        println!("there is no `{opener}` here: open it yourself");
    }
}

/// Mean and standard deviation of each metric for each style water.
fn by_style(remote: &Remote, dataset: &str, filter: &str) -> Result<String, Failure> {
    let metrics = GROUP_METRICS.join(",");
    let parameters = [
        ("metrics", Some(metrics.as_str())),
        ("group_by", Some("water.style")),
        ("filter", Some(filter)),
    ];
    let stats = remote.get(&with_query(&format!("/v1/datasets/{dataset}/stats"), &parameters))?;
    let groups = stats["groups"].as_array().cloned().unwrap_or_default();
    let names: BTreeSet<String> = groups.iter().map(|row| cell(&row["group"])).collect();
    let value = |name: &str, metric: &str| {
        let is_it = |row: &&Value| cell(&row["group"]) == name && row["metric"] == metric;
        let row = groups.iter().find(is_it).unwrap_or(&Value::Null);
        match (row["mean"].as_f64(), row["sd"].as_f64()) {
            (Some(mean), Some(sd)) => format!("{mean:.3} ({sd:.3})"),
            (Some(mean), None) => format!("{mean:.3}"),
            _ => "–".to_owned(),
        }
    };
    let row = |name: String| {
        let values = GROUP_METRICS.map(|metric| value(&name, metric));
        std::iter::once(name).chain(values).collect()
    };
    let rows: Vec<Vec<String>> = names.into_iter().map(row).collect();
    let header: Vec<&str> = std::iter::once("style").chain(GROUP_METRICS).collect();
    Ok(table(&header, &rows))
}
