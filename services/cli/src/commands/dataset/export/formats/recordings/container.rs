//! The MCAP container (version 0): schemas, channels and messages in chunks, with the indexes that players seek by.
//!
//! Chunks are not compressed: pictures already are. Written here because the crate `mcap` brings 14 packages that nothing else uses.

use std::collections::BTreeMap;
use std::io::{self, Write};

const MAGIC: &[u8] = b"\x89MCAP0\r\n";
const LIBRARY: &str = concat!("fathom ", env!("CARGO_PKG_VERSION"));
/// Bytes after which a chunk ends.
const CHUNK_BYTES: usize = 4 << 20;

/// Codes of records.
mod op {
    pub(super) const HEADER: u8 = 0x01;
    pub(super) const FOOTER: u8 = 0x02;
    pub(super) const SCHEMA: u8 = 0x03;
    pub(super) const CHANNEL: u8 = 0x04;
    pub(super) const MESSAGE: u8 = 0x05;
    pub(super) const CHUNK: u8 = 0x06;
    pub(super) const MESSAGE_INDEX: u8 = 0x07;
    pub(super) const CHUNK_INDEX: u8 = 0x08;
    pub(super) const STATISTICS: u8 = 0x0b;
    pub(super) const DATA_END: u8 = 0x0f;
}

/// A file that is being written. Schemas and channels are declared first.
pub(super) struct Container<W> {
    out: W,
    position: u64,
    /// Schemas and channels, which the summary repeats.
    declarations: Vec<u8>,
    schemas: u16,
    /// Messages of each channel.
    messages: BTreeMap<u16, u64>,
    chunk: Chunk,
    chunk_indexes: Vec<u8>,
    chunks: u32,
    /// First and last time.
    span: Option<(u64, u64)>,
}

#[derive(Default)]
struct Chunk {
    records: Vec<u8>,
    /// Time and offset of the messages of each channel.
    index: BTreeMap<u16, Vec<u8>>,
    span: Option<(u64, u64)>,
}

/// The content of a record.
#[derive(Default)]
struct Content(Vec<u8>);

impl Content {
    fn u16(mut self, value: u16) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    fn u32(mut self, value: u32) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    fn u64(mut self, value: u64) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    /// Bytes after their length.
    fn bytes(mut self, bytes: &[u8]) -> Self {
        // Chunks, schemas and indexes are far below 4 GiB.
        self.0
            .extend(u32::try_from(bytes.len()).unwrap_or(u32::MAX).to_le_bytes());
        self.0.extend(bytes);
        self
    }

    fn text(self, text: &str) -> Self {
        self.bytes(text.as_bytes())
    }

    fn record(self, code: u8) -> Vec<u8> {
        let head = [&[code][..], &(self.0.len() as u64).to_le_bytes()].concat();
        [head, self.0].concat()
    }
}

fn extend_span(span: &mut Option<(u64, u64)>, time: u64) {
    let (first, last) = span.unwrap_or((time, time));
    *span = Some((first.min(time), last.max(time)));
}

impl<W: Write> Container<W> {
    /// Begins a file of ROS 2 messages.
    pub(super) fn begin(mut out: W) -> io::Result<Self> {
        let header = Content::default().text("ros2").text(LIBRARY).record(op::HEADER);
        out.write_all(MAGIC)?;
        out.write_all(&header)?;
        Ok(Self {
            out,
            position: (MAGIC.len() + header.len()) as u64,
            declarations: Vec::new(),
            schemas: 0,
            messages: BTreeMap::new(),
            chunk: Chunk::default(),
            chunk_indexes: Vec::new(),
            chunks: 0,
            span: None,
        })
    }

    /// Declares a type of messages; returns its number.
    pub(super) fn declare_schema(&mut self, name: &str, definition: &str) -> u16 {
        self.schemas += 1;
        let content = Content::default().u16(self.schemas).text(name).text("ros2msg");
        self.declare(&content.text(definition).record(op::SCHEMA));
        self.schemas
    }

    /// Declares a topic; returns its number.
    pub(super) fn declare_channel(&mut self, schema: u16, topic: &str) -> u16 {
        let id = self.messages.len() as u16;
        self.messages.insert(id, 0);
        let content = Content::default().u16(id).u16(schema).text(topic).text("cdr");
        self.declare(&content.bytes(&[]).record(op::CHANNEL));
        id
    }

    /// Adds a declaration to the first chunk, as readers of chunks require, and to the summary.
    fn declare(&mut self, record: &[u8]) {
        self.declarations.extend(record);
        self.chunk.records.extend(record);
    }

    /// Adds a message of a channel.
    pub(super) fn add_message(&mut self, channel: u16, stamp_ns: u64, data: &[u8]) -> io::Result<()> {
        let count = self.messages.entry(channel).or_default();
        let sequence = *count as u32;
        *count += 1;
        let offset = self.chunk.records.len() as u64;
        let mut content = Content::default()
            .u16(channel)
            .u32(sequence)
            .u64(stamp_ns)
            .u64(stamp_ns);
        content.0.extend(data);
        self.chunk.records.extend(content.record(op::MESSAGE));
        let entry = Content::default().u64(stamp_ns).u64(offset);
        self.chunk.index.entry(channel).or_default().extend(entry.0);
        extend_span(&mut self.chunk.span, stamp_ns);
        extend_span(&mut self.span, stamp_ns);
        match self.chunk.records.len() < CHUNK_BYTES {
            true => Ok(()),
            false => self.end_chunk(),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.position += bytes.len() as u64;
        self.out.write_all(bytes)
    }

    fn end_chunk(&mut self) -> io::Result<()> {
        let Chunk { records, index, span } = std::mem::take(&mut self.chunk);
        let (first, last) = span.unwrap_or_default();
        let (begin, size) = (self.position, records.len() as u64);
        let head = Content::default().u64(first).u64(last).u64(size);
        let mut chunk = head.u32(crc32fast::hash(&records)).text("").u64(size);
        chunk.0.extend(records);
        self.write(&chunk.record(op::CHUNK))?;
        let length = self.position - begin;
        let mut offsets = Content::default();
        for (channel, entries) in &index {
            offsets = offsets.u16(*channel).u64(self.position);
            let record = Content::default().u16(*channel).bytes(entries);
            self.write(&record.record(op::MESSAGE_INDEX))?;
        }
        let indexes = self.position - begin - length;
        let entry = Content::default().u64(first).u64(last).u64(begin).u64(length);
        let entry = entry.bytes(&offsets.0).u64(indexes).text("").u64(size).u64(size);
        self.chunk_indexes.extend(entry.record(op::CHUNK_INDEX));
        self.chunks += 1;
        Ok(())
    }

    /// Writes the last chunk and the summary.
    pub(super) fn finish(mut self) -> io::Result<W> {
        if !self.chunk.records.is_empty() {
            self.end_chunk()?;
        }
        self.write(&Content::default().u32(0).record(op::DATA_END))?;
        let begin = self.position;
        let summary = [
            std::mem::take(&mut self.declarations),
            self.describe_messages(),
            std::mem::take(&mut self.chunk_indexes),
        ]
        .concat();
        self.write(&summary)?;
        // The checksum covers the summary and the footer up to itself.
        let footer = Content::default().u64(begin).u64(0);
        let length = footer.0.len() as u64 + size_of::<u32>() as u64;
        let mut covered = crc32fast::Hasher::new();
        covered.update(&summary);
        covered.update(&[op::FOOTER]);
        covered.update(&length.to_le_bytes());
        covered.update(&footer.0);
        let footer = footer.u32(covered.finalize()).record(op::FOOTER);
        self.write(&footer)?;
        self.write(MAGIC)?;
        self.out.flush()?;
        Ok(self.out)
    }

    /// The statistics record.
    fn describe_messages(&self) -> Vec<u8> {
        let (first, last) = self.span.unwrap_or_default();
        let counts = self
            .messages
            .iter()
            .fold(Content::default(), |counts, (channel, count)| {
                counts.u16(*channel).u64(*count)
            });
        // No attachments and no metadata.
        let content = Content::default()
            .u64(self.messages.values().sum())
            .u16(self.schemas)
            .u32(self.messages.len() as u32)
            .u32(0)
            .u32(0)
            .u32(self.chunks);
        content
            .u64(first)
            .u64(last)
            .bytes(&counts.0)
            .record(op::STATISTICS)
    }
}
