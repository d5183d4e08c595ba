//! `fathom verify`: reads a set again and compares it with its markers, and frames with those rendered again.

use std::collections::BTreeMap;

use cli::exit::Failure;
use cli::progress::Progress;
use cli::seal::VerifyArguments;
use sets::{Crew, Set};

use super::failure::failure;
use super::open::open;
use super::render::recipe;

/// Runs the command.
pub(crate) fn run(arguments: &VerifyArguments) -> Result<(), Failure> {
    let set = open(&arguments.what)?;
    let done = set.done().map_err(failure)?;
    let shards = spread(&done, arguments.sample.unwrap_or(done.len() as u64));
    let mut progress = Progress::new("verify", "shards", shards.len() as u64);
    let (mut damage, mut bytes) = (Vec::new(), 0);
    for (number, &shard) in shards.iter().enumerate() {
        let report = set.verify(shard).map_err(failure)?;
        bytes += report.bytes;
        damage.extend(report.damage);
        progress.set(number as u64 + 1);
    }
    progress.finish();
    if damage.is_empty() {
        damage.extend(render(arguments, &set, &done)?);
    }
    for what in &damage {
        println!("{what}");
    }
    let read = bytes >> 20;
    println!(
        "{} of {} shards read ({read} MiB), {} rendered frames",
        shards.len(),
        done.len(),
        arguments.render
    );
    match damage.len() {
        0 => Ok(()),
        count => Err(anyhow::anyhow!(
            "{count} damaged; remove the marker of a damaged shard from done/ and render again"
        )
        .into()),
    }
}

fn render(arguments: &VerifyArguments, set: &Set, done: &[u64]) -> Result<Vec<String>, Failure> {
    if arguments.render == 0 {
        return Ok(Vec::new());
    }
    let job = set.job().map_err(failure)?;
    let mut crew = Crew::new(recipe(&arguments.style, 1, &arguments.limits)?, job);
    let frames: Vec<u64> = done
        .iter()
        .flat_map(|&shard| set.card().frames_of(shard))
        .collect();
    let mut by_shard: BTreeMap<u64, Vec<u64>> = BTreeMap::new();
    for frame in spread(&frames, arguments.render) {
        let shard = frame / set.card().frames_per_shard;
        by_shard.entry(shard).or_default().push(frame);
    }
    let mut wrong = Vec::new();
    for (shard, frames) in by_shard {
        let differences = set.verify_by_rendering(shard, &frames, &mut crew);
        wrong.extend(differences.map_err(failure)?);
    }
    Ok(wrong)
}

/// Picks this many of them, evenly spaced.
fn spread(all: &[u64], wanted: u64) -> Vec<u64> {
    let wanted = wanted.min(all.len() as u64);
    (0..wanted)
        .map(|number| all[(number * all.len() as u64 / wanted) as usize])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_is_spread_over_all() {
        let all: Vec<u64> = (0..10).collect();
        assert_eq!(spread(&all, 5), [0, 2, 4, 6, 8]);
        assert_eq!(spread(&all, 99), all);
        assert!(spread(&all, 0).is_empty() && spread(&[], 3).is_empty());
    }
}
