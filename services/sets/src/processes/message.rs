//! Messages of a child to its supervisor over standard output. The supervisor writes the job's canonical text and then one frame
//! number per line; the child ends with that stream.

use std::io::{self, BufRead, Read, Write};

use serde::{Deserialize, Serialize};

/// Longest line and largest file that a supervisor accepts from a child.
const MOST_BYTES: u64 = 1 << 30;

/// A file of a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ParcelFile {
    /// Artifact kind, such as `rgb`.
    pub kind: String,
    /// File name extension without the dot.
    pub extension: String,
    /// The file.
    pub bytes: Vec<u8>,
}

/// A message of a child.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Message {
    /// It begins to render this frame.
    Begun {
        /// Position in the job.
        frame: u64,
    },
    /// A frame has an image.
    Image {
        /// Position in the job.
        frame: u64,
        /// Its record, as JSON.
        record: Vec<u8>,
        /// Its files, in the order of the record.
        files: Vec<ParcelFile>,
    },
    /// A frame has none.
    Failed {
        /// Position in the job.
        frame: u64,
        /// Why.
        error: String,
        /// Whether another try may succeed.
        retryable: bool,
    },
}

/// The line before the bytes.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "is")]
enum Head {
    Begun {
        frame: u64,
    },
    Image {
        frame: u64,
        record_bytes: u64,
        files: Vec<FileHead>,
    },
    Failed {
        frame: u64,
        error: String,
        retryable: bool,
    },
}

#[derive(Serialize, Deserialize)]
struct FileHead {
    kind: String,
    extension: String,
    bytes: u64,
}

impl Message {
    /// Writes a message: a line of JSON, then the bytes that it announces.
    ///
    /// # Errors
    /// The supervisor is gone.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let head = match self {
            Self::Begun { frame } => Head::Begun { frame: *frame },
            Self::Failed {
                frame,
                error,
                retryable,
            } => Head::Failed {
                frame: *frame,
                error: error.clone(),
                retryable: *retryable,
            },
            Self::Image { frame, record, files } => Head::Image {
                frame: *frame,
                record_bytes: record.len() as u64,
                files: files.iter().map(FileHead::new).collect(),
            },
        };
        let mut line = serde_json::to_vec(&head)?;
        line.push(b'\n');
        out.write_all(&line)?;
        if let Self::Image { record, files, .. } = self {
            out.write_all(record)?;
            files.iter().try_for_each(|file| out.write_all(&file.bytes))?;
        }
        out.flush()
    }

    /// Reads the next message; `None` at the end of the stream, also within a message.
    pub(crate) fn read(from: &mut impl BufRead) -> Option<Self> {
        let mut line = Vec::new();
        from.by_ref().take(MOST_BYTES).read_until(b'\n', &mut line).ok()?;
        let mut bytes = |length: u64| {
            let mut bytes = Vec::with_capacity(usize::try_from(length.min(MOST_BYTES)).ok()?);
            from.by_ref().take(length).read_to_end(&mut bytes).ok()?;
            (bytes.len() as u64 == length).then_some(bytes)
        };
        Some(match serde_json::from_slice(&line).ok()? {
            Head::Begun { frame } => Self::Begun { frame },
            Head::Failed {
                frame,
                error,
                retryable,
            } => Self::Failed {
                frame,
                error,
                retryable,
            },
            Head::Image {
                frame,
                record_bytes,
                files,
            } => Self::Image {
                frame,
                record: bytes(record_bytes)?,
                files: files
                    .into_iter()
                    .map(|head| {
                        Some(ParcelFile {
                            bytes: bytes(head.bytes)?,
                            kind: head.kind,
                            extension: head.extension,
                        })
                    })
                    .collect::<Option<_>>()?,
            },
        })
    }
}

impl FileHead {
    fn new(file: &ParcelFile) -> Self {
        Self {
            kind: file.kind.clone(),
            extension: file.extension.clone(),
            bytes: file.bytes.len() as u64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_arrive_as_they_were_sent_and_a_cut_one_not_at_all() {
        let file = |kind: &str, bytes: &[u8]| ParcelFile {
            kind: kind.to_owned(),
            extension: "png".to_owned(),
            bytes: bytes.to_vec(),
        };
        let sent = [
            Message::Begun { frame: 7 },
            Message::Image {
                frame: 7,
                record: b"{\n}".to_vec(),
                files: vec![file("rgb", b"\n\n{"), file("range", b"")],
            },
            Message::Failed {
                frame: 8,
                error: "no\nwater".to_owned(),
                retryable: true,
            },
        ];
        let mut stream = Vec::new();
        sent.iter()
            .for_each(|message| message.write(&mut stream).unwrap());
        let mut from = stream.as_slice();
        for message in &sent {
            assert_eq!(Message::read(&mut from).as_ref(), Some(message));
        }
        assert_eq!(Message::read(&mut from), None);
        let mut short = Vec::new();
        sent[1].write(&mut short).unwrap();
        short.pop();
        assert_eq!(Message::read(&mut short.as_slice()), None);
    }
}
