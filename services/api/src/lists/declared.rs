//! The lists, and how each is read from its declaration.

use camera::preset::{ASSUMPTIONS, CAMERAS, CameraPreset, SENSORS, SensorPreset};
use catalogue::{JobState, columns_of_every_image};
use enhance::Method;
use quality::{MetricId, MetricInfo, Profile};
use renderer::vocabulary;
use scenes::Family;
use scenes::categories::{CATEGORIES, FINDINGS};
use spec::{JERLOV_TYPES, SITES, table};
use style::Library;

use super::{Entry, List};
use crate::http::problem::Slug;

/// Every list, in the order of the documentation.
pub(super) const LISTS: &[List] = &[
    List {
        name: "sites",
        about: "whole places that a job can start from",
        places: &["`site` of a job", "`fathom new`"],
        stored_at: None,
        shipped: Some(sites),
    },
    List {
        name: "artifacts",
        about: "files that a frame can store",
        places: &[
            "`artifacts` of a job",
            "`kind` of `/v1/images/{job}/{frame}/artifacts/{kind}`",
            "`fathom export --kinds`",
        ],
        stored_at: None,
        shipped: Some(artifacts),
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
        shipped: Some(metrics),
    },
    List {
        name: "profiles",
        about: "published arithmetic of a metric",
        places: &["behind the `@` of a metric", "`fathom measure --profile`"],
        stored_at: None,
        shipped: Some(profiles),
    },
    List {
        name: "enhancements",
        about: "methods that enhance a picture",
        places: &[
            "`enhance` of a job",
            "`method` of `/v1/enhance`",
            "`fathom enhance`",
        ],
        stored_at: None,
        shipped: Some(enhancements),
    },
    List {
        name: "families",
        about: "families of procedural scenes",
        places: &["`scene.family` of a job"],
        stored_at: None,
        shipped: Some(families),
    },
    List {
        name: "categories",
        about: "classes of objects with their numbers",
        places: &[
            "codes of the artifact `semantics`",
            "`category` in the artifact `boxes`",
        ],
        stored_at: None,
        shipped: Some(categories),
    },
    List {
        name: "findings",
        about: "inspection findings with their bits",
        places: &["bits of the artifact `findings`: `1 << number`"],
        stored_at: None,
        shipped: Some(findings),
    },
    List {
        name: "fields",
        about: "fields of a job description with units, limits and words",
        places: &["a job", "`pointer` of an error, as a path"],
        stored_at: None,
        shipped: Some(fields),
    },
    List {
        name: "columns",
        about: "fields to filter and order images by; a dataset has more",
        places: &[
            "`filter`, `order_by` and `fields` of `/v1/images`, with the labels and artifacts that `/v1/datasets/{name}` lists",
            "`group_by` and `column` of `/v1/datasets/{name}`",
            "`fathom query`",
        ],
        stored_at: None,
        shipped: Some(columns),
    },
    List {
        name: "states",
        about: "states of a job",
        places: &["`state` of `/v1/jobs`"],
        stored_at: None,
        shipped: Some(states),
    },
    List {
        name: "jerlov-types",
        about: "water types of Jerlov",
        places: &["`jerlov_type` of `/v1/waters`"],
        stored_at: None,
        shipped: Some(jerlov_types),
    },
    List {
        name: "problems",
        about: "types of problems",
        places: &["`type` of every refusal", "`/problems/{slug}`"],
        stored_at: None,
        shipped: Some(problems),
    },
    List {
        name: "cameras",
        about: "cameras: port, lens, shutter and sensor together",
        places: &["`camera.preset` of a job"],
        stored_at: None,
        shipped: Some(cameras),
    },
    List {
        name: "sensors",
        about: "sensors with their noise",
        places: &["`camera.sensor` of a job"],
        stored_at: None,
        shipped: Some(sensors),
    },
    List {
        name: "waters",
        about: "optical waters: the shipped ones, and in a service also added ones",
        places: &["`water.optics` of a job", "`/v1/waters/{name}`"],
        stored_at: Some("/v1/waters"),
        shipped: Some(waters),
    },
    List {
        name: "styles",
        about: "style waters: the shipped ones, and in a service also added ones",
        places: &["`water.style` of a job"],
        stored_at: Some("/v1/styles"),
        shipped: Some(styles),
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

fn entry(name: impl Into<String>, about: impl Into<String>) -> Entry {
    Entry {
        name: name.into(),
        number: None,
        unit: None,
        about: about.into(),
    }
}

fn sites(_: &Library) -> Vec<Entry> {
    SITES
        .iter()
        .map(|site| entry(site.name, site.summary()))
        .collect()
}

fn artifacts(library: &Library) -> Vec<Entry> {
    let kinds = vocabulary(library, false).artifacts();
    kinds
        .iter()
        .map(|kind| entry(kind.to_string(), kind.about()))
        .collect()
}

fn metrics(_: &Library) -> Vec<Entry> {
    let about = |info: &MetricInfo| {
        let (least, most) = (*info.range.start(), *info.range.end());
        let range = if most.is_finite() {
            format!("; {least}..={most}")
        } else {
            String::new()
        };
        let reference = if info.needs_reference {
            "; needs the clean picture"
        } else {
            ""
        };
        format!("{}{range}{reference}", info.about)
    };
    MetricId::all()
        .map(|id| entry(id.to_string(), about(id.info())))
        .collect()
}

fn profiles(_: &Library) -> Vec<Entry> {
    Profile::ALL
        .iter()
        .map(|profile| entry(profile.name(), profile.about()))
        .collect()
}

fn enhancements(_: &Library) -> Vec<Entry> {
    let methods = enhance::METHODS.iter().filter_map(|name| Method::parse(name));
    let about = |method: &Method| format!("{}; {}", method.about(), method.against_published());
    methods
        .map(|method| entry(method.name(), about(&method)))
        .collect()
}

fn families(_: &Library) -> Vec<Entry> {
    let families = scenes::FAMILIES.iter().filter_map(|name| Family::parse(name));
    families.map(|family| entry(family.name, family.about)).collect()
}

fn categories(_: &Library) -> Vec<Entry> {
    let numbered = |(category, name): &(scenes::categories::Category, &str)| Entry {
        number: Some(*category as u8),
        ..entry(*name, category.about())
    };
    CATEGORIES.iter().map(numbered).collect()
}

fn findings(_: &Library) -> Vec<Entry> {
    let numbered = |(finding, name): &(scenes::categories::Finding, &str)| Entry {
        number: Some(*finding as u8),
        ..entry(*name, finding.about())
    };
    FINDINGS.iter().map(numbered).collect()
}

fn fields(_: &Library) -> Vec<Entry> {
    let about = |row: &table::Row| match row.limit.as_str() {
        "" => row.doc.clone(),
        limit => format!("{}; {limit}", row.doc),
    };
    let field = |row: table::Row| Entry {
        unit: row.unit,
        ..entry(row.path.clone(), about(&row))
    };
    table::rows().into_iter().map(field).collect()
}

fn columns(library: &Library) -> Vec<Entry> {
    let columns = columns_of_every_image(&vocabulary(library, false).metrics);
    let column = |column: catalogue::ColumnInfo| Entry {
        unit: column.unit,
        ..entry(column.name, column.kind)
    };
    columns.into_iter().map(column).collect()
}

fn states(_: &Library) -> Vec<Entry> {
    JobState::ALL
        .iter()
        .map(|(state, name)| entry(*name, state.about()))
        .collect()
}

fn jerlov_types(_: &Library) -> Vec<Entry> {
    let about = |name: &str| {
        if name.starts_with('I') {
            "open ocean"
        } else {
            "coastal"
        }
    };
    JERLOV_TYPES
        .iter()
        .map(|name| entry(*name, about(name)))
        .collect()
}

fn problems(_: &Library) -> Vec<Entry> {
    Slug::ALL
        .iter()
        .map(|slug| entry(slug.name(), slug.meaning()))
        .collect()
}

fn cameras(_: &Library) -> Vec<Entry> {
    let about = |camera: &CameraPreset| format!("{}; {}", camera.about, camera.source);
    CAMERAS
        .iter()
        .map(|camera| entry(camera.name, about(camera)))
        .collect()
}

fn sensors(_: &Library) -> Vec<Entry> {
    let about = |sensor: &SensorPreset| {
        let assumed = if sensor.is_assumed() {
            format!("; {ASSUMPTIONS}")
        } else {
            String::new()
        };
        format!("{}; {}{assumed}", sensor.about, sensor.source)
    };
    SENSORS
        .iter()
        .map(|sensor| entry(sensor.name, about(sensor)))
        .collect()
}

fn waters(_: &Library) -> Vec<Entry> {
    let presets = optics::preset::presets().iter();
    presets
        .map(|preset| entry(preset.name.clone(), preset.source.clone()))
        .collect()
}

fn styles(library: &Library) -> Vec<Entry> {
    library
        .models()
        .map(|model| entry(model.name.clone(), model.card.source.clone()))
        .collect()
}
