//! Small uploads that unpack to large data are decoded in separate processes.

use std::io::Write;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use fathom_tests::Service;
use flate2::Compression;
use flate2::write::ZlibEncoder;

/// Limit on the growth of the service's process for any upload of these tests.
const MOST_GROWTH: u64 = 96 << 20;
const SIDE: usize = 8000;

fn chunk(png: &mut Vec<u8>, name: &[u8; 4], data: &[u8]) {
    let mut checked = name.to_vec();
    checked.extend_from_slice(data);
    let mut crc = flate2::Crc::new();
    crc.update(&checked);
    png.extend_from_slice(&(data.len() as u32).to_be_bytes());
    png.extend_from_slice(&checked);
    png.extend_from_slice(&crc.sum().to_be_bytes());
}

fn zeros(bytes: usize) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    let block = vec![0; 1 << 20];
    let mut left = bytes;
    while left > 0 {
        let some = left.min(block.len());
        encoder.write_all(&block[..some]).expect("memory");
        left -= some;
    }
    encoder.finish().expect("memory")
}

/// A gray picture of zeros, with a chunk between its header and its pixels.
fn png(side: usize, beside: Option<(&[u8; 4], Vec<u8>)>) -> Vec<u8> {
    let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
    let sides = (side as u32).to_be_bytes();
    let header = [&sides[..], &sides[..], &[8, 0, 0, 0, 0]].concat();
    chunk(&mut png, b"IHDR", &header);
    if let Some((name, data)) = beside {
        chunk(&mut png, name, &data);
    }
    chunk(&mut png, b"IDAT", &zeros((side + 1) * side));
    chunk(&mut png, b"IEND", &[]);
    png
}

/// Resident bytes of the children of a process.
fn children_bytes(parent: u32) -> u64 {
    let status = |pid: &str, name: &str| -> Option<u64> {
        let text = std::fs::read_to_string(format!("/proc/{pid}/status")).ok()?;
        let line = text
            .lines()
            .find_map(|line| line.strip_prefix(name))
            .map(str::to_owned)?;
        line.split_whitespace().next()?.parse().ok()
    };
    let processes = std::fs::read_dir("/proc").expect("processes").flatten();
    let pids = processes.filter_map(|entry| entry.file_name().into_string().ok());
    let children = pids.filter(|pid| status(pid, "PPid:") == Some(parent.into()));
    children.filter_map(|pid| status(&pid, "VmRSS:")).sum::<u64>() << 10
}

/// Failure: the service's process grows with the unpacked upload, a bomb is accepted as a scene without decoding, or
/// the service does not respond meanwhile.
#[test]
fn what_unpacks_to_much_leaves_the_service_as_it_is() {
    let data = tempfile::tempdir().expect("a temporary folder");
    let service = Service::start(data.path(), &["--workers", "0"]);
    let (large, profile, text) = (
        png(SIDE, None),
        png(
            16,
            Some((b"iCCP", [b"x\0\0".to_vec(), zeros(256 << 20)].concat())),
        ),
        png(
            16,
            Some((b"zTXt", [b"x\0\0".to_vec(), zeros(256 << 20)].concat())),
        ),
    );
    println!(
        "{}, {} and {} KiB",
        large.len() >> 10,
        profile.len() >> 10,
        text.len() >> 10
    );
    let warm = service.form("/v1/scenes", &[("rgb", &png(16, None))]);
    assert_eq!(warm.0, 201, "{}", warm.1);
    let before = service.resident_bytes();
    let (over, most, most_children) = (AtomicBool::new(false), AtomicU64::new(0), AtomicU64::new(0));
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !over.load(Ordering::SeqCst) {
                most.fetch_max(service.resident_bytes(), Ordering::SeqCst);
                most_children.fetch_max(children_bytes(service.id()), Ordering::SeqCst);
                std::thread::sleep(Duration::from_millis(10));
            }
        });
        let uploads: Vec<_> = [&large, &large, &large, &large, &profile, &profile, &text, &text]
            .into_iter()
            .map(|bomb| scope.spawn(|| service.form("/v1/scenes", &[("rgb", bomb)]).0))
            .collect();
        let begun = Instant::now();
        assert_eq!(service.get("/v1/jobs").0, 200);
        assert!(begun.elapsed() < Duration::from_secs(5));
        let statuses: Vec<u16> = uploads
            .into_iter()
            .map(|upload| upload.join().expect("a response"))
            .collect();
        over.store(true, Ordering::SeqCst);
        println!("{statuses:?}");
        assert!(
            statuses.iter().all(|status| [200, 201, 503].contains(status)),
            "{statuses:?}"
        );
    });
    let enhanced = service.form("/v1/measure", &[("picture", &large)]);
    assert_eq!(enhanced.0, 422, "{}", enhanced.1);
    let (most, after) = (most.into_inner(), service.resident_bytes());
    println!(
        "the service: {} MiB before, {} at most, {} after; its children at most {} MiB together",
        before >> 20,
        most >> 20,
        after >> 20,
        most_children.into_inner() >> 20
    );
    assert!(
        most.max(after) - before < MOST_GROWTH,
        "{} MiB",
        (most.max(after) - before) >> 20
    );
}
