//! Trains styles from photos: one at a time, each in a separate process.
//!
//! Trainings exist only in the running service; the resulting style is permanent. The process writes to a temporary
//! folder, so a training that fails, is cancelled or dies with the service leaves nothing behind.

mod order;
mod process;

pub(crate) use process::photo_name;

use std::collections::VecDeque;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use imaging::codec::{announced_pixels, decode_picture};
use serde_json::Value;
use style::{Library, ModelCard};
use tokio::sync::Notify;
use tokio_util::sync::CancellationToken;

use super::new_style::NewStyle;
use crate::clock::ordered_id;
use crate::http::problem::{Problem, Slug};
use crate::limits;
use crate::processes::child::Children;
use crate::processes::turns::Turns;
pub(crate) use order::Order;

/// State of a training.
#[derive(Clone)]
pub(crate) enum Progress {
    /// Waiting or running.
    Open,
    /// Its style is available.
    Done(Box<ModelCard>),
    /// Reason of the failure.
    Failed(String),
    /// Cancelled by a user or by the end of the service.
    Cancelled,
}

/// A training.
pub(crate) struct Training {
    pub(crate) id: String,
    pub(crate) order: Order,
    state: Mutex<Progress>,
    pub(super) ended: Notify,
    pub(super) stop: CancellationToken,
}

impl Training {
    pub(crate) fn state(&self) -> Progress {
        self.state.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The progress reported by the process; `None` while it waits for others.
    pub(crate) fn progress(&self) -> Option<Value> {
        let text = std::fs::read(self.order.folder.path().join(process::PROGRESS)).ok()?;
        serde_json::from_slice(&text).ok()
    }

    /// Time of the last preview, Unix time; `None` without one.
    pub(crate) fn previewed_ms(&self) -> Option<u64> {
        let changed = std::fs::metadata(self.preview_path()).ok()?.modified().ok()?;
        let since = changed.duration_since(std::time::UNIX_EPOCH).ok()?;
        u64::try_from(since.as_millis()).ok()
    }

    /// The current preview, PNG. Only a small valid image is returned.
    pub(crate) fn preview(&self) -> Option<Vec<u8>> {
        let file = std::fs::File::open(self.preview_path()).ok()?;
        let mut bytes = Vec::new();
        file.take(PREVIEW_BYTES + 1).read_to_end(&mut bytes).ok()?;
        is_preview(&bytes).then_some(bytes)
    }

    fn preview_path(&self) -> PathBuf {
        self.order.folder.path().join(process::PREVIEW)
    }

    pub(super) fn is_open(&self) -> bool {
        matches!(self.state(), Progress::Open)
    }

    pub(super) fn end(&self, state: Progress) {
        *self.state.lock().unwrap_or_else(PoisonError::into_inner) = state;
        // The photos and intermediate files are deleted now; the folder itself goes with the training.
        for entry in std::fs::read_dir(self.order.folder.path())
            .into_iter()
            .flatten()
            .flatten()
        {
            let _ = std::fs::remove_file(entry.path()).or_else(|_| std::fs::remove_dir_all(entry.path()));
        }
        self.ended.notify_waiters();
    }
}

/// Maximum bytes of a preview: an uncompressed one is shorter.
const PREVIEW_BYTES: u64 = 512 << 10;
/// Maximum pixels of a preview, which bounds the decoding.
const PREVIEW_PIXELS: usize = 512 * 512;

/// Whether bytes are a valid, small PNG.
fn is_preview(bytes: &[u8]) -> bool {
    const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";
    bytes.len() as u64 <= PREVIEW_BYTES
        && bytes.starts_with(SIGNATURE)
        && (1..=PREVIEW_PIXELS).contains(&announced_pixels(bytes))
        && decode_picture(bytes).is_ok()
}

/// The trainings of a running service, oldest first.
pub(crate) struct Trainings {
    list: Mutex<VecDeque<Arc<Training>>>,
    turns: Turns,
    /// One at a time: each uses half of the cores.
    trainers: Children,
    /// Validate photos before a request returns.
    lookers: Children,
}

impl Trainings {
    pub(crate) fn new(program: &Path, lookers: usize) -> Self {
        Self {
            list: Mutex::default(),
            turns: Turns::default(),
            trainers: Children::new(program, Vec::new(), 1),
            lookers: Children::new(program, Vec::new(), lookers),
        }
    }

    /// The training of an id.
    pub(crate) fn get(&self, id: &str) -> Result<Arc<Training>, Problem> {
        let found = self.list().iter().find(|training| training.id == id).cloned();
        found.ok_or_else(|| Problem::not_found(format!("no training `{id}` since the service started")))
    }

    fn list(&self) -> MutexGuard<'_, VecDeque<Arc<Training>>> {
        self.list.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Rejects unsuitable photos.
    pub(super) async fn validate(&self, order: &Order) -> Result<(), Problem> {
        process::validate(&self.lookers, order).await
    }

    /// Trains a network. The training's view shows an error.
    pub(super) async fn train(&self, order: &Order) -> Result<NewStyle, String> {
        let _turn = self.turns.take(&order.owner).await;
        process::train(&self.trainers, order).await
    }

    /// Accepts an order, if its name is free and there is room. `stop` cancels the training.
    pub(super) fn accept(
        &self,
        order: Order,
        library: &Library,
        stop: CancellationToken,
    ) -> Result<Arc<Training>, Problem> {
        if library.get(&order.name).is_some() {
            let detail = format!("the style `{}` exists; choose another name", order.name);
            return Err(Problem::new(Slug::NameTaken, detail));
        }
        let mut list = self.list();
        if let Some(other) = list
            .iter()
            .find(|other| other.is_open() && other.order.name == order.name)
        {
            let detail = format!("{} already trains a style `{}`", other.id, order.name);
            return Err(Problem::new(Slug::NameTaken, detail));
        }
        check_room(&list, &order.owner)?;
        let training = Arc::new(Training {
            id: format!("trn_{}", ordered_id().simple()),
            order,
            state: Mutex::new(Progress::Open),
            ended: Notify::new(),
            stop,
        });
        list.push_back(Arc::clone(&training));
        while list.len() > limits::KNOWN_TRAININGS && list.front().is_some_and(|oldest| !oldest.is_open()) {
            list.pop_front();
        }
        Ok(training)
    }
}

/// Rejects a training beyond the limit of all callers or of this one.
fn check_room(list: &VecDeque<Arc<Training>>, owner: &str) -> Result<(), Problem> {
    let open = list.iter().filter(|training| training.is_open());
    let (all, own) = open.fold((0, 0), |(all, own), training| {
        (all + 1, own + usize::from(training.order.owner == owner))
    });
    if own >= limits::OPEN_TRAININGS_OF_CALLER {
        let detail =
            format!("{own} of your trainings are open, the limit of a caller; cancel one or retry later");
        return Err(Problem::overloaded(detail));
    }
    if all >= limits::OPEN_TRAININGS {
        let detail = format!("{all} trainings are waiting, the limit; retry later");
        return Err(Problem::overloaded(detail));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use imaging::Rgb8;
    use imaging::codec::encode_png;

    use super::*;

    fn training(owner: &str) -> Arc<Training> {
        Arc::new(Training {
            id: "trn_1".to_owned(),
            order: Order {
                owner: owner.to_owned(),
                name: "harbour".to_owned(),
                seed: 1,
                steps: 1,
                range: false,
                licence: String::new(),
                source: String::new(),
                photos: 1,
                folder: tempfile::tempdir().unwrap(),
            },
            state: Mutex::new(Progress::Open),
            ended: Notify::new(),
            stop: CancellationToken::new(),
        })
    }

    #[test]
    fn a_caller_may_have_half_of_the_open_trainings() {
        let mut list: VecDeque<_> = (0..4).map(|_| training("a")).collect();
        let refused = check_room(&list, "a").map_err(|problem| problem.to_string());
        assert!(refused.is_err_and(|text| text.contains("4 of your trainings")));
        assert!(check_room(&list, "b").is_ok());
        list.extend((0..4).map(|_| training("b")));
        assert!(check_room(&list, "c").is_err());
        list[0].end(Progress::Cancelled);
        assert!(check_room(&list, "c").is_ok() && check_room(&list, "a").is_ok());
    }

    #[test]
    fn only_a_small_png_is_a_preview() {
        let png = |side: usize| {
            let picture = Rgb8::from_fn(side, side, |x, y| [x as u8, y as u8, 7]);
            encode_png(&picture.into()).unwrap_or_default()
        };
        let good = png(64);
        assert!(is_preview(&good));
        assert!(!is_preview(&png(600)), "too many pixels");
        assert!(!is_preview(&good[..good.len() / 2]), "cut off");
        assert!(!is_preview(b"<svg onload='alert(1)'/>"), "no PNG");
        assert!(!is_preview(&[]), "nothing");
        let long = [good.as_slice(), &vec![0; PREVIEW_BYTES as usize]].concat();
        assert!(!is_preview(&long), "too many bytes");
    }
}
