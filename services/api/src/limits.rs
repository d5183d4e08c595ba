//! Every limit of the service, with its reason.

use std::time::Duration;

/// A job description: the documented example has 900 bytes; a choice among ten thousand scenes has 400 KiB.
pub(crate) const JSON_BYTES: usize = 1 << 20;
/// One scene upload: radiance as float NPY of 16 Mpx (192 MiB) and its range (64 MiB).
pub(crate) const SCENE_BYTES: usize = 256 << 20;
/// Fields of a form, wrong ones and repeated ones included: a scene has eleven.
pub(crate) const FORM_FIELDS: usize = 32;
/// The two pictures of a measurement: 16-bit PNG of 16 Mpx that did not compress.
pub(crate) const PICTURES_BYTES: usize = 200 << 20;
/// A picture to enhance or measure at once: a method holds up to 200 bytes a pixel, 3 GiB at this size.
pub(crate) const PICTURE_PIXELS: usize = 16_000_000;
/// A style model and its form: the largest network that anybody tried for this has 7 MB.
pub(crate) const STYLE_BYTES: usize = 64 << 20;
/// Photos of one water.
pub(crate) const PHOTOS: usize = 8;
/// The photos of a training and its form.
pub(crate) const PHOTOS_BYTES: usize = 128 << 20;
/// Steps of a training: five times what the shipped waters took.
pub(crate) const STEPS: u32 = 5000;
/// Trainings that wait for each other: each keeps its photos on the disk.
pub(crate) const OPEN_TRAININGS: usize = 8;
/// Trainings that can still be asked after: a few kilobytes each.
pub(crate) const KNOWN_TRAININGS: usize = 100;
/// A text of a form: a caveat on a style's card is a paragraph.
pub(crate) const FORM_TEXT_BYTES: usize = 4096;
/// Styles that may be added: the list of all is one page.
pub(crate) const ADDED_STYLES: usize = 1000;
/// Bytes of all added styles: every process that renders keeps them in memory.
pub(crate) const ADDED_STYLES_BYTES: u64 = 1 << 30;
/// Memory of a process that tries a style: the widest of the usual networks takes 1 GiB for 768×492.
pub(crate) const STYLE_TRIAL_MEMORY_BYTES: u64 = 3 << 30;
/// The artifacts of one frame: three float layers of 12 Mpx, and the pictures.
pub(crate) const ARTIFACT_BYTES: usize = 512 << 20;
/// A worker's message without artifacts: the record of a frame is a few tens of kilobytes.
pub(crate) const WORKER_MESSAGE_BYTES: usize = 8 << 20;
/// A request line and headers: a filter in the query may have a few kilobytes.
pub(crate) const HEADER_BYTES: usize = 64 << 10;

/// An ordinary request: the slowest is a query over a large dataset, which the catalogue ends earlier.
pub(crate) const REQUEST: Duration = Duration::from_secs(30);
/// A request with a large body: 256 MiB at 10 Mbit/s take 215 s.
pub(crate) const UPLOAD: Duration = Duration::from_secs(300);
/// A backup: 100 GB at 100 MB/s take 1000 s.
pub(crate) const BACKUP: Duration = Duration::from_secs(3600);
/// Beyond the wait that a long-poll asks for.
pub(crate) const LONG_POLL_GRACE: Duration = Duration::from_secs(15);
/// The longest wait that a request may ask for: proxies commonly cut at 60 s.
pub(crate) const MAX_WAIT: Duration = Duration::from_secs(60);
/// How long a direct render is waited for unless `Prefer` says otherwise.
pub(crate) const DEFAULT_RENDER_WAIT: Duration = Duration::from_secs(30);
/// How long open requests may go on after a stop.
pub(crate) const DRAIN: Duration = Duration::from_secs(10);
/// How long a worker process may take to hand its leases back: it takes 10 s at most itself.
pub(crate) const WORKER_STOP: Duration = Duration::from_secs(12);

/// How long a request waits for a place before it is shed: long enough for a burst of submissions to pass in group
/// commits, short enough for a client to notice.
pub(crate) const SHED_AFTER: Duration = Duration::from_millis(500);
/// The same of a question to the catalogue, which takes a tenth of a second.
pub(crate) const SHED_QUESTION_AFTER: Duration = Duration::from_secs(2);
/// The same of an upload: its bytes have come already, and those before it are decoded within seconds.
pub(crate) const SHED_UPLOAD_AFTER: Duration = Duration::from_secs(15);
/// The same of what holds its place for long: waiting would not help.
pub(crate) const SHED_AT_ONCE: Duration = Duration::ZERO;
/// Slowest body, in the mean: what an old modem sends.
pub(crate) const BODY_BYTES_PER_S: f64 = 1024.0;
/// Files that the service opens itself: catalogue, packs, children.
const OWN_FILES: usize = 256;

/// A page of a list.
pub(crate) const DEFAULT_PAGE_ROWS: u32 = 100;
/// The largest page: a few hundred kilobytes of JSON.
pub(crate) const MAX_PAGE_ROWS: u32 = 1000;
/// A filter of this length is parsed in microseconds.
pub(crate) const FILTER_BYTES: usize = 4096;
/// Where a set lies: an object's key has at most 1024 bytes, a path 4096.
pub(crate) const SET_URL_BYTES: usize = 4096;
/// An idempotency key: a UUID has 36 characters.
pub(crate) const IDEMPOTENCY_KEY_BYTES: usize = 255;
/// Records that are read at a time while a client reads lines: about a megabyte.
pub(crate) const RECORDS_BATCH: u32 = 100;
/// Rows that are read at a time: about a megabyte, as a page.
pub(crate) const ROWS_BATCH: u32 = 1000;
/// How often events tell of progress at most.
pub(crate) const PROGRESS_PAUSE: Duration = Duration::from_millis(500);
/// How often a sign of life comes where there are no events.
pub(crate) const HEARTBEAT: Duration = Duration::from_secs(15);
/// Side of a thumbnail.
pub(crate) const PREVIEW_PX: usize = 256;

/// The beat of a worker.
pub(crate) const BEAT_MS: u32 = 5_000;

/// How long a worker may hold a frame beyond the time that it may take to render: for its files to arrive on a busy line.
pub(crate) const HAND_IN: Duration = Duration::from_secs(60);

/// A frame's priority when a person waits for it, and of an ordinary job.
pub(crate) const RENDER_PRIORITY: i32 = 100;
/// The priority of an ordinary job.
pub(crate) const JOB_PRIORITY: i32 = 0;

/// Numbers that a test wants smaller.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Of every budget below, what one caller may take: a token, or an address where there are none.
    pub caller_percent: usize,
    /// Public reads at work at the same time; the next is shed with 503. Each holds at most an artifact in memory.
    pub requests: usize,
    /// Questions over many images: fewer than the catalogue has readers, so that plain reads find one.
    pub questions: usize,
    /// Submissions and changes.
    pub submissions: usize,
    /// Long-polls. They hold a few kilobytes each.
    pub waits: usize,
    /// Direct renders and verifications, which wait for frames.
    pub renders: usize,
    /// Events of jobs, for as long as the client listens. Each holds a few events in memory.
    pub streams: usize,
    /// Results and metadata, line by line for as long as the client reads. Each holds a batch of rows in memory.
    pub lines: usize,
    /// Uploads that are decoded at the same time: each by a process that may take 256 MiB.
    pub uploads: usize,
    /// Bodies of requests in memory, all together.
    pub body_bytes: usize,
    /// The same of workers: the artifacts of one frame are 512 MiB at most, usually 2 MiB.
    pub worker_body_bytes: usize,
    /// How long a body may take beside the time that its bytes allow.
    pub body_grace: Duration,
    /// Pictures enhanced or measured at the same time: each by a process that may take 3 GiB.
    pub pictures: usize,
    /// MiB that processes which decode may take together: one of the largest scene or picture, or many usual ones.
    pub decoding_mib: usize,
    /// Processes that render or try a model within a request.
    pub children: usize,
    /// Worker calls at the same time, apart from those that wait for a lease. Their own budget, so that a flood of
    /// public requests cannot let leases expire.
    pub worker_calls: usize,
    /// Artifact messages that are stored at the same time.
    pub worker_uploads: usize,
    /// Beats that wait for a cancelled lease: one for each worker.
    pub worker_beats: usize,
    /// Worker calls that wait for a lease: one for each slot of the fleet.
    pub worker_waits: usize,
    /// Open connections; further ones wait in the listen queue.
    pub connections: usize,
    /// How long the head of a request may take, and how long an idle connection is kept. Longer than the 15 s after
    /// which a worker's connection pool drops an idle connection by itself.
    pub head_read: Duration,
    /// How long a response may lie unread: a client that has stopped reading is cut off.
    pub unread: Duration,
    /// Bytes that are laid aside for deletions on a full disk. Taking a thousand rows away writes up to 20 MiB of log
    /// before any space comes back.
    pub reserve_bytes: u64,
    /// How long stored bytes may be without a row that names them: longer than any lease.
    pub unnamed: Duration,
    /// Decoding and thumbnails at the same time: one for each core, they hold whole pictures.
    pub compute: usize,
}

impl Default for Limits {
    fn default() -> Self {
        let cores = std::thread::available_parallelism().map_or(4, usize::from);
        Self {
            caller_percent: 50,
            requests: 256,
            questions: 6,
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

/// Files and connections that the system lets this process have at the same time.
fn open_files() -> usize {
    const USUAL: usize = 1024;
    let limits = std::fs::read_to_string("/proc/self/limits").unwrap_or_default();
    let line = limits
        .lines()
        .find_map(|line| line.strip_prefix("Max open files"));
    let soft = line.and_then(|line| line.split_whitespace().next()?.parse().ok());
    soft.unwrap_or(USUAL)
}
