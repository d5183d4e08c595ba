//! Answers that every operation of a kind can give, added in one place so that no route forgets one.

use utoipa::openapi::path::{Operation, PathItem};
use utoipa::openapi::{OpenApi, Ref, RefOr};

/// Of every operation: the service's own faults, and too slow a client.
const ALL: &[u16] = &[408, 500, 503];
/// Of operations that need a token: none, or one that may not; pages of other sites count as the latter.
const GUARDED: &[u16] = &[401, 403];
/// Of operations with parts that can be wrong.
const WITH_PARAMETERS: &[u16] = &[400];
/// Of operations with a body.
const WITH_BODY: &[u16] = &[400, 413, 415];
/// Of operations that write: the disk is full.
const WRITING: &[u16] = &[507];

/// Adds the answers that follow from an operation's form.
pub(crate) fn complete(document: &mut OpenApi) {
    for item in document.paths.paths.values_mut() {
        let PathItem {
            get, post, delete, ..
        } = item;
        for operation in get.iter_mut() {
            answers(operation, &[]);
        }
        for operation in [post, delete].into_iter().flatten() {
            answers(operation, WRITING);
        }
    }
}

fn answers(operation: &mut Operation, writing: &[u16]) {
    let guarded = match &operation.security {
        None => GUARDED,
        Some(_) => &[],
    };
    let parameters = operation.parameters.as_ref().is_some_and(|all| !all.is_empty());
    let parameters = if parameters { WITH_PARAMETERS } else { &[] };
    let body = operation.request_body.as_ref().map_or(&[][..], |_| WITH_BODY);
    for status in [ALL, guarded, parameters, body, writing].concat() {
        let problem = RefOr::Ref(Ref::from_response_name("Problem"));
        operation
            .responses
            .responses
            .entry(status.to_string())
            .or_insert(problem);
    }
}
