//! The input and the output of an enhancer or a metric.

use ort::value::{Outlet, TensorElementType, ValueType};

use crate::role::{Layout, ModelRole};

/// Names of the input and of the output.
pub(super) struct Ports {
    pub(super) image: String,
    pub(super) output: String,
}

impl Ports {
    /// The only input, and the first output. Both must fit the role and the layout as far as the file declares their shapes.
    pub(super) fn find(
        inputs: &[Outlet],
        outputs: &[Outlet],
        role: ModelRole,
        layout: Layout,
    ) -> Result<Self, String> {
        let [image] = inputs else {
            let names: Vec<_> = inputs.iter().map(|input| format!("`{}`", input.name())).collect();
            let names = names.join(", ");
            return Err(format!(
                "it has {} inputs ({names}); must have one, the picture",
                inputs.len()
            ));
        };
        let output = outputs.first().ok_or("it has no output")?;
        let mut faults = Vec::new();
        faults.extend(find_fault(image, layout));
        match role {
            ModelRole::Metric => faults.extend(find_number_fault(output)),
            ModelRole::Enhancer | ModelRole::Style => faults.extend(find_fault(output, layout)),
        }
        if faults.is_empty() {
            Ok(Self {
                image: image.name().to_owned(),
                output: output.name().to_owned(),
            })
        } else {
            Err(faults.join("; "))
        }
    }
}

/// Why an outlet is no picture of this layout; negative sides are dynamic. Three at the channels of the other layout alone means that
/// the file has that layout.
fn find_fault(outlet: &Outlet, layout: Layout) -> Option<String> {
    let other = match layout {
        Layout::ChannelsFirst => Layout::ChannelsLast,
        Layout::ChannelsLast => Layout::ChannelsFirst,
    };
    let is_picture = matches!(outlet.dtype(), ValueType::Tensor {
        ty: TensorElementType::Float32,
        shape,
        ..
    } if shape.len() == 4
        && (shape[0] == 1 || shape[0] < 0)
        && (shape[layout.channel_axis()] == 3
            || shape[layout.channel_axis()] < 0 && shape[other.channel_axis()] != 3));
    let axes = match layout {
        Layout::ChannelsFirst => "[1, 3, height, width]",
        Layout::ChannelsLast => "[1, height, width, 3]",
    };
    (!is_picture).then(|| {
        format!(
            "`{}` is {}; must be float32 of shape {axes} for the layout {}",
            outlet.name(),
            outlet.dtype(),
            layout.name()
        )
    })
}

/// Why an outlet is not one number.
fn find_number_fault(outlet: &Outlet) -> Option<String> {
    let is_number = matches!(outlet.dtype(), ValueType::Tensor {
        ty: TensorElementType::Float32,
        shape,
        ..
    } if shape.iter().all(|&side| side == 1 || side < 0));
    (!is_number).then(|| {
        format!(
            "`{}` is {}; must be one float32 number",
            outlet.name(),
            outlet.dtype()
        )
    })
}
