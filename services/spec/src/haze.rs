//! From a frame's lights to what the optics ask for.

use crate::frame::{Frame, Haze, HazeBlend, HazeSpace};

/// The lights of a frame as the optics ask for them, in their order.
#[must_use]
pub fn haze_lights(frame: &Frame) -> Vec<optics::HazeLight> {
    frame.lights.iter().map(light).collect()
}

/// The space that the lights of a frame are laid in; linear without lights.
#[must_use]
pub fn haze_space(frame: &Frame) -> optics::HazeSpace {
    match frame.lights.first().map(|light| light.space) {
        None | Some(HazeSpace::Linear) => optics::HazeSpace::Linear,
        Some(HazeSpace::Display) => optics::HazeSpace::Display,
    }
}

fn light(light: &Haze) -> optics::HazeLight {
    optics::HazeLight {
        x: light.x,
        y: light.y,
        size: light.size,
        intensity: light.intensity,
        color: light.color,
        blend: match light.blend {
            HazeBlend::Over => optics::HazeBlend::Over,
            HazeBlend::Add => optics::HazeBlend::Add,
        },
    }
}
