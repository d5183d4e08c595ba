//! Image formation in water: attenuation, forward scatter, style blend, haze, presets and the plan.
