//! Times HSCM for `scripts/compare-opencv.sh`: reads a picture; for every number of runs on standard input it prints
//! one line with the milliseconds of each run. An optional second argument is the output file for the result.

use std::error::Error;
use std::io::{self, BufRead, Write};
use std::{env, fs, time::Instant};

use enhance::{Method, run};
use imaging::codec::{decode_picture, encode_png};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = env::args().skip(1);
    let path = arguments.next().ok_or("usage: hscm_times PICTURE [RESULT]")?;
    let picture = decode_picture(&fs::read(path)?)?;
    let method = Method::parse("hscm").ok_or("no such method")?;
    if let Some(result) = arguments.next() {
        fs::write(result, encode_png(&run(&method, &picture)?.picture)?)?;
    }
    for line in io::stdin().lock().lines() {
        let mut times = Vec::new();
        for _ in 0..line?.trim().parse::<usize>()? {
            let start = Instant::now();
            run(&method, &picture)?;
            times.push(format!("{:.4}", start.elapsed().as_secs_f64() * 1e3));
        }
        println!("{}", times.join(" "));
        io::stdout().flush()?;
    }
    Ok(())
}
