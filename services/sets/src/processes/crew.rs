//! Renders frames in child processes: in order, with a poisoned frame kept from its neighbors.
//!
//! One child renders on all slots. When it dies or exceeds a limit, the frames that it was rendering are tried one by one,
//! each alone in a new child; one that fails three times alone has failed, with the last reason.

use std::ops::Range;

use crate::error::SetError;
use crate::processes::child::{Child, News, Recipe};
use crate::processes::message::Message;
use crate::processes::open::{Finished, Open};

/// How often a frame is tried alone.
const TRIES_ALONE: u32 = 3;
/// Children that end before they begin a frame, one after the other.
const MOST_DEATHS_AT_START: u32 = 3;
/// Frames queued for each slot of a child, so that no slot waits for the supervisor.
const QUEUED_PER_SLOT: usize = 1;

/// The processes that render a job.
pub struct Crew {
    recipe: Recipe,
    job: String,
    child: Option<Child>,
}

impl Crew {
    /// A crew without children; the first frame starts one.
    #[must_use]
    pub fn new(recipe: Recipe, job: &spec::Job) -> Self {
        Self {
            recipe,
            job: job.canonical().to_owned(),
            child: None,
        }
    }

    /// Renders frames and passes them on in order. `check` is called several times a second and can stop the work.
    pub(crate) fn render(
        &mut self,
        frames: Range<u64>,
        check: &dyn Fn() -> Result<(), SetError>,
        mut take: impl FnMut(u64, Finished) -> Result<(), SetError>,
    ) -> Result<(), SetError> {
        let result = self.work(frames, check, &mut take);
        if result.is_err() {
            // Frames in its slots are of no use to the next shard.
            self.child = None;
        }
        result
    }

    fn work(
        &mut self,
        frames: Range<u64>,
        check: &dyn Fn() -> Result<(), SetError>,
        take: &mut impl FnMut(u64, Finished) -> Result<(), SetError>,
    ) -> Result<(), SetError> {
        let mut open = Open::new(frames, self.recipe.slots);
        let mut deaths_at_start = 0;
        while !open.is_done() {
            check()?;
            let mut child = match self.child.take() {
                Some(child) => child,
                None => Child::start(&self.recipe, self.recipe.slots, &self.job)?,
            };
            while child.load() < self.recipe.slots * (1 + QUEUED_PER_SLOT)
                && let Some(frame) = open.next()
            {
                child.give(frame);
            }
            match child.next() {
                News::Quiet | News::Message(Message::Begun { .. }) => self.child = Some(child),
                News::Message(Message::Failed {
                    frame,
                    error,
                    retryable: true,
                }) => {
                    self.child = Some(child);
                    open.insert(frame, self.alone(frame, &error, check)?);
                }
                News::Message(message) => {
                    self.child = Some(child);
                    open.finish(message);
                }
                News::Gone(reason) => {
                    let (begun, waiting) = child.split();
                    deaths_at_start = if begun.is_empty() { deaths_at_start + 1 } else { 0 };
                    if deaths_at_start == MOST_DEATHS_AT_START {
                        return Err(never_began(&reason));
                    }
                    open.take_back(&waiting);
                    drop(child);
                    for frame in begun {
                        open.insert(frame, self.alone(frame, &reason, check)?);
                    }
                }
            }
            open.hand_on(take)?;
        }
        Ok(())
    }

    /// Renders a frame in a separate child, with repeated attempts.
    fn alone(
        &self,
        frame: u64,
        reason: &str,
        check: &dyn Fn() -> Result<(), SetError>,
    ) -> Result<Finished, SetError> {
        let mut reason = reason.to_owned();
        let mut tries = 0;
        let mut deaths_at_start = 0;
        while tries < TRIES_ALONE {
            match self.try_alone(frame, check)? {
                Try::Finished(finished) => return Ok(finished),
                Try::Died(why) => (tries, deaths_at_start, reason) = (tries + 1, 0, why),
                Try::NeverBegan(why) => {
                    deaths_at_start += 1;
                    if deaths_at_start == MOST_DEATHS_AT_START {
                        return Err(never_began(&why));
                    }
                }
            }
        }
        Ok(Finished::Failed(format!("{reason}; {TRIES_ALONE} times alone")))
    }

    fn try_alone(&self, frame: u64, check: &dyn Fn() -> Result<(), SetError>) -> Result<Try, SetError> {
        let mut child = Child::start(&self.recipe, 1, &self.job)?;
        child.give(frame);
        loop {
            check()?;
            match child.next() {
                News::Quiet | News::Message(Message::Begun { .. }) => {}
                News::Message(Message::Failed {
                    error,
                    retryable: true,
                    ..
                }) => return Ok(Try::Died(error)),
                News::Message(message) => return Ok(Try::Finished(Finished::from(message))),
                News::Gone(reason) if child.split().0.is_empty() => return Ok(Try::NeverBegan(reason)),
                News::Gone(reason) => return Ok(Try::Died(reason)),
            }
        }
    }
}

/// The end of a child that had one frame.
enum Try {
    Finished(Finished),
    Died(String),
    NeverBegan(String),
}

/// No frame is at fault: the next shard would end the same way.
fn never_began(reason: &str) -> SetError {
    SetError::Machine(format!("a process that was to render began no frame: {reason}"))
}

#[cfg(test)]
mod tests {
    use std::ffi::OsString;
    use std::path::Path;
    use std::time::Duration;

    use super::*;
    use crate::processes::child::Recipe;

    /// Failure: children killed before they begin a frame end the run or count as tries of the frame, or a program that
    /// never begins is started forever.
    #[test]
    fn a_child_that_dies_at_its_start_costs_no_frame() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        // The second to the fourth child render alone; two of them die at their start.
        let ends = crew(
            folder.path(),
            r#"1) begin ;; 2 | 3) ;; 4) begin ;; 5) begin; echo '{"is":"failed","frame":0,"error":"told","retryable":false}'; cat ;; esac"#,
        );
        assert_eq!(ends.expect("an end"), [Finished::Failed("told".to_owned())]);
        let folder = tempfile::tempdir().expect("a temporary folder");
        let ends = crew(folder.path(), "1) begin ;; esac").expect_err("no child begins after the first");
        assert!(ends.to_string().contains("began no frame"), "{ends}");
        assert_eq!(starts(folder.path()), 1 + MOST_DEATHS_AT_START as usize);
    }

    /// Renders one frame with a shell script as the child; `cases` are chosen by the number of the start.
    fn crew(folder: &Path, cases: &str) -> Result<Vec<Finished>, SetError> {
        let script = format!(
            "cd '{}' && echo >> starts && begin() {{ echo '{{\"is\":\"begun\",\"frame\":0}}'; }}; case $(wc -l < starts) in {cases}",
            folder.display()
        );
        let recipe = Recipe {
            program: "/bin/sh".into(),
            arguments: ["-c", &script].map(OsString::from).to_vec(),
            slots: 1,
            frame_limit: Duration::from_secs(60),
            memory_limit_bytes: u64::MAX,
        };
        let mut crew = Crew {
            recipe,
            job: "{}".to_owned(),
            child: None,
        };
        let mut ends = Vec::new();
        crew.render(0..1, &|| Ok(()), |_, finished| {
            ends.push(finished);
            Ok(())
        })?;
        Ok(ends)
    }

    fn starts(folder: &Path) -> usize {
        let starts = std::fs::read_to_string(folder.join("starts")).expect("a started child");
        starts.lines().count()
    }
}
