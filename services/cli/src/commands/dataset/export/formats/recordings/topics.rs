//! The topics of a sequence.

use std::io::{self, Write};

use crate::commands::dataset::export::formats::recordings::container::Container;
use crate::commands::dataset::export::formats::recordings::schemas::MessageType;
use crate::commands::dataset::export::role::Role;

/// Numbers of the channels of a file.
pub(super) struct Topics {
    /// The role and the channel of each kind; a record has none.
    pub(super) kinds: Vec<(Role, Option<u16>)>,
    pub(super) camera_info: u16,
    /// The camera on the right of a stereo pair.
    pub(super) right_info: Option<u16>,
    pub(super) pose: u16,
    pub(super) transforms: u16,
}

impl Topics {
    /// Declares the topics of these kinds; the first kind is the picture of the camera.
    pub(super) fn declare<W: Write>(container: &mut Container<W>, kinds: &[String]) -> io::Result<Self> {
        let schemas: Vec<u16> = MessageType::ALL
            .iter()
            .map(|kind| container.declare_schema(kind.name(), &kind.definition()))
            .collect();
        let [image, compressed, info, pose, transforms] = schemas[..] else {
            return Err(io::Error::other("each type of messages has a schema"));
        };
        let mut declared = Vec::new();
        for (index, kind) in kinds.iter().enumerate() {
            let role = Role::of_checked(kind);
            // Dots are not allowed in the names of topics.
            let name = kind.replace('.', "_");
            let channel = match role {
                Role::Record => None,
                Role::Picture if index == 0 => {
                    Some(container.declare_channel(compressed, "/camera/image/compressed"))
                }
                Role::Picture => {
                    Some(container.declare_channel(compressed, &format!("/camera/{name}/compressed")))
                }
                Role::RightPicture => {
                    Some(container.declare_channel(compressed, "/camera_right/image/compressed"))
                }
                Role::Depth => Some(container.declare_channel(image, "/camera/depth")),
                Role::Mask => Some(container.declare_channel(image, &format!("/camera/{name}"))),
            };
            declared.push((role, channel));
        }
        let has_right = declared.iter().any(|(role, _)| *role == Role::RightPicture);
        Ok(Self {
            kinds: declared,
            camera_info: container.declare_channel(info, "/camera/camera_info"),
            right_info: has_right.then(|| container.declare_channel(info, "/camera_right/camera_info")),
            pose: container.declare_channel(pose, "/camera/pose"),
            transforms: container.declare_channel(transforms, "/tf"),
        })
    }
}
