//! `fathom demo`: the main use of the program, end to end on one machine.
//!
//! Starts a service with workers on a free port, submits a job of 18 frames, waits for it, prints the dataset's
//! metrics and writes a contact sheet. It uses HTTP, leases and commits as in production. With `--open` the service keeps
//! running, and a browser opens its page.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::Context;
use cli::engine::EngineArguments;
use cli::exit::Failure;
use cli::known::shorten_id;
use cli::remote::LOCAL_SERVICE;
use cli::styles::StyleArguments;
use cli::table::{DASH, cell, image_table, table};
use client::{Client, GroupStats, ImageQuery, StatisticsQuery};

use crate::commands::dataset::sheet;
use crate::commands::job::submit;
use crate::commands::service::serve;

/// Options of `fathom demo`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Folder for the catalogue, the artifacts and the contact sheet
    #[arg(long, value_name = "DIR", default_value = "data/demo")]
    out: PathBuf,
    /// Open the dataset on the page of the service in a browser, and serve it until Ctrl-C
    #[arg(long)]
    open: bool,
    #[command(flatten)]
    style: StyleArguments,
}

/// The job of the demonstration: three small frames of each of six sites, about 20 s on one core.
const SITES: &str = include_str!("../../../../../examples/sites.json");
const ROW_FIELDS: [&str; 8] = [
    "frame",
    "site",
    "water.optics",
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
        max_frame_s: 3600.0,
        max_caller_h: 10_000,
        max_caller_gb: 10_000,
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
    let server = format!("http://{}", service.address());
    let shown = show(&Client::new(&server, None), &arguments.out);
    if arguments.open && shown.is_ok() {
        let page = page_address(&server);
        println!("its page       {page}");
        open_browser(&page);
        runtime.block_on(serve::stop_signal())?;
    }
    runtime.block_on(service.stop()).map_err(anyhow::Error::from)?;
    shown
}

fn show(client: &Client, out: &Path) -> Result<(), Failure> {
    let begun = Instant::now();
    let job = submit::submit(client, SITES.as_bytes(), None, false)?;
    let job = submit::wait(client, &job)?;
    println!(
        "\n{}: {} of {} frames in {:.1} s\n",
        shorten_id(&job.id),
        job.done,
        job.frames,
        begun.elapsed().as_secs_f64()
    );

    let fields = ROW_FIELDS.map(str::to_owned);
    let filter = format!("job == \"{}\"", job.id);
    let mut query = ImageQuery {
        dataset: Some(&job.dataset),
        filter: &filter,
        order_by: Some("frame"),
        fields: &fields,
        limit: 1000,
    };
    println!("{}\n", image_table(&fields, &client.images(query)?));
    println!("{}\n", site_table(client, &job.dataset, &filter)?);

    let picture = out.join("contact-sheet.png");
    let fields = sheet::FIELDS.map(str::to_owned);
    query.fields = &fields;
    sheet::draw(client, query, "rgb", &picture)?;
    println!("contact sheet  {}", picture.display());
    println!("catalogue      {}", out.join("catalogue.sqlite").display());
    println!("images         {}", out.join("packs").display());
    println!("digest         {}", job.digest.as_deref().unwrap_or(DASH));
    println!("serve it again fathom serve --data {}", out.display());
    println!("and look       {}", page_address(LOCAL_SERVICE));
    submit::all_rendered(&job)
}

/// The address of the demonstration on the page of a service.
fn page_address(server: &str) -> String {
    format!("{server}/#/dataset/sites")
}

/// Opens an address in the browser of the desktop, if there is one.
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
        println!("`{opener}` is not installed: open the address in a browser");
    }
}

/// Mean and standard deviation of each metric for each site.
fn site_table(client: &Client, dataset: &str, filter: &str) -> Result<String, Failure> {
    let query = StatisticsQuery {
        metrics: &GROUP_METRICS.join(","),
        group_by: "site",
        filter,
        ..StatisticsQuery::default()
    };
    let groups = client.statistics(dataset, query)?.groups;
    let names: BTreeSet<String> = groups.iter().map(|group| cell(&group.group)).collect();
    let rows: Vec<Vec<String>> = names
        .into_iter()
        .map(|name| {
            let values = GROUP_METRICS.map(|metric| {
                mean_and_deviation(
                    groups
                        .iter()
                        .find(|group: &&GroupStats| cell(&group.group) == name && group.metric == metric),
                )
            });
            std::iter::once(name.clone()).chain(values).collect()
        })
        .collect();
    let header: Vec<&str> = std::iter::once("site").chain(GROUP_METRICS).collect();
    Ok(table(&header, &rows))
}

fn mean_and_deviation(group: Option<&GroupStats>) -> String {
    match group.map(|group| (group.mean, group.sd)) {
        Some((Some(mean), Some(sd))) => format!("{mean:.3} ({sd:.3})"),
        Some((Some(mean), None)) => format!("{mean:.3}"),
        _ => DASH.to_owned(),
    }
}
