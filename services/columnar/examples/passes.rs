//! Measures aggregation over many rows: `cargo run --release -p columnar --example passes -- 10000000 FOLDER`.
//!
//! Writes files of random rows if the folder has none, runs each query repeatedly, and prints the median and the longest
//! time, the processor time of one, and the memory of the process. Other programs can read the same files.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use columnar::{
    About, Bins, Cache, Column, ColumnBuilder, ColumnarError, Condition, GroupBy, Kind, Part, Query,
    ReplicaFile, Sign, Test, Value,
};

/// Rows of a file, as in a service.
const ROWS: u64 = 32_768;
/// Repetitions of each query.
const TIMES: usize = 50;
/// The cache of a service.
const CACHE_BYTES: usize = 64 << 20;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let rows: u64 = arguments.next().map_or(Ok(1_000_000), |text| text.parse())?;
    let folder = arguments.next().ok_or("name a folder")?;
    let list = Path::new(&folder).join("files.txt");
    if !list.exists() {
        let begun = Instant::now();
        let named = (0..rows.div_ceil(ROWS)).map(|file| {
            let first = file * ROWS;
            write(Path::new(&folder), first, ROWS.min(rows - first))
        });
        let named = named.collect::<Result<Vec<_>, _>>()?;
        std::fs::write(&list, named.join("\n"))?;
        println!("{} files in {:.1} s", named.len(), begun.elapsed().as_secs_f64());
    }
    let begun = Instant::now();
    let parts = std::fs::read_to_string(&list)?
        .lines()
        .map(|line| {
            let (name, digest) = line.split_once(' ').unwrap_or_default();
            let file = ReplicaFile::open(&Path::new(&folder).join(name), digest)?;
            Ok(Part::File {
                file: Arc::new(file),
                jobs: None,
            })
        })
        .collect::<Result<Vec<_>, ColumnarError>>()?;
    println!("opened in {:.0} ms", begun.elapsed().as_secs_f64() * 1e3);
    measure_all(&parts)?;
    let status = std::fs::read_to_string("/proc/self/status")?;
    let lines = status
        .lines()
        .filter(|line| line.starts_with("VmRSS") || line.starts_with("VmHWM"));
    lines.for_each(|line| println!("{line}"));
    Ok(())
}

fn measure_all(parts: &[Part]) -> Result<(), ColumnarError> {
    let cache = Cache::new(CACHE_BYTES);
    let above = Condition::Test("alpha".to_owned(), Test::Is(Sign::Above, Value::Number(0.3)));
    let muddy = Test::Is(Sign::Equal, Value::Text("muddy".to_owned()));
    let muddy = Condition::Test("water.style".to_owned(), muddy);
    let both = Condition::All(vec![above, muddy]);
    let by = [
        GroupBy {
            column: 1,
            bins: None,
        },
        GroupBy {
            column: 2,
            bins: Some(Bins::new(0.1)),
        },
    ];
    let run = |columns: &[&str], condition, kind: &str| {
        let columns: Vec<String> = columns.iter().map(|name| (*name).to_owned()).collect();
        let query = Query {
            parts,
            columns: &columns,
            condition,
            cache: &cache,
            threads: 2,
        };
        match kind {
            "histogram" => columnar::histogram(&query, 40, None).map(drop),
            "2-D histogram" => columnar::histogram_2d(&query, 64).map(drop),
            "groups" => columnar::stats(&query, 1, &by, Some(1000)).map(drop),
            _ => columnar::stats(&query, 1, &[], Some(1000)).map(drop),
        }
    };
    measured("histogram", || run(&["uiqm"], None, "histogram"))?;
    measured("histogram under two conditions", || {
        run(&["uiqm"], Some(&both), "histogram")
    })?;
    measured("2-D histogram", || run(&["alpha", "uiqm"], None, "2-D histogram"))?;
    measured("2-D histogram with a third column", || {
        run(&["alpha", "uiqm", "water.range_scale"], None, "2-D histogram")
    })?;
    measured("statistics", || run(&["uiqm"], None, "stats"))?;
    measured("statistics by style and bins of alpha", || {
        run(&["uiqm", "water.style", "alpha"], None, "groups")
    })
}

fn measured(name: &str, run: impl Fn() -> Result<(), ColumnarError>) -> Result<(), ColumnarError> {
    let mut times = Vec::with_capacity(TIMES);
    let before = processor_ms();
    for _ in 0..TIMES {
        let begun = Instant::now();
        run()?;
        times.push(begun.elapsed().as_secs_f64() * 1e3);
    }
    let processor = (processor_ms() - before) / TIMES as f64;
    let first = times[0];
    times.sort_by(f64::total_cmp);
    let (half, most) = (times[TIMES / 2], times[TIMES - 1]);
    println!(
        "{name}: p50 {half:.0} ms, longest {most:.0} ms, first {first:.0} ms; processor time {processor:.0} ms"
    );
    Ok(())
}

/// Processor time of all threads so far: independent of other load of the machine.
fn processor_ms() -> f64 {
    const TICK_MS: f64 = 10.0;
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    let ticks = after_name.split_whitespace().skip(11).take(2);
    ticks.filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() * TICK_MS
}

fn write(folder: &Path, first: u64, rows: u64) -> Result<String, ColumnarError> {
    let number = |salt: u64| {
        let mut column = ColumnBuilder::new(Kind::Number);
        (first..first + rows).for_each(|row| column.number(Some(share(row, salt))));
        column.build()
    };
    let mut style = ColumnBuilder::new(Kind::Text);
    let mut job = ColumnBuilder::new(Kind::Text);
    let mut frame = ColumnBuilder::new(Kind::Whole);
    for row in first..first + rows {
        let place = (3.0 * share(row, 9)) as usize;
        style.text(Some(["atlantic", "mediterranean", "muddy"][place]));
        job.text(Some("job_1"));
        frame.whole(Some(row as i64));
    }
    let named = |name: &str, kind: Kind, column: Column| (name.to_owned(), kind, column);
    let columns = [
        named("job", Kind::Text, job.build()),
        named("frame", Kind::Whole, frame.build()),
        named("alpha", Kind::Number, number(1)),
        named("uiqm", Kind::Number, number(2)),
        named("uciqe", Kind::Number, number(3)),
        named("water.range_scale", Kind::Number, number(4)),
        named("water.style", Kind::Text, style.build()),
    ];
    let about = About {
        first_row: first as i64 + 1,
        last_row: (first + rows) as i64,
        columns: String::new(),
        jobs: BTreeMap::from([("job_1".to_owned(), rows)]),
        checksums: Vec::new(),
    };
    let named = columnar::write(folder, &columns, about)?;
    Ok(format!("{} {}", named.name, named.digest))
}

/// Steele, Lea, Flood (2014), SplitMix64: a number between 0 and 1 for each row and column.
fn share(row: u64, salt: u64) -> f64 {
    let mut z = row.wrapping_add((salt + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (z ^ (z >> 31)) as f64 / u64::MAX as f64
}
