//! All limits of the service, with their reasons.

mod price;

use std::time::Duration;

pub use price::PriceLimits;

/// A job description: the documented example has 900 bytes; a choice among ten thousand scenes has 400 KiB.
pub(crate) const JSON_BYTES: usize = 1 << 20;
/// One scene upload: radiance as float NPY of 16 Mpx (192 MiB) and its range (64 MiB).
pub(crate) const SCENE_BYTES: usize = 256 << 20;
/// Fields of a form, including invalid and repeated ones: a scene has eleven.
pub(crate) const FORM_FIELDS: usize = 32;
/// The two images of a measurement: incompressible 16-bit PNG of 16 Mpx.
pub(crate) const PICTURES_BYTES: usize = 200 << 20;
/// An image to enhance or measure in a request: a method needs up to 200 bytes per pixel, 3 GiB at this size.
pub(crate) const PICTURE_PIXELS: usize = 16_000_000;
/// A picture to render in a request: 4K. Larger ones are uploaded as scenes.
pub(crate) const RENDER_PIXELS: usize = 1 << 23;
/// The form of a picture to render: 8-bit codes, float distances and a mask of that size, uncompressed, are 75 MiB.
pub(crate) const RENDER_BYTES: usize = 80 << 20;
/// A style model and its form: the largest network tried for this has 7 MB.
pub(crate) const STYLE_BYTES: usize = 64 << 20;
/// Photos of one water.
pub(crate) const PHOTOS: usize = 8;
/// The photos of a training and its form.
pub(crate) const PHOTOS_BYTES: usize = 128 << 20;
/// Steps of a training: five times those of the shipped waters.
pub(crate) const STEPS: u32 = 5000;
/// Queued trainings: each keeps its photos on disk.
pub(crate) const OPEN_TRAININGS: usize = 8;
/// Open trainings of one caller.
pub(crate) const OPEN_TRAININGS_OF_CALLER: usize = OPEN_TRAININGS / 2;
/// Trainings kept for status requests: a few kilobytes each.
pub(crate) const KNOWN_TRAININGS: usize = 100;
/// A text of a form: a caveat on a style's card is a paragraph.
pub(crate) const FORM_TEXT_BYTES: usize = 4096;
/// Added styles: the list of all is one page.
pub(crate) const ADDED_STYLES: usize = 1000;
/// Bytes of all added styles: every rendering process keeps them in memory.
pub(crate) const ADDED_STYLES_BYTES: u64 = 1 << 30;
/// Memory of a process that tries a style: the widest of the usual networks needs 1 GiB for 768×492.
pub(crate) const STYLE_TRIAL_MEMORY_BYTES: u64 = 3 << 30;
/// The artifacts of one frame: three float layers of 12 Mpx, and the images.
pub(crate) const ARTIFACT_BYTES: usize = 512 << 20;
/// A worker's message without artifacts: the record of a frame has some tens of kilobytes.
pub(crate) const WORKER_MESSAGE_BYTES: usize = 8 << 20;
/// A request line and headers: a filter in the query may have a few kilobytes.
pub(crate) const HEADER_BYTES: usize = 64 << 10;

/// An ordinary request: the slowest is a query over a large dataset, which the catalogue ends earlier.
pub(crate) const REQUEST: Duration = Duration::from_secs(30);
/// A request with a large body: 256 MiB at 10 Mbit/s take 215 s.
pub(crate) const UPLOAD: Duration = Duration::from_secs(300);
/// A backup: 100 GB at 100 MB/s take 1000 s.
pub(crate) const BACKUP: Duration = Duration::from_secs(3600);
/// Additional time beyond the wait of a long poll.
pub(crate) const LONG_POLL_GRACE: Duration = Duration::from_secs(15);
/// Maximum wait of a request: proxies commonly cut at 60 s.
pub(crate) const MAX_WAIT: Duration = Duration::from_secs(60);
/// Default wait of a direct render without `Prefer`.
pub(crate) const DEFAULT_RENDER_WAIT: Duration = Duration::from_secs(30);
/// Time for open requests to finish after a stop.
pub(crate) const DRAIN: Duration = Duration::from_secs(10);
/// Time for a worker process to return its leases, which is limited to 10 s by the worker.
pub(crate) const WORKER_STOP: Duration = Duration::from_secs(12);

/// How long a request waits for a permit before it is shed: long enough for a burst of submissions to pass in group
/// commits, short enough for a client to notice.
pub(crate) const SHED_AFTER: Duration = Duration::from_millis(500);
/// The wait of a catalogue query, which takes a tenth of a second.
pub(crate) const SHED_QUERY_AFTER: Duration = Duration::from_secs(2);
/// The wait of an upload: its bytes have arrived, and earlier uploads are decoded within seconds.
pub(crate) const SHED_UPLOAD_AFTER: Duration = Duration::from_secs(15);
/// No wait for requests with long-lived permits.
pub(crate) const SHED_IMMEDIATELY: Duration = Duration::ZERO;
/// Minimum mean rate of a body: that of an old modem.
pub(crate) const BODY_BYTES_PER_S: f64 = 1024.0;
/// Files opened by the service itself: catalogue, packs, children.
const OWN_FILES: usize = 256;

/// Default rows of a page.
pub(crate) const DEFAULT_PAGE_ROWS: u32 = 100;
/// The largest page: a few hundred kilobytes of JSON.
pub(crate) const MAX_PAGE_ROWS: u32 = 1000;
/// A filter of this length is parsed in microseconds.
pub(crate) const FILTER_BYTES: usize = 4096;
/// Location of a set: an object's key has at most 1024 bytes, a path 4096.
pub(crate) const SET_URL_BYTES: usize = 4096;
/// An idempotency key: a UUID has 36 characters.
pub(crate) const IDEMPOTENCY_KEY_BYTES: usize = 255;
/// Records per batch of a line-by-line response: about a megabyte.
pub(crate) const RECORDS_BATCH: u32 = 100;
/// Rows per batch: about a megabyte, as a page.
pub(crate) const ROWS_BATCH: u32 = 1000;
/// Minimum pause between progress events.
pub(crate) const PROGRESS_PAUSE: Duration = Duration::from_millis(500);
/// Interval of keep-alive comments without events.
pub(crate) const HEARTBEAT: Duration = Duration::from_secs(15);
/// Side of a thumbnail.
pub(crate) const PREVIEW_PX: usize = 256;

/// Heartbeat interval of a worker.
pub(crate) const BEAT_MS: u32 = 5_000;

/// How long a worker may hold a frame beyond its rendering time, for uploads on a slow connection.
pub(crate) const HAND_IN: Duration = Duration::from_secs(60);

/// Priority of direct renders.
pub(crate) const RENDER_PRIORITY: i32 = 100;
/// Priority of an ordinary job.
pub(crate) const JOB_PRIORITY: i32 = 0;

/// Limits that tests reduce.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Share of each budget below for one caller: a token, or an address without tokens.
    pub caller_percent: usize,
    /// Concurrent public reads; more are shed with 503. Each holds at most an artifact in memory.
    pub requests: usize,
    /// Queries over many images: fewer than the catalogue's readers, so that plain reads find one.
    pub queries: usize,
    /// Submissions and changes.
    pub submissions: usize,
    /// Long polls. They hold a few kilobytes each.
    pub waits: usize,
    /// Direct renders and verifications, which wait for frames.
    pub renders: usize,
    /// Event streams, each open as long as the client listens, with a few events in memory.
    pub streams: usize,
    /// Line-by-line responses, each open as long as the client reads, with a batch of rows in memory.
    pub lines: usize,
    /// Concurrently decoded uploads, each in a process with up to 256 MiB.
    pub uploads: usize,
    /// Total bytes of request bodies, in memory or, of uploads, on disk.
    pub body_bytes: usize,
    /// Total bytes of workers' bodies in memory: the artifacts of one frame are at most 512 MiB, usually 2 MiB.
    pub worker_body_bytes: usize,
    /// Time for a body in addition to the time allowed by its bytes.
    pub body_grace: Duration,
    /// Images enhanced or measured concurrently, each in a process with up to 3 GiB.
    pub pictures: usize,
    /// Total MiB of decoding processes: one of the largest scenes or images, or many usual ones.
    pub decoding_mib: usize,
    /// Processes that render or try a model within a request.
    pub children: usize,
    /// Concurrent worker calls, except waits for a lease. A separate budget, so that a flood of public requests
    /// cannot let leases expire.
    pub worker_calls: usize,
    /// Artifact messages stored concurrently.
    pub worker_uploads: usize,
    /// Heartbeats waiting for a cancelled lease: one per worker.
    pub worker_beats: usize,
    /// Worker calls waiting for a lease: one per slot of the fleet.
    pub worker_waits: usize,
    /// Open connections; more wait in the listen queue.
    pub connections: usize,
    /// Maximum time to send the head of a request, and to keep an idle connection. Longer than the 15 s after which a
    /// worker's connection pool drops an idle connection.
    pub head_read: Duration,
    /// Maximum time a response may be unread before the connection is closed.
    pub unread: Duration,
    /// Bytes reserved for deletions on a full disk. Deleting a thousand rows writes up to 20 MiB of log before it
    /// frees space.
    pub reserve_bytes: u64,
    /// How long stored bytes may be without a row: longer than any lease.
    pub unnamed: Duration,
    /// Concurrent decoding and thumbnails: one per core, because they hold whole images.
    pub compute: usize,
}

impl Default for Limits {
    fn default() -> Self {
        let cores = std::thread::available_parallelism().map_or(4, usize::from);
        Self {
            caller_percent: 50,
            requests: 256,
            queries: 6,
            submissions: 256,
            waits: 1024,
            renders: 256,
            streams: 128,
            lines: 128,
            uploads: 4,
            body_bytes: 1 << 30,
            worker_body_bytes: 2 << 30,
            body_grace: Duration::from_secs(10),
            pictures: 2,
            decoding_mib: 4096,
            children: 2,
            worker_calls: 256,
            worker_uploads: 128,
            worker_beats: 4096,
            worker_waits: 4096,
            connections: open_files().saturating_sub(OWN_FILES).clamp(64, 16_384),
            head_read: Duration::from_secs(30),
            unread: Duration::from_secs(60),
            reserve_bytes: 32 << 20,
            unnamed: Duration::from_secs(3600),
            compute: cores,
        }
    }
}

/// The file descriptor limit of this process.
fn open_files() -> usize {
    const USUAL: usize = 1024;
    let limits = std::fs::read_to_string("/proc/self/limits").unwrap_or_default();
    let line = limits
        .lines()
        .find_map(|line| line.strip_prefix("Max open files"));
    let soft = line.and_then(|line| line.split_whitespace().next()?.parse().ok());
    soft.unwrap_or(USUAL)
}
