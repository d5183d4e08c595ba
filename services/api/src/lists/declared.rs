//! The lists, each read from its declaration.

use super::entries;
use super::entry::List;

/// Declares lists: name, address of those that a service stores, function of the built-in entries, meaning, and where their names are
/// used.
macro_rules! lists {
    (@optional) => { None };
    (@optional $value:expr) => { Some($value) };
    ($($name:literal $(at $path:literal)? $(from $entries:ident)?: $about:literal, [$($place:literal),+];)*) => {
        &[$(List {
            name: $name,
            about: $about,
            places: &[$($place),+],
            stored_at: lists!(@optional $($path)?),
            shipped: lists!(@optional $(entries::$entries)?),
        }),*]
    };
}

/// Every list, in documentation order.
pub(super) const LISTS: &[List] = lists! {
    "sites" from sites: "complete places that a job can start from", ["`site` of a job", "`fathom new`"];
    "artifacts" from artifacts: "files that can be stored for a frame",
        ["`artifacts` of a job", "`kind` of `/v1/images/{job}/{frame}/artifacts/{kind}`", "`fathom export --kinds`"];
    "metrics" from metrics: "measures of image quality, `name` or `name@profile`; `net.NAME` is a network of the user",
        ["`metrics` of a job", "`metrics` of `/v1/measure` and `/v1/datasets/{name}/stats`", "`fathom measure --metrics`"];
    "profiles" from profiles: "published arithmetic of a metric", ["after the `@` of a metric", "`fathom measure --profile`"];
    "enhancements" from enhancements: "image enhancement methods; `onnx` with the field `model` runs a network of the user",
        ["`enhance` of a job", "`method` of `/v1/enhance`", "`fathom enhance`"];
    "families" from families: "families of procedural scenes", ["`scene.family` of a job"];
    "categories" from categories: "classes of objects with their numbers",
        ["codes of the artifact `semantics`", "`category` in the artifact `boxes`"];
    "findings" from findings: "inspection findings with their bits", ["bits of the artifact `findings`: `1 << number`"];
    "fields" from fields: "fields of a job description with units, limits and words",
        ["a job", "`pointer` of an error, as a path"];
    "columns" from columns: "columns for filtering and sorting images; a dataset has more",
        ["`filter`, `order_by` and `fields` of `/v1/images`, with the labels and artifacts that `/v1/datasets/{name}` lists", "`group_by` and `column` of `/v1/datasets/{name}`", "`fathom query`"];
    "states" from states: "states of a job", ["`state` of `/v1/jobs`"];
    "jerlov-types" from jerlov_types: "water types of Jerlov", ["`jerlov_type` of `/v1/waters`"];
    "problems" from problems: "types of problems", ["`type` of every error response", "`/problems/{slug}`"];
    "cameras" from cameras: "cameras with port, lens, shutter and sensor", ["`camera.preset` of a job"];
    "sensors" from sensors: "sensors with their noise", ["`camera.sensor` of a job"];
    "waters" at "/v1/waters" from waters: "optical waters: built-in ones, in a service also user-defined ones",
        ["`water.optics` of a job", "`/v1/waters/{name}`"];
    "styles" at "/v1/styles" from styles: "style waters: built-in ones, in a service also added ones, with enhancer and metric networks", ["`water.style` of a job", "`enhance[].model` of a job", "`net.NAME` in `metrics` of a job"];
    "scenes" at "/v1/scenes": "uploaded scenes, by their id", ["`scene.id` of a job"];
    "collections" at "/v1/collections": "collections of uploaded scenes",
        ["`scene.name` of a job", "`collection` of an upload", "`/v1/collections/{name}`", "`fathom upload --collection`"];
    "datasets" at "/v1/datasets": "collections of images", ["`dataset` of a job and of `/v1/images`", "`/v1/datasets/{name}`"];
    "jobs" at "/v1/jobs": "submitted jobs, by their id", ["`/v1/jobs/{id}`", "`job` of `/v1/images/{job}/{frame}`"];
};
