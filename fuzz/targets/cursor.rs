//! A cursor that was not given out: refused, or a page. Never an error of the database.
#![no_main]

#[path = "shared/images.rs"]
mod images;

use catalogue::ImageQuery;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let (cursor, order_by) = match text.split_once('\n') {
        Some((cursor, order)) => (cursor, Some(order.to_owned())),
        None => (text, None),
    };
    images::ask(ImageQuery {
        cursor: Some(cursor.to_owned()),
        order_by,
        ..images::all()
    });
});
