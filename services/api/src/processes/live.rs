//! Preview frames while a value is dragged: rendered without a job, by up to two processes that keep running.
//!
//! A job of one frame is stored, leased, uploaded, committed and deleted, each step flushed to disk, which took
//! longer than the rendering. A process reads one description per line and replies with a line of JSON and the
//! bytes of the image. If it fails, a job renders the frame and reports the error.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use serde::Deserialize;
use serde_json::json;
use spec::{Frame, Job};

use super::child::Allowance;
use super::lasting::{Bounds, Lasting, Reply};
use crate::http::budget::{Budget, Share};

/// Limits of a frame.
const ALLOWANCE: Allowance = Allowance {
    time: Duration::from_secs(10),
    memory_bytes: 2 << 30,
};
/// Maximum pixels of a preview frame.
const MAX_PIXELS: usize = 1 << 20;
/// Concurrent and waiting frames: two of the dragging user, and two of others.
const PLACES: usize = 4;
/// Maximum length of the line before the image.
const MAX_HEAD_BYTES: u64 = 4096;
/// Maximum length of the image: an uncompressed 16-bit one is shorter.
const MAX_PICTURE_BYTES: u64 = 8 << 20;

const BOUNDS: Bounds = Bounds {
    allowance: ALLOWANCE,
    head_bytes: MAX_HEAD_BYTES,
    body_bytes: MAX_PICTURE_BYTES,
};

/// The processes and their places.
pub(crate) struct Live {
    processes: Vec<Lasting>,
    /// Open frames of each process, including the waiting ones.
    open: Mutex<Vec<usize>>,
    places: Budget,
}

/// Counts a frame of a process until it is dropped.
struct Turn<'a> {
    live: &'a Live,
    index: usize,
}

/// An image that is not stored.
pub(crate) struct Drawn {
    pub(crate) media_type: &'static str,
    pub(crate) bytes: Vec<u8>,
}

/// The line before an image.
#[derive(Deserialize)]
struct Head {
    media_type: String,
}

impl Live {
    /// Maximum processes: a dragging user has two frames in flight.
    const MAX_PROCESSES: usize = 2;

    /// One process for each of the slots, at most two.
    pub(crate) fn new(new_process: impl Fn() -> Lasting, slots: usize, share: Share) -> Self {
        let count = slots.clamp(1, Self::MAX_PROCESSES);
        Self {
            processes: (0..count).map(|_| new_process()).collect(),
            open: Mutex::new(vec![0; count]),
            places: Budget::new("previews", PLACES, share, Duration::ZERO),
        }
    }

    /// Time limit of a frame.
    pub(crate) const LIMIT: Duration = ALLOWANCE.time;

    /// Renders the only frame of a job for a caller. `None`: use a job instead.
    pub(crate) async fn draw(&self, job: &Job, caller: &str) -> Option<Drawn> {
        if !is_small(&job.resolve(0).ok()?) {
            return None;
        }
        let _place = self.places.acquire(caller).await.ok()?;
        let mut request = json!({"spec": job.canonical()}).to_string();
        request.push('\n');
        let turn = self.take_turn();
        let process = &self.processes[turn.index];
        read(process.exchange(request.into_bytes(), BOUNDS).await.ok()?)
    }

    /// A turn at the process with the fewest frames.
    fn take_turn(&self) -> Turn<'_> {
        let mut open = self.lock_open();
        let index = (0..open.len()).min_by_key(|index| open[*index]).unwrap_or(0);
        open[index] += 1;
        Turn { live: self, index }
    }

    fn lock_open(&self) -> MutexGuard<'_, Vec<usize>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Turn<'_> {
    fn drop(&mut self) {
        self.live.lock_open()[self.index] -= 1;
    }
}

/// The image of a reply.
fn read(reply: Reply) -> Option<Drawn> {
    let head: Head = serde_json::from_slice(&reply.head).ok()?;
    let known = ["image/png", "image/jpeg", "image/webp"];
    let media_type = known.into_iter().find(|known| *known == head.media_type)?;
    Some(Drawn {
        media_type,
        bytes: reply.body,
    })
}

/// Whether a frame depends only on its description and is small.
fn is_small(frame: &Frame) -> bool {
    let scene = &frame.scene;
    let pixels = frame.camera.width * frame.camera.height;
    scene.uploaded_id().is_none() && scene.files().is_none() && pixels <= MAX_PIXELS
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};
    use std::sync::Arc;

    use super::*;

    /// The frame of a stand-in for the program, which replies as scripted.
    async fn draw_scripted(script: &str) -> Option<Vec<u8>> {
        let arguments = vec!["-c".into(), PathBuf::from(script)];
        let process = Lasting::with_arguments(Path::new("/bin/sh"), arguments);
        let reply = process.exchange(b"{}\n".to_vec(), BOUNDS).await;
        assert_eq!(process.is_running().await, reply.is_ok());
        reply.ok().and_then(read).map(|drawn| drawn.bytes)
    }

    /// Previews by a shell script in place of the program.
    fn scripted(folder: &Path, script: &str, slots: usize) -> Arc<Live> {
        use std::os::unix::fs::PermissionsExt;

        let program = folder.join("program");
        std::fs::write(&program, format!("#!/bin/sh\n{script}\n")).unwrap();
        std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
        let share = Share { percent: 50 };
        Arc::new(Live::new(
            || Lasting::new(&program, "live", folder, Vec::new()),
            slots,
            share,
        ))
    }

    fn small_job() -> Arc<Job> {
        let text = r#"{"dataset": "x", "scene": {"kind": "procedural", "family": "structure", "seed": 1},
                       "camera": {"width": 32, "height": 20}}"#;
        let library = style::Library::embedded().unwrap();
        let vocabulary = renderer::vocabulary(&library, false);
        Arc::new(Job::parse(text.as_bytes(), &vocabulary).unwrap())
    }

    /// Starts two frames of a caller at the same time.
    fn draw_two(live: &Arc<Live>, job: &Arc<Job>) -> tokio::task::JoinSet<bool> {
        let mut drawing = tokio::task::JoinSet::new();
        for _ in 0..2 {
            let (live, job) = (Arc::clone(live), Arc::clone(job));
            drawing.spawn(async move { live.draw(&job, "a").await.is_some() });
        }
        drawing
    }

    #[tokio::test]
    async fn two_slots_render_two_frames_at_the_same_time() {
        // Each process replies once both have a frame.
        let script = r#"cd "$(dirname "$0")"; read line; : > $$.begun
                        while [ "$(ls *.begun | wc -l)" -lt 2 ]; do sleep 0.01; done
                        printf '{"media_type":"image/png","bytes":3}\nabc'; read line"#;
        let folder = tempfile::tempdir().unwrap();
        let live = scripted(folder.path(), script, 8);
        assert_eq!(live.processes.len(), 2);
        let drawn = draw_two(&live, &small_job()).join_all().await;
        assert_eq!(drawn, [true, true]);
        assert_eq!(*live.lock_open(), [0, 0]);
        assert_eq!(scripted(folder.path(), script, 1).processes.len(), 1);
    }

    #[tokio::test]
    async fn a_caller_with_two_frames_leaves_places_for_others() {
        let folder = tempfile::tempdir().unwrap();
        let live = scripted(folder.path(), "exec sleep 60", 2);
        let job = small_job();
        let _drawing = draw_two(&live, &job);
        tokio::time::sleep(Duration::from_millis(100)).await;
        let wait = Duration::from_millis(300);
        let third = tokio::time::timeout(wait, live.draw(&job, "a")).await;
        assert!(
            matches!(third, Ok(None)),
            "a job renders the third frame of a caller"
        );
        assert!(tokio::time::timeout(wait, live.draw(&job, "b")).await.is_err());
    }

    #[tokio::test]
    async fn malformed_replies_are_rejected() {
        let good = r#"read line; printf '{"media_type":"image/png","bytes":3}\nabc'; read line"#;
        assert_eq!(draw_scripted(good).await.as_deref(), Some(&b"abc"[..]));
        for bad in [
            "read line; exit 1",
            r#"read line; printf '{"error":"no"}\n'; read line"#,
            r#"read line; printf '{"media_type":"text/html","bytes":3}\nabc'; read line"#,
            r#"read line; printf '{"media_type":"image/png","bytes":99999999999}\nabc'; read line"#,
            r#"read line; printf '{"media_type":"image/png","bytes":30}\nabc'"#,
            "read line; tr '\\0' x </dev/zero",
        ] {
            assert_eq!(draw_scripted(bad).await, None, "{bad}");
        }
    }
}
