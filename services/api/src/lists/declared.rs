//! The lists, each read from its declaration.

use super::entries;
use super::entry::List;

/// Every list, in documentation order.
pub(super) const LISTS: &[List] = &[
    List {
        name: "sites",
        about: "complete places that a job can start from",
        places: &["`site` of a job", "`fathom new`"],
        stored_at: None,
        shipped: Some(entries::sites),
    },
    List {
        name: "artifacts",
        about: "files that can be stored for a frame",
        places: &[
            "`artifacts` of a job",
            "`kind` of `/v1/images/{job}/{frame}/artifacts/{kind}`",
            "`fathom export --kinds`",
        ],
        stored_at: None,
        shipped: Some(entries::artifacts),
    },
    List {
        name: "metrics",
        about: "measures of image quality, `name` or `name@profile`",
        places: &[
            "`metrics` of a job",
            "`metrics` of `/v1/measure` and `/v1/datasets/{name}/stats`",
            "`fathom measure --metrics`",
        ],
        stored_at: None,
        shipped: Some(entries::metrics),
    },
    List {
        name: "profiles",
        about: "published arithmetic of a metric",
        places: &["after the `@` of a metric", "`fathom measure --profile`"],
        stored_at: None,
        shipped: Some(entries::profiles),
    },
    List {
        name: "enhancements",
        about: "image enhancement methods",
        places: &[
            "`enhance` of a job",
            "`method` of `/v1/enhance`",
            "`fathom enhance`",
        ],
        stored_at: None,
        shipped: Some(entries::enhancements),
    },
    List {
        name: "families",
        about: "families of procedural scenes",
        places: &["`scene.family` of a job"],
        stored_at: None,
        shipped: Some(entries::families),
    },
    List {
        name: "categories",
        about: "classes of objects with their numbers",
        places: &[
            "codes of the artifact `semantics`",
            "`category` in the artifact `boxes`",
        ],
        stored_at: None,
        shipped: Some(entries::categories),
    },
    List {
        name: "findings",
        about: "inspection findings with their bits",
        places: &["bits of the artifact `findings`: `1 << number`"],
        stored_at: None,
        shipped: Some(entries::findings),
    },
    List {
        name: "fields",
        about: "fields of a job description with units, limits and words",
        places: &["a job", "`pointer` of an error, as a path"],
        stored_at: None,
        shipped: Some(entries::fields),
    },
    List {
        name: "columns",
        about: "columns for filtering and sorting images; a dataset has more",
        places: &[
            "`filter`, `order_by` and `fields` of `/v1/images`, with the labels and artifacts that `/v1/datasets/{name}` lists",
            "`group_by` and `column` of `/v1/datasets/{name}`",
            "`fathom query`",
        ],
        stored_at: None,
        shipped: Some(entries::columns),
    },
    List {
        name: "states",
        about: "states of a job",
        places: &["`state` of `/v1/jobs`"],
        stored_at: None,
        shipped: Some(entries::states),
    },
    List {
        name: "jerlov-types",
        about: "water types of Jerlov",
        places: &["`jerlov_type` of `/v1/waters`"],
        stored_at: None,
        shipped: Some(entries::jerlov_types),
    },
    List {
        name: "problems",
        about: "types of problems",
        places: &["`type` of every error response", "`/problems/{slug}`"],
        stored_at: None,
        shipped: Some(entries::problems),
    },
    List {
        name: "cameras",
        about: "cameras with port, lens, shutter and sensor",
        places: &["`camera.preset` of a job"],
        stored_at: None,
        shipped: Some(entries::cameras),
    },
    List {
        name: "sensors",
        about: "sensors with their noise",
        places: &["`camera.sensor` of a job"],
        stored_at: None,
        shipped: Some(entries::sensors),
    },
    List {
        name: "waters",
        about: "optical waters: built-in ones, in a service also user-defined ones",
        places: &["`water.optics` of a job", "`/v1/waters/{name}`"],
        stored_at: Some("/v1/waters"),
        shipped: Some(entries::waters),
    },
    List {
        name: "styles",
        about: "style waters: built-in ones, in a service also added ones",
        places: &["`water.style` of a job"],
        stored_at: Some("/v1/styles"),
        shipped: Some(entries::styles),
    },
    List {
        name: "scenes",
        about: "uploaded scenes, by their id",
        places: &["`scene.id` of a job"],
        stored_at: Some("/v1/scenes"),
        shipped: None,
    },
    List {
        name: "collections",
        about: "collections of uploaded scenes",
        places: &[
            "`scene.name` of a job",
            "`collection` of an upload",
            "`/v1/collections/{name}`",
            "`fathom upload --collection`",
        ],
        stored_at: Some("/v1/collections"),
        shipped: None,
    },
    List {
        name: "datasets",
        about: "collections of images",
        places: &["`dataset` of a job and of `/v1/images`", "`/v1/datasets/{name}`"],
        stored_at: Some("/v1/datasets"),
        shipped: None,
    },
    List {
        name: "jobs",
        about: "submitted jobs, by their id",
        places: &["`/v1/jobs/{id}`", "`job` of `/v1/images/{job}/{frame}`"],
        stored_at: Some("/v1/jobs"),
        shipped: None,
    },
];
