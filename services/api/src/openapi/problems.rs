//! Problems common to a kind of operation, added here so that no route misses one.

use utoipa::openapi::path::{Operation, ParameterIn, PathItem};
use utoipa::openapi::{OpenApi, Ref, RefOr};

/// For every operation: internal errors, and slow clients.
const ALL: &[u16] = &[408, 500, 503];
/// For operations with a token: missing or insufficient; cross-site requests count as the latter.
const GUARDED: &[u16] = &[401, 403];
/// For operations with parameters.
const WITH_PARAMETERS: &[u16] = &[400];
/// For operations on an item in the path.
const WITH_PATH: &[u16] = &[404];
/// For operations with a body.
const WITH_BODY: &[u16] = &[400, 413, 415, 422];
/// For operations that write: the disk is full.
const WRITING: &[u16] = &[507];

/// Adds the problems implied by the form of an operation.
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
    let parameters = operation.parameters.as_deref().unwrap_or_default();
    let has_path = parameters.iter().any(|parameter| match parameter {
        RefOr::T(parameter) => matches!(parameter.parameter_in, ParameterIn::Path),
        RefOr::Ref(_) => false,
    });
    let conditional = [
        (operation.security.is_none(), GUARDED),
        (!parameters.is_empty(), WITH_PARAMETERS),
        (has_path, WITH_PATH),
        (operation.request_body.is_some(), WITH_BODY),
    ];
    let mut statuses = ALL.to_vec();
    statuses.extend(
        conditional
            .iter()
            .filter(|(holds, _)| *holds)
            .flat_map(|(_, group)| *group),
    );
    statuses.extend(writing);
    for status in statuses {
        let problem = RefOr::Ref(Ref::from_response_name("Problem"));
        operation
            .responses
            .responses
            .entry(status.to_string())
            .or_insert(problem);
    }
}
