//! Messages of a frame.

use cli::exit::Failure;
use imaging::Plane;
use spec::{Distortion, Intrinsics};

use crate::commands::dataset::export::formats::quaternion::quaternion;
use crate::commands::dataset::export::formats::recordings::cdr::Cdr;
use crate::commands::dataset::export::formats::view::View;

/// The frame of the poses; its z axis points up.
pub(super) const WORLD: &str = "world";
const NS_PER_S: u64 = 1_000_000_000;

/// Time and coordinate frame of a message.
#[derive(Clone, Copy)]
pub(super) struct Header<'a> {
    seconds: i32,
    nanoseconds: u32,
    pub(super) frame_id: &'a str,
}

impl<'a> Header<'a> {
    pub(super) fn new(stamp_ns: u64, frame_id: &'a str) -> Result<Self, Failure> {
        let seconds = i32::try_from(stamp_ns / NS_PER_S).map_err(|_| {
            Failure::BadInput(format!(
                "a frame has the time {stamp_ns} ns; messages of ROS end at {} s: choose another format",
                i32::MAX
            ))
        })?;
        Ok(Self {
            seconds,
            nanoseconds: (stamp_ns % NS_PER_S) as u32,
            frame_id,
        })
    }

    /// The same time in another coordinate frame.
    pub(super) fn in_frame(self, frame_id: &'a str) -> Self {
        Self { frame_id, ..self }
    }

    fn write(self, cdr: &mut Cdr) {
        cdr.write_i32(self.seconds);
        cdr.write_u32(self.nanoseconds);
        cdr.write_text(self.frame_id);
    }

    fn begin(self) -> Cdr {
        let mut cdr = Cdr::new();
        self.write(&mut cdr);
        cdr
    }
}

/// A picture as it is stored.
pub(super) fn compressed_image(header: Header<'_>, format: &str, bytes: &[u8]) -> Vec<u8> {
    let mut cdr = header.begin();
    cdr.write_text(format);
    cdr.write_bytes(bytes);
    cdr.finish()
}

/// z-depth in meters.
pub(super) fn depth_image(header: Header<'_>, depth: &Plane<f32>) -> Vec<u8> {
    let data: Vec<u8> = depth
        .data()
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    image(header, depth.size(), "32FC1", &data)
}

/// The numbers of a mask.
pub(super) fn mask_image(header: Header<'_>, mask: &Plane<u16>) -> Vec<u8> {
    let data: Vec<u8> = mask.data().iter().flat_map(|value| value.to_le_bytes()).collect();
    image(header, mask.size(), "mono16", &data)
}

fn image(header: Header<'_>, (width, height): (usize, usize), encoding: &str, data: &[u8]) -> Vec<u8> {
    let mut cdr = header.begin();
    cdr.write_length(height);
    cdr.write_length(width);
    cdr.write_text(encoding);
    cdr.write_u8(0);
    cdr.write_length(data.len().checked_div(height).unwrap_or(0));
    cdr.write_bytes(data);
    cdr.finish()
}

/// The camera; `right_m`: how far it is to the right of the left camera of a stereo pair.
pub(super) fn camera_info(header: Header<'_>, view: &View, right_m: f64) -> Vec<u8> {
    let Intrinsics { focal_px: f, cx, cy } = view.intrinsics;
    let Distortion { k1, k2, k3, p1, p2 } = view.distortion.unwrap_or_default();
    let mut cdr = header.begin();
    cdr.write_length(view.height as usize);
    cdr.write_length(view.width as usize);
    cdr.write_text("plumb_bob");
    cdr.write_length(5);
    cdr.write_f64s(&[k1, k2, p1, p2, k3]);
    cdr.write_f64s(&[f, 0.0, cx, 0.0, f, cy, 0.0, 0.0, 1.0]);
    cdr.write_f64s(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    cdr.write_f64s(&[f, 0.0, cx, 0.0 - f * right_m, 0.0, f, cy, 0.0, 0.0, 0.0, 1.0, 0.0]);
    // No binning, and the whole picture as region of interest, which is written as zeros.
    for _ in 0..6 {
        cdr.write_u32(0);
    }
    cdr.write_u8(0);
    cdr.finish()
}

/// The pose of the camera in the world.
pub(super) fn pose(header: Header<'_>, view: &View) -> Vec<u8> {
    let mut cdr = header.in_frame(WORLD).begin();
    cdr.write_f64s(&view.position());
    write_rotation(&mut cdr, view);
    cdr.finish()
}

/// The transform from the camera to the world, and from the right camera, if there is one, to the left.
pub(super) fn transforms(header: Header<'_>, view: &View, right_frame: Option<&str>) -> Vec<u8> {
    let right = right_frame.zip(view.baseline_m);
    let mut cdr = Cdr::new();
    cdr.write_length(1 + usize::from(right.is_some()));
    header.in_frame(WORLD).write(&mut cdr);
    cdr.write_text(header.frame_id);
    cdr.write_f64s(&view.position());
    write_rotation(&mut cdr, view);
    if let Some((frame_id, baseline_m)) = right {
        header.write(&mut cdr);
        cdr.write_text(frame_id);
        cdr.write_f64s(&[baseline_m, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    }
    cdr.finish()
}

fn write_rotation(cdr: &mut Cdr, view: &View) {
    let [w, x, y, z] = quaternion(view.rotation());
    cdr.write_f64s(&[x, y, z, w]);
}
