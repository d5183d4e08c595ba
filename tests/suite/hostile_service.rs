//! Commands against a service that lies, floods or writes to the terminal. The comment above each test defines failure.

use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use fathom_tests::{fathom, run, scripted};
use serde_json::{Value, json};

/// Most resident bytes of a command that reads a flood: the program, and 256 MiB of lines, the largest response.
const MOST_BYTES: u64 = 320 << 20;
/// Longest time until a command gives up.
const LIMIT: Duration = Duration::from_secs(60);

/// Responds to every request with these bytes again and again until the client leaves; returns the URL.
fn flood(head: &'static str, part: &'static [u8]) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let url = format!("http://{}", listener.local_addr().expect("an address"));
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            std::thread::spawn(move || pour(&stream, head, part));
        }
    });
    url
}

fn pour(mut stream: &TcpStream, head: &str, part: &[u8]) -> Option<()> {
    let mut lines = BufReader::new(stream).lines();
    lines
        .find(|line| line.as_ref().is_ok_and(String::is_empty))?
        .ok()?;
    stream.write_all(head.as_bytes()).ok()?;
    let block = part.repeat((1 << 16) / part.len());
    let block = match head.contains("chunked") {
        true => [format!("{:x}\r\n", block.len()).as_bytes(), &block, b"\r\n"].concat(),
        false => block,
    };
    while stream.write_all(&block).is_ok() {}
    None
}

fn start(arguments: &[&str]) -> Child {
    Command::new(fathom())
        .args(arguments)
        .env_remove("FATHOM_TOKEN")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the binary starts")
}

/// Most resident bytes of a process, which must end within the limit.
fn peak_bytes(mut child: Child) -> (bool, u64) {
    let path = format!("/proc/{}/status", child.id());
    let (begun, mut peak) = (Instant::now(), 0);
    loop {
        let status = std::fs::read_to_string(&path).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<u64>().ok());
        peak = peak.max(kib.unwrap_or(0) << 10);
        if let Some(status) = child.try_wait().expect("a child") {
            return (status.success(), peak);
        }
        if begun.elapsed() > LIMIT {
            let _ = child.kill();
            panic!("the command still reads after {LIMIT:?} with {} MiB", peak >> 20);
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Failure: a command that takes more memory than the largest response, does not end, or succeeds.
#[test]
fn an_endless_body_is_cut() {
    let chunked = "HTTP/1.1 200 OK\r\ntransfer-encoding: chunked\r\n\r\n";
    let declared = "HTTP/1.1 200 OK\r\ncontent-length: 99999999999999\r\n\r\n";
    let refused = "HTTP/1.1 500 No\r\nconnection: close\r\n\r\n";
    for (head, part) in [
        (chunked, b"[".as_slice()),
        (chunked, b"\"aaaaaaaaaaaaaaaaaaaa"),
        (declared, b" "),
        (refused, b"{\"a\":"),
    ] {
        let url = flood(head, part);
        for command in [
            vec!["jobs", "--server", &url],
            vec!["errors", "job_01", "--server", &url],
            vec!["query", "uiqm > 0", "--server", &url],
            vec!["wait", "job_01", "--server", &url],
        ] {
            let (success, peak) = peak_bytes(start(&command));
            println!("{command:?}: {} MiB", peak >> 20);
            assert!(!success, "{command:?}");
            assert!(peak < MOST_BYTES, "{command:?} takes {} MiB", peak >> 20);
        }
    }
}

/// Failure: a list that follows cursors without an end.
#[test]
fn endless_cursors_are_not_followed() {
    let cursors: [fn(u64) -> Value; 2] = [|_| json!("same"), |number| json!(number.to_string())];
    for next in cursors {
        let requests = Arc::new(AtomicU64::new(0));
        let counted = Arc::clone(&requests);
        let url = scripted::serve(move |_| {
            let number = counted.fetch_add(1, Ordering::SeqCst);
            let page = json!({"items": [], "next_cursor": next(number)});
            (200, page.to_string().into_bytes())
        });
        for command in ["datasets", "jobs"] {
            let (success, _) = peak_bytes(start(&[command, "--server", &url]));
            assert!(!success, "{command}");
        }
        let sent = requests.load(Ordering::SeqCst);
        assert!(sent < 10, "{sent} requests");
    }
}

/// Failure: an escape sequence of a service that reaches the terminal, or a name that looks like another row.
#[test]
fn no_escape_sequence_of_a_service_reaches_the_terminal() {
    const EVIL: &str = "\u{1b}]0;owned\u{7}\u{1b}[2J\r\u{9b}31m\u{202e}x\njob_forged";
    let url = scripted::serve(|path| {
        let row = json!({"name": EVIL, "images": 1, "bytes": 1, "jobs": 1});
        let image = json!({"job": EVIL, "frame": 1, "uiqm": 0.5});
        let failure = json!({"frame": 1, "strikes": 1, "quarantined": true, "error": EVIL});
        let body = match path.split('?').next() {
            Some("/v1/datasets") => json!({"items": [row], "next_cursor": null, "damaged": [EVIL]}),
            Some("/v1/images") => json!({"items": [image], "next_cursor": null}),
            Some(errors) if errors.ends_with("/errors") => failure,
            _ => {
                return (
                    400,
                    json!({"title": EVIL, "detail": EVIL}).to_string().into_bytes(),
                );
            }
        };
        (200, body.to_string().into_bytes())
    });
    for command in [
        vec!["datasets"],
        vec!["query", "uiqm > 0"],
        vec!["query", "uiqm > 0", "--json"],
        vec!["errors", "job_01"],
        vec!["jobs"],
        vec!["rm", "job_01"],
    ] {
        let output = run(&[command.as_slice(), &["--server", &url]].concat());
        let text = String::from_utf8([output.stdout, output.stderr].concat()).expect("text");
        let bad = text
            .chars()
            .find(|c| (c.is_control() && *c != '\n') || *c == '\u{202e}');
        assert_eq!(bad, None, "{command:?} prints {text:?}");
        let forges = text
            .lines()
            .any(|line| line.trim_start().starts_with("job_forged"));
        let is_list = ["query", "datasets"].contains(&command[0]);
        assert!(!(forges && is_list), "{command:?} prints {text:?}");
    }
}
