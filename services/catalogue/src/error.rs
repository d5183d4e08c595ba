//! Errors of the catalogue.

use std::path::PathBuf;

use crate::image_id::ImageId;

/// An error of the catalogue.
#[derive(Debug, Clone, thiserror::Error)]
pub enum CatalogueError {
    /// A filter, order or field list that cannot be read.
    #[error(transparent)]
    Filter(#[from] FilterError),
    /// A cursor of another query or catalogue.
    #[error("the cursor does not belong to this query")]
    Cursor,
    /// An unknown name.
    #[error("no {what} `{name}`")]
    NotFound {
        /// The kind of thing.
        what: &'static str,
        /// Its name.
        name: String,
    },
    /// A change of a job's state that makes no sense.
    #[error("job {id} is {from} and cannot become {to}")]
    Transition {
        /// The job.
        id: String,
        /// Its state.
        from: String,
        /// The requested state.
        to: String,
    },
    /// Something that jobs need is to be deleted.
    #[error("{what} {name} is used by job {job}{}: delete what uses it first", and_others(*others))]
    InUse {
        /// The kind of thing.
        what: &'static str,
        /// Its name.
        name: String,
        /// The oldest job that needs it.
        job: String,
        /// How many more do.
        others: usize,
    },
    /// A change of a job whose images are sealed.
    #[error(
        "job {job} is part of {version}, which is sealed: its images stay as they are; `fathom rm {version}` unseals it"
    )]
    Sealed {
        /// The job.
        job: String,
        /// The sealed version.
        version: String,
    },
    /// A dataset that cannot be sealed now.
    #[error("dataset `{dataset}` {reason}")]
    Unsealable {
        /// The dataset.
        dataset: String,
        /// Why not.
        reason: String,
    },
    /// A change that makes no sense for a job whose frames are rendered elsewhere.
    #[error(
        "job {id} is imported from the set {set}, where its frames are rendered; here it can only be deleted"
    )]
    Imported {
        /// The job.
        id: String,
        /// The location of its set.
        set: String,
    },
    /// An import contradicts an earlier one.
    #[error("frame {frame} of job {job} was imported with other artifacts")]
    Contradicted {
        /// The job.
        job: String,
        /// The frame.
        frame: u64,
    },
    /// The disk is full: the change is not stored, reads continue.
    #[error("no space left for the catalogue: {message}")]
    Full {
        /// The message of SQLite.
        message: String,
    },
    /// The disk refuses reads or writes: the change is not stored.
    #[error("the catalogue cannot be written: {message}")]
    Unwritable {
        /// The message of SQLite.
        message: String,
    },
    /// A query took too long.
    #[error("the query took longer than {seconds} s")]
    Timeout {
        /// The limit.
        seconds: u64,
    },
    /// All readers are at work.
    #[error("the catalogue is too busy; try again")]
    Busy,
    /// Another program holds the catalogue locked.
    #[error(
        "another program holds the catalogue locked, such as a database browser with an unsaved change; close it, or try again"
    )]
    Locked,
    /// The SQLite library is too old.
    #[error("SQLite {version} has a fault that can damage the write-ahead log; {least} or later is needed")]
    SqliteTooOld {
        /// Its version.
        version: String,
        /// The first version without the fault.
        least: &'static str,
    },
    /// The file cannot be opened as a catalogue.
    #[error("{} cannot be opened as a catalogue: {reason}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// Stored data is damaged and not served.
    #[error(
        "{what} in the catalogue is damaged: `fathom scrub` lists all damage, and `--repair` restores images"
    )]
    Damaged {
        /// What, such as `the record of job_…/3`.
        what: String,
        /// The image, if the row belongs to one.
        image: Option<ImageId>,
    },
    /// The catalogue was closed.
    #[error("the catalogue is closed")]
    Closed,
    /// Anything else that the database reported.
    #[error("catalogue: {message}")]
    Failed {
        /// Its message.
        message: String,
    },
}

/// A filter or another parameter of a query that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}{}{}", describe_position(*position), suggest_name(did_you_mean.as_deref()))]
pub struct FilterError {
    /// Characters of the filter before the place; `None` outside of filters.
    pub position: Option<usize>,
    /// The parameter, if it is another one than the filter.
    pub parameter: Option<&'static str>,
    /// The error; it contains the name of the parameter in backticks.
    pub message: String,
    /// The nearest name.
    pub did_you_mean: Option<String>,
}

fn describe_position(position: Option<usize>) -> String {
    position.map_or_else(String::new, |position| format!(" (at position {position})"))
}

fn suggest_name(near: Option<&str>) -> String {
    near.map_or_else(String::new, |name| format!("; did you mean `{name}`?"))
}

fn and_others(count: usize) -> String {
    match count {
        0 => String::new(),
        1 => " and another job".to_owned(),
        count => format!(" and {count} other jobs"),
    }
}

impl CatalogueError {
    pub(crate) fn not_found(what: &'static str, name: &str) -> Self {
        let name = name.to_owned();
        Self::NotFound { what, name }
    }

    pub(crate) fn damaged(what: String) -> Self {
        Self::Damaged { what, image: None }
    }

    /// Damage of a row of an image: `part` is such as `the record`.
    pub(crate) fn damaged_image(part: &str, image: ImageId) -> Self {
        Self::Damaged {
            what: format!("{part} of {}/{}", image.job, image.frame),
            image: Some(image),
        }
    }

    /// An invalid query with a valid filter.
    pub(crate) fn refused(message: String) -> Self {
        FilterError::new(message).into()
    }

    /// An invalid parameter: the message begins after its name.
    pub(crate) fn refused_parameter(parameter: &'static str, message: &str) -> Self {
        FilterError::of_parameter(parameter, message).into()
    }
}

impl From<sqlx::Error> for CatalogueError {
    fn from(error: sqlx::Error) -> Self {
        /// FULL, and the shared-memory file of the log that could not grow.
        const FULL: [i32; 2] = [13, 4874];
        /// CORRUPT and NOTADB.
        const DAMAGED: [i32; 2] = [11, 26];
        /// READONLY, IOERR and CANTOPEN.
        const UNWRITABLE: [i32; 3] = [8, 10, 14];
        /// BUSY.
        const LOCKED: i32 = 5;
        let code = error.as_database_error().and_then(|error| error.code());
        let code: Option<i32> = code.and_then(|code| code.parse().ok());
        let message = error.to_string();
        match (code, &error) {
            (Some(code), _) if FULL.contains(&code) => Self::Full { message },
            (Some(code), _) if code & 0xff == LOCKED => Self::Locked,
            (Some(code), _) if DAMAGED.contains(&(code & 0xff)) => {
                Self::damaged(format!("a page ({message})"))
            }
            (Some(code), _) if UNWRITABLE.contains(&(code & 0xff)) => Self::Unwritable { message },
            // Every value has the type of its column when it is written.
            (_, sqlx::Error::ColumnDecode { .. } | sqlx::Error::Decode(_)) => {
                Self::damaged(format!("a value ({message})"))
            }
            _ => Self::Failed { message },
        }
    }
}

impl From<serde_json::Error> for CatalogueError {
    fn from(error: serde_json::Error) -> Self {
        Self::damaged(format!("a stored record ({error})"))
    }
}

impl FilterError {
    /// An error without a position.
    pub(crate) fn new(message: String) -> Self {
        Self {
            position: None,
            parameter: None,
            message,
            did_you_mean: None,
        }
    }

    /// An error of a parameter: the message begins after its name.
    pub(crate) fn of_parameter(parameter: &'static str, message: &str) -> Self {
        Self {
            parameter: Some(parameter),
            ..Self::new(format!("`{parameter}` {message}"))
        }
    }
}
