//! A tar as WebDataset reads it: `JOB/FRAME.KIND.EXTENSION` and `JOB/FRAME.json`, the record, frame by frame.

use std::fs::File;
use std::io::{BufWriter, Write};

use anyhow::Context;
use cli::exit::Failure;
use serde_json::{Map, Value};
use tar::{Builder, Header};

use crate::commands::dataset::export::format::RECORD;
use crate::commands::dataset::export::input::member::{Member, Pull};

/// Length of a member's header, and alignment of members.
const BLOCK: u64 = 512;

/// Writes a tar; returns the tar and the offsets of each frame, under the column names of sets.
pub(crate) fn write(
    name: &str,
    file: File,
    kinds: &[String],
    pull: &mut Pull<'_>,
) -> Result<Vec<Map<String, Value>>, Failure> {
    let mut builder = Builder::new(BufWriter::new(file));
    let (mut places, mut end) = (Vec::new(), 0);
    loop {
        let members = pull()?;
        if members.is_empty() {
            break;
        }
        for member in members {
            let place = append(&mut builder, &mut end, kinds, &member);
            let mut place = place.with_context(|| format!("cannot write {name}"))?;
            place.insert("tar".to_owned(), name.into());
            places.push(place);
        }
    }
    let finish = || -> std::io::Result<()> {
        let mut file = builder.into_inner()?;
        file.flush()?;
        file.get_ref().sync_all()
    };
    finish().with_context(|| format!("cannot write {name}"))?;
    Ok(places)
}

fn append(
    builder: &mut Builder<BufWriter<File>>,
    end: &mut u64,
    kinds: &[String],
    member: &Member,
) -> std::io::Result<Map<String, Value>> {
    let mut place = Map::new();
    for (kind, file) in kinds.iter().zip(&member.files) {
        let (name, column) = match kind.as_str() {
            RECORD => ("json", RECORD.to_owned()),
            kind => (file.name.as_str(), format!("artifacts.{kind}")),
        };
        let mut header = Header::new_ustar();
        header.set_size(file.bytes.len() as u64);
        header.set_mode(0o644);
        header.set_mtime(0);
        let path = format!(
            "{}/{}",
            member.place.job,
            spec::shard_member(member.place.frame, name)
        );
        builder.append_data(&mut header, path, &file.bytes[..])?;
        let length = file.bytes.len() as u64;
        place.insert(format!("{column}.offset"), (*end + BLOCK).into());
        place.insert(format!("{column}.bytes"), length.into());
        *end += BLOCK + length.next_multiple_of(BLOCK);
    }
    Ok(place)
}
