//! Sizes of drawn masks.

use std::fmt::{self, Display, Formatter};

use serde_json::Value;

use crate::check::{Checker, find_lists, find_values, has_procedural_scene};
use crate::enhancement::mask_image::MaskImage;
use crate::invalid::FieldError;
use crate::node::Node;

/// The possible sizes of a job's images.
struct ImageSizes {
    widths: [f64; 2],
    heights: [f64; 2],
}

impl ImageSizes {
    fn of_camera(camera: &Node) -> Option<Self> {
        let [widths, heights] = ["width", "height"].map(|side| {
            let side = camera.get(side)?;
            Some([side.least()?, side.greatest()?])
        });
        Some(Self {
            widths: widths?,
            heights: heights?,
        })
    }

    fn are_all(&self, width: usize, height: usize) -> bool {
        self.widths == [width as f64; 2] && self.heights == [height as f64; 2]
    }
}

impl Display for ImageSizes {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [least_width, width] = self.widths;
        let [least_height, height] = self.heights;
        if (least_width, least_height) == (width, height) {
            write!(f, "{width}×{height}")
        } else {
            write!(f, "{least_width}×{least_height} to {width}×{height}")
        }
    }
}

impl Checker<'_> {
    /// Rejects drawn masks of another size than a camera. Uploaded pictures have other sizes, which are checked at rendering.
    pub(super) fn check_mask_sizes(&mut self, document: &Node) {
        if !has_procedural_scene(document) {
            return;
        }
        let cameras = find_values(document, "camera").into_iter();
        let cameras: Vec<_> = cameras
            .filter_map(|(_, camera)| ImageSizes::of_camera(camera))
            .collect();
        for (location, items) in find_lists(document, "enhance") {
            for (position, item) in items.iter().enumerate() {
                for (pointer, text) in find_drawn(item, &location.item(position).pointer) {
                    self.check_mask_size(&pointer, text, &cameras);
                }
            }
        }
    }

    fn check_mask_size(&mut self, pointer: &str, text: &str, cameras: &[ImageSizes]) {
        let sides = MaskImage::parse(text).ok().and_then(|mask| mask.sides());
        let Some((width, height)) = sides else {
            return;
        };
        for sizes in cameras.iter().filter(|sizes| !sizes.are_all(width, height)) {
            let message = format!(
                "the mask has {width}×{height} pixels and the images have {sizes}; draw it in the size of the camera"
            );
            self.refuse(|| {
                FieldError::new(pointer, message)
                    .value(&Value::from(text))
                    .limit(sizes.to_string())
            });
        }
    }
}

/// The drawn masks that an element of `enhance` can have, with their pointers.
fn find_drawn<'a>(item: &'a Node, pointer: &str) -> Vec<(String, &'a str)> {
    let mut drawn = Vec::new();
    for (pointer, enhancement) in item.alternatives(pointer) {
        let masks = enhancement
            .get("mask")
            .map(|mask| mask.alternatives(&format!("{pointer}/mask")));
        for (pointer, mask) in masks.into_iter().flatten() {
            let texts = mask
                .get("image")
                .map(|image| image.strings(&format!("{pointer}/image")));
            drawn.extend(texts.into_iter().flatten());
        }
    }
    drawn
}
