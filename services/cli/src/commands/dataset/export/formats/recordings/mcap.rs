//! A file of ROS 2 messages for each sequence, as Foxglove and `ros2 bag` read it.

use std::fs::File;
use std::io::{self, BufWriter, Write};

use anyhow::Context;
use cli::exit::Failure;
use imaging::codec::decode_mask;
use serde_json::{Map, Value};

use crate::commands::dataset::export::format::RECORD;
use crate::commands::dataset::export::formats::recordings::container::Container;
use crate::commands::dataset::export::formats::recordings::messages::{
    Header, camera_info, compressed_image, depth_image, mask_image, pose, transforms,
};
use crate::commands::dataset::export::formats::recordings::topics::Topics;
use crate::commands::dataset::export::formats::sequences::depth::read_z_depth;
use crate::commands::dataset::export::formats::view::View;
use crate::commands::dataset::export::input::archive::Unpacked;
use crate::commands::dataset::export::input::frame::untrusted;
use crate::commands::dataset::export::input::member::{Member, Pull};
use crate::commands::dataset::export::input::times::STAMP;
use crate::commands::dataset::export::role::Role;

/// Coordinate frames of the cameras: right, down, ahead.
const CAMERA: &str = "camera_optical_frame";
const CAMERA_RIGHT: &str = "camera_right_optical_frame";
/// Column of the file of a frame.
const COLUMN: &str = "mcap";

/// Writes a sequence; returns the place of each frame.
pub(crate) fn write(
    name: &str,
    file: File,
    kinds: &[String],
    pull: &mut Pull<'_>,
) -> Result<Vec<Map<String, Value>>, Failure> {
    let unwritable = || format!("cannot write {name}");
    let mut container = Container::begin(BufWriter::new(file)).with_context(unwritable)?;
    let topics = Topics::declare(&mut container, kinds).with_context(unwritable)?;
    let mut places = Vec::new();
    loop {
        let members = pull()?;
        if members.is_empty() {
            break;
        }
        for member in members {
            let messages = describe_frame(&topics, kinds, &member)?;
            for (channel, data) in messages.messages {
                let added = container.add_message(channel, messages.stamp_ns, &data);
                added.with_context(unwritable)?;
            }
            places.push(Map::from_iter([(COLUMN.to_owned(), name.into())]));
        }
    }
    finish(container).with_context(unwritable)?;
    Ok(places)
}

fn finish(container: Container<BufWriter<File>>) -> io::Result<()> {
    let mut file = container.finish()?;
    file.flush()?;
    file.get_ref().sync_all()
}

/// The messages of a frame with their channels.
struct FrameMessages {
    stamp_ns: u64,
    messages: Vec<(u16, Vec<u8>)>,
}

fn describe_frame(topics: &Topics, kinds: &[String], member: &Member) -> Result<FrameMessages, Failure> {
    let image = format!("{}/{}", member.place.job, member.place.frame);
    let stamp = member.values.get(STAMP).and_then(Value::as_u64);
    let stamp_ns = stamp.ok_or_else(|| untrusted(format!("{image} without a time")))?;
    let record = kinds.iter().zip(&member.files).find(|(kind, _)| *kind == RECORD);
    let record = record.map_or(&[][..], |(_, file)| &file.bytes);
    let view = View::parse(&format!("the record of {image}"), record)?;
    let header = Header::new(stamp_ns, CAMERA)?;
    let mut messages = Vec::new();
    for ((role, channel), (kind, file)) in topics.kinds.iter().zip(kinds.iter().zip(&member.files)) {
        let Some(channel) = channel else {
            continue;
        };
        let message = describe_file(*role, header, file, &view);
        let message = message.map_err(|why| untrusted(format!("`{kind}` of {image}: {why}")))?;
        messages.push((*channel, message));
    }
    messages.push((topics.camera_info, camera_info(header, &view, 0.0)));
    if let Some(channel) = topics.right_info {
        let baseline_m = view.baseline_m.unwrap_or_default();
        let info = camera_info(header.in_frame(CAMERA_RIGHT), &view, baseline_m);
        messages.push((channel, info));
    }
    messages.push((topics.pose, pose(header, &view)));
    let right_frame = topics.right_info.map(|_| CAMERA_RIGHT);
    messages.push((topics.transforms, transforms(header, &view, right_frame)));
    Ok(FrameMessages { stamp_ns, messages })
}

/// The message of a file: pictures as stored, z-depth in meters, masks as numbers.
fn describe_file(role: Role, header: Header<'_>, file: &Unpacked, view: &View) -> Result<Vec<u8>, String> {
    match role {
        Role::Depth => Ok(depth_image(header, &read_z_depth(&file.bytes, view)?)),
        Role::Mask => {
            let mask = decode_mask(&file.bytes).map_err(|error| error.to_string())?;
            Ok(mask_image(header, &mask))
        }
        Role::Picture | Role::RightPicture | Role::Record => {
            let header = match role {
                Role::RightPicture => header.in_frame(CAMERA_RIGHT),
                _ => header,
            };
            let format = match file.name.rsplit('.').next().unwrap_or_default() {
                "jpg" => "jpeg",
                extension => extension,
            };
            Ok(compressed_image(header, format, &file.bytes))
        }
    }
}
