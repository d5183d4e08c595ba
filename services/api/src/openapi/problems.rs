//! Problems that every operation of a kind can end with, added in one place so that no route forgets one.

use utoipa::openapi::path::{Operation, Parameter, ParameterIn, PathItem};
use utoipa::openapi::{OpenApi, Ref, RefOr};

/// Of every operation: the service's own faults, and too slow a client.
const ALL: &[u16] = &[408, 500, 503];
/// Of operations that need a token: none, or one that may not; pages of other sites count as the latter.
const GUARDED: &[u16] = &[401, 403];
/// Of operations with parameters that can be wrong.
const WITH_PARAMETERS: &[u16] = &[400];
/// Of operations on something that the path names.
const WITH_PATH: &[u16] = &[404];
/// Of operations with a body.
const WITH_BODY: &[u16] = &[400, 413, 415, 422];
/// Of operations that write: the disk is full.
const WRITING: &[u16] = &[507];

/// Adds the problems that follow from an operation's form.
pub(super) fn add(document: &mut OpenApi) {
    for item in document.paths.paths.values_mut() {
        let PathItem {
            get, post, delete, ..
        } = item;
        for operation in get.iter_mut() {
            add_problems(operation, &[]);
        }
        for operation in [post, delete].into_iter().flatten() {
            add_problems(operation, WRITING);
        }
    }
}

fn add_problems(operation: &mut Operation, writing: &[u16]) {
    let when = |holds: bool, statuses: &'static [u16]| if holds { statuses } else { &[] };
    let parameters = operation.parameters.as_deref().unwrap_or_default();
    let is_path = |parameter: &RefOr<Parameter>| match parameter {
        RefOr::T(parameter) => matches!(parameter.parameter_in, ParameterIn::Path),
        RefOr::Ref(_) => false,
    };
    let statuses = [
        ALL,
        when(operation.security.is_none(), GUARDED),
        when(!parameters.is_empty(), WITH_PARAMETERS),
        when(parameters.iter().any(is_path), WITH_PATH),
        when(operation.request_body.is_some(), WITH_BODY),
        writing,
    ];
    for status in statuses.concat() {
        let problem = RefOr::Ref(Ref::from_response_name("Problem"));
        operation
            .responses
            .responses
            .entry(status.to_string())
            .or_insert(problem);
    }
}
