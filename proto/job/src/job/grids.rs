//! Grid layout: strides of the axes, and the number of frames.

use std::collections::BTreeMap;

use crate::fields::MAX_FRAMES;
use crate::invalid::FieldError;
use crate::node::{Law, Node};

/// Sets the stride of every grid axis; returns the product of their lengths, or `None` on overflow of u64.
pub(super) fn lay_out_grids<'a>(trees: impl Iterator<Item = &'a mut Node>) -> Option<u64> {
    let mut trees: Vec<_> = trees.collect();
    let mut lengths = BTreeMap::new();
    for law in trees.iter().flat_map(|tree| tree.laws()) {
        if matches!(law.law, Law::Grid { .. }) {
            let length = lengths.entry(law.pointer.clone()).or_insert(0);
            *length = law.values().len().max(*length);
        }
    }
    let mut product: Option<u64> = Some(1);
    let mut strides = BTreeMap::new();
    for (pointer, length) in lengths.into_iter().rev() {
        strides.insert(pointer, product.unwrap_or(1));
        product = product.and_then(|product| product.checked_mul(length as u64));
    }
    for tree in &mut trees {
        tree.change_laws(&mut |node| {
            if let Law::Grid { stride, .. } = &mut node.law {
                *stride = strides.get(&node.pointer).copied().unwrap_or(1);
            }
        });
    }
    product
}

/// The number of frames; 0 with an error added if there are too many.
pub(super) fn count_frames(document: &Node, cells: Option<u64>, errors: &mut Vec<FieldError>) -> u64 {
    let Some(count) = document.get("count").and_then(Node::greatest) else {
        return 0;
    };
    let count = count as u64;
    let frames = cells.and_then(|cells| cells.checked_mul(count));
    if let Some(frames) = frames.filter(|frames| *frames <= MAX_FRAMES) {
        return frames;
    }
    let cells = cells.map_or("more than 2^64".to_owned(), |cells| cells.to_string());
    let message = format!(
        "`count` is {count} and the grid has {cells} cells; must be at most {MAX_FRAMES} frames in total"
    );
    let error = FieldError::new("/count", message).value(&count.into());
    errors.push(error.limit(format!("{MAX_FRAMES} frames")));
    0
}
