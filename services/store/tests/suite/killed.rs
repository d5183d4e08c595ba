//! A process that stores, deletes and compacts, and is killed at random and at critical moments.
//!
//! Failures: an acknowledged blob that cannot be read; a deleted blob that is still there; a store that does not
//! open.
//! The process is this test program, running only [`child`].

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;

use store::Store;

use crate::fixture::{digests, numbered};

/// Environment variable with the store's folder and the first number of [`child`].
const PLACE: &str = "STORE_OF_THE_CHILD";
const PACK_BYTES: u64 = 1_500_000;
const BLOB_BYTES: usize = 50_000;

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
#[ignore = "run by the tests below, which kill it"]
async fn child() {
    let place = std::env::var(PLACE).expect("started by the tests below");
    let (first, path) = place.split_once(' ').unwrap();
    let store = Arc::new(Store::open_with(path.as_ref(), PACK_BYTES).await.unwrap());
    let first: u64 = first.parse().unwrap();
    let mut tasks = tokio::task::JoinSet::new();
    for lane in first..first + 4 {
        let store = Arc::clone(&store);
        tasks.spawn(async move {
            for number in (lane..).step_by(4) {
                let blob = numbered(number, BLOB_BYTES);
                store.put_all(vec![blob.clone()]).await.unwrap();
                writeln!(std::io::stdout(), "put {number}").unwrap();
                // Four of five are deleted again.
                if number % 5 > 0 {
                    writeln!(std::io::stdout(), "deleting {number}").unwrap();
                    store.delete(&digests(&[blob])).await.unwrap();
                    writeln!(std::io::stdout(), "deleted {number}").unwrap();
                }
            }
        });
    }
    loop {
        store.compact().await.unwrap();
    }
}

#[derive(Default)]
struct Heard {
    put: BTreeSet<u64>,
    deleting: BTreeSet<u64>,
    deleted: BTreeSet<u64>,
}

impl Heard {
    fn note(&mut self, line: &str) {
        for (word, set) in [
            ("put ", &mut self.put),
            ("deleting ", &mut self.deleting),
            ("deleted ", &mut self.deleted),
        ] {
            set.extend(
                line.strip_prefix(word)
                    .and_then(|number| number.parse::<u64>().ok()),
            );
        }
    }
}

fn run_and_kill(heard: &mut Heard, path: &Path, first: u64, faults: Option<&str>, most: usize) {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command
        .args([
            "killed::child",
            "--exact",
            "--ignored",
            "--nocapture",
            "--test-threads=1",
        ])
        .env(PLACE, format!("{first} {}", path.display()))
        .stdout(Stdio::piped())
        .stderr(Stdio::null());
    if let Some(faults) = faults {
        command.env("FATHOM_FAULTS", faults);
    }
    let mut child = command.spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap())
        .lines()
        .map_while(Result::ok);
    for line in lines.by_ref().take(most) {
        heard.note(&line);
    }
    child.kill().unwrap();
    // Lines already in the pipe count as well.
    lines.for_each(|line| heard.note(&line));
    assert!(!child.wait().unwrap().success());
}

#[tokio::test(flavor = "multi_thread")]
async fn acknowledged_writes_survive_every_kill() {
    let folder = tempfile::tempdir().unwrap();
    let mut heard = Heard::default();
    let rounds = [
        (None, 200),
        (Some("pack.written=abort@40"), usize::MAX),
        (Some("pack.committed=abort@41"), usize::MAX),
        (Some("pack.moved=abort@42"), usize::MAX),
        (None, 500),
        (Some("pack.moved=abort@77"), usize::MAX),
        (Some("pack.removing=abort@2"), usize::MAX),
        (Some("pack.removed=abort@3"), usize::MAX),
        (None, 900),
        (None, 333),
    ];
    for (round, (faults, most)) in rounds.into_iter().enumerate() {
        let first = 1_000_000 * round as u64;
        run_and_kill(&mut heard, folder.path(), first, faults, most);
        let store = Store::open_with(folder.path(), PACK_BYTES).await.unwrap();
        for &number in &heard.put {
            let blob = numbered(number, BLOB_BYTES);
            let stored = store.get(&blob.digest).await.unwrap();
            if heard.deleted.contains(&number) {
                assert!(stored.is_none(), "round {round}: {number} was deleted");
            } else if !heard.deleting.contains(&number) {
                assert!(stored == Some(blob.bytes), "round {round}: {number} was stored");
            }
        }
        store.close().await;
    }
    assert!(heard.put.len() > 300 && heard.deleted.len() > 200);
}
