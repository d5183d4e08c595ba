//! Preview frames while a value is dragged: rendered without a job, by a process that keeps running.
//!
//! A job of one frame is stored, leased, uploaded, committed and deleted, each step flushed to disk, which took
//! longer than the rendering. The process reads one description per line and replies with a line of JSON and the
//! bytes of the image. If it fails, a job renders the frame and reports the error.

use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::Arc;
use std::time::Duration;

use serde::Deserialize;
use serde_json::json;
use spec::{Frame, Job};
use tokio::io::{AsyncBufReadExt, AsyncReadExt, AsyncWriteExt, BufReader};
use tokio::process::{Child, ChildStdin, ChildStdout, Command};
use tokio::sync::{Mutex, OwnedMutexGuard};

use super::child::{Allowance, exceeded};
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
/// The process ends after this time without requests.
const IDLE: Duration = Duration::from_secs(60);
/// Maximum length of the line before the image.
const MAX_HEAD_BYTES: u64 = 4096;
/// Maximum length of the image: an uncompressed 16-bit one is shorter.
const MAX_PICTURE_BYTES: u64 = 8 << 20;

/// The process, started with the first frame.
pub(crate) struct Live {
    program: PathBuf,
    arguments: Vec<PathBuf>,
    places: Budget,
    running: Arc<Mutex<Option<Running>>>,
}

/// An image that is not stored.
pub(crate) struct Drawn {
    pub(crate) media_type: &'static str,
    pub(crate) bytes: Vec<u8>,
}

struct Running {
    child: Child,
    requests: ChildStdin,
    replies: BufReader<ChildStdout>,
    /// Frames so far.
    drawn: u64,
}

/// The line before an image.
#[derive(Deserialize)]
struct Head {
    media_type: String,
    bytes: u64,
}

impl Live {
    /// A process of this program on this data folder, with options for styles.
    pub(crate) fn new(
        program: &Path,
        data: &Path,
        options: Vec<(&'static str, PathBuf)>,
        share: Share,
    ) -> Self {
        let given = options
            .into_iter()
            .flat_map(|(option, path)| [PathBuf::from(option), path]);
        Self {
            program: program.to_owned(),
            arguments: ["child".into(), "live".into(), "--data".into(), data.to_owned()]
                .into_iter()
                .chain(given)
                .collect(),
            places: Budget::new("previews", PLACES, share, Duration::ZERO),
            running: Arc::default(),
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
        let held = Arc::clone(&self.running).lock_owned().await;
        let (program, arguments) = (self.program.clone(), self.arguments.clone());
        // Completes even if the caller is dropped: otherwise the next reply would belong to this frame.
        let drawing = tokio::spawn(async move { draw(held, &program, &arguments, request.as_bytes()).await });
        let (drawn, number) = drawing.await.ok().flatten()?;
        self.end_if_idle(number);
        Some(drawn)
    }

    fn end_if_idle(&self, number: u64) {
        let running = Arc::clone(&self.running);
        tokio::spawn(async move {
            tokio::time::sleep(IDLE).await;
            let mut running = running.lock().await;
            if running.as_ref().is_some_and(|running| running.drawn == number) {
                *running = None;
            }
        });
    }
}

/// Whether a frame depends only on its description and is small.
fn is_small(frame: &Frame) -> bool {
    let scene = &frame.scene;
    let pixels = frame.camera.width * frame.camera.height;
    scene.uploaded_id().is_none() && scene.files().is_none() && pixels <= MAX_PIXELS
}

/// Renders a frame, and keeps the process after a valid reply.
async fn draw(
    mut held: OwnedMutexGuard<Option<Running>>,
    program: &Path,
    arguments: &[PathBuf],
    request: &[u8],
) -> Option<(Drawn, u64)> {
    let mut running = match held.take() {
        Some(running) => running,
        None => start(program, arguments)?,
    };
    let id = running.child.id();
    let drawn = tokio::select! {
        drawn = running.exchange(request) => drawn,
        reason = exceeded(id, ALLOWANCE) => {
            tracing::warn!(reason, "a live frame failed");
            None
        }
    }?;
    running.drawn += 1;
    let number = running.drawn;
    *held = Some(running);
    Some((drawn, number))
}

fn start(program: &Path, arguments: &[PathBuf]) -> Option<Running> {
    let mut child = Command::new(program)
        .args(arguments)
        .env_remove("FATHOM_TOKEN")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .kill_on_drop(true)
        .spawn()
        .inspect_err(|error| tracing::error!(%error, "cannot start the process of live frames"))
        .ok()?;
    let (requests, replies) = child.stdin.take().zip(child.stdout.take())?;
    Some(Running {
        child,
        requests,
        replies: BufReader::new(replies),
        drawn: 0,
    })
}

impl Running {
    async fn exchange(&mut self, request: &[u8]) -> Option<Drawn> {
        self.requests.write_all(request).await.ok()?;
        let mut head = Vec::new();
        let mut line = (&mut self.replies).take(MAX_HEAD_BYTES);
        line.read_until(b'\n', &mut head).await.ok()?;
        let head: Head = serde_json::from_slice(&head).ok()?;
        let known = ["image/png", "image/jpeg", "image/webp"];
        let media_type = known.into_iter().find(|known| *known == head.media_type)?;
        let length = (head.bytes <= MAX_PICTURE_BYTES).then_some(head.bytes as usize)?;
        let mut bytes = vec![0; length];
        self.replies.read_exact(&mut bytes).await.ok()?;
        Some(Drawn { media_type, bytes })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stand-in for the program, which replies as scripted.
    async fn drawn(script: &str) -> Option<Vec<u8>> {
        let arguments = ["-c".into(), PathBuf::from(script)];
        let held: Arc<Mutex<Option<Running>>> = Arc::default();
        let first = draw(
            Arc::clone(&held).lock_owned().await,
            Path::new("/bin/sh"),
            &arguments,
            b"{}\n",
        )
        .await;
        let is_kept = held.lock().await.is_some();
        assert_eq!(is_kept, first.is_some());
        first.map(|(drawn, _)| drawn.bytes)
    }

    #[tokio::test]
    async fn a_caller_with_two_frames_leaves_places_for_others() {
        use std::os::unix::fs::PermissionsExt;

        let folder = tempfile::tempdir().unwrap();
        let program = folder.path().join("program");
        std::fs::write(&program, "#!/bin/sh\nexec sleep 60\n").unwrap();
        std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
        let share = Share { percent: 50 };
        let live = Arc::new(Live::new(&program, folder.path(), Vec::new(), share));
        let text = r#"{"dataset": "x", "scene": {"kind": "procedural", "family": "structure", "seed": 1},
                       "camera": {"width": 32, "height": 20}}"#;
        let library = style::Library::embedded().unwrap();
        let vocabulary = renderer::vocabulary(&library, false);
        let job = Arc::new(Job::parse(text.as_bytes(), &vocabulary).unwrap());
        let mut drawing = tokio::task::JoinSet::new();
        for _ in 0..2 {
            let (live, job) = (Arc::clone(&live), Arc::clone(&job));
            drawing.spawn(async move { live.draw(&job, "a").await.is_some() });
        }
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
        assert_eq!(drawn(good).await.as_deref(), Some(&b"abc"[..]));
        for bad in [
            "read line; exit 1",
            r#"read line; printf '{"error":"no"}\n'; read line"#,
            r#"read line; printf '{"media_type":"text/html","bytes":3}\nabc'; read line"#,
            r#"read line; printf '{"media_type":"image/png","bytes":99999999999}\nabc'; read line"#,
            r#"read line; printf '{"media_type":"image/png","bytes":30}\nabc'"#,
            "read line; tr '\\0' x </dev/zero",
        ] {
            assert_eq!(drawn(bad).await, None, "{bad}");
        }
    }
}
