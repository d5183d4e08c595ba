//! A filter or an order by, down to the database: refused with a position, or a page. Never an error of the database.
#![no_main]

#[path = "shared/images.rs"]
mod images;

use catalogue::ImageQuery;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let (filter, order_by) = match text.split_once('\n') {
        Some((filter, order)) => (filter, Some(order.to_owned())),
        None => (text, None),
    };
    images::ask(ImageQuery {
        filter: Some(filter.to_owned()),
        order_by,
        ..images::all()
    });
});
