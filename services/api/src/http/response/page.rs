//! The web page at `/`: static files embedded in this binary. They contain only public data and need no token; the
//! API calls that they make do.

use axum::Router;
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use sha2::{Digest, Sha256};

use crate::http::stored;

/// Only files from this origin are loaded, and text in labels or names cannot become a script.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src 'self'; \
                      base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// A file of the page.
#[derive(Clone, Copy)]
struct Asset {
    path: &'static str,
    media_type: &'static str,
    bytes: &'static [u8],
}

macro_rules! assets {
    ($($name:literal: $media_type:expr),* $(,)?) => {
        [$(Asset {
            path: concat!("/assets/", $name),
            media_type: $media_type,
            bytes: include_bytes!(concat!("../../../page/", $name)),
        }),*]
    };
}

const START: Asset = Asset {
    path: "/",
    media_type: "text/html; charset=utf-8",
    bytes: include_bytes!("../../../page/index.html"),
};
const SCRIPT: &str = "text/javascript; charset=utf-8";
const ASSETS: [Asset; 25] = assets! {
    "api.js": SCRIPT,
    "app.js": SCRIPT,
    "chart.js": SCRIPT,
    "compose.js": SCRIPT,
    "density.js": SCRIPT,
    "dom.js": SCRIPT,
    "exact.js": SCRIPT,
    "fields.js": SCRIPT,
    "filter.js": SCRIPT,
    "form.js": SCRIPT,
    "grid.js": SCRIPT,
    "image.js": SCRIPT,
    "jobs.js": SCRIPT,
    "laws.js": SCRIPT,
    "layers.js": SCRIPT,
    "live.js": SCRIPT,
    "picture.js": SCRIPT,
    "record.js": SCRIPT,
    "set.js": SCRIPT,
    "sets.js": SCRIPT,
    "speed.js": SCRIPT,
    "text.js": SCRIPT,
    "waters.js": SCRIPT,
    "page.css": "text/css; charset=utf-8",
    "icon.svg": "image/svg+xml",
};
/// The benchmark figures shown in docs/science/accuracy.md.
const FIGURES: Asset = Asset {
    path: "/assets/chart.csv",
    media_type: "text/csv; charset=utf-8",
    bytes: include_bytes!("../../../../../docs/science/data/chart.csv"),
};
/// The machine that produced the figures.
const MACHINE: Asset = Asset {
    path: "/assets/machine.json",
    media_type: "application/json",
    bytes: include_bytes!("../../../../../docs/science/data/machine.json"),
};

/// Enhancement failures from the lab's stability.csv, rounded to the precision of a map.
const STABILITY: Asset = Asset {
    path: "/assets/stability.csv",
    media_type: "text/csv; charset=utf-8",
    bytes: include_bytes!("../../../../../docs/science/data/stability-map.csv"),
};

pub(crate) fn router() -> Router {
    let assets = [START, FIGURES, MACHINE, STABILITY].into_iter().chain(ASSETS);
    assets.fold(Router::new(), |router, asset| {
        let tag = spec::hex(&Sha256::digest(asset.bytes));
        let path = asset.path;
        router.route(
            path,
            get(move |headers: HeaderMap| async move { asset.response(&headers, &tag) }),
        )
    })
}

impl Asset {
    /// The file, or 304 if the client's copy is current. Copies are revalidated, so that a new binary takes effect.
    fn response(&self, headers: &HeaderMap, tag: &str) -> Response {
        let text = HeaderValue::from_static;
        let common: [(HeaderName, HeaderValue); 4] = [
            (header::CACHE_CONTROL, text("no-cache")),
            (header::CONTENT_SECURITY_POLICY, text(POLICY)),
            (header::X_CONTENT_TYPE_OPTIONS, text("nosniff")),
            (header::REFERRER_POLICY, text("no-referrer")),
        ];
        let common = (common, [(header::ETAG, format!("\"{tag}\""))]);
        if stored::has_current_copy(headers, tag) {
            return (StatusCode::NOT_MODIFIED, common).into_response();
        }
        let media_type = [(header::CONTENT_TYPE, self.media_type)];
        (common, media_type, self.bytes).into_response()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(asset: &Asset) -> &'static str {
        std::str::from_utf8(asset.bytes).unwrap()
    }

    #[test]
    fn every_file_that_a_file_of_the_page_names_is_embedded() {
        let mut seen = 0;
        for asset in ASSETS.iter().chain([&START]) {
            let words = text(asset).split(['"', '\'', '`']);
            let named =
                words.filter_map(|word| word.strip_prefix("./").or_else(|| word.strip_prefix("/assets/")));
            for name in named {
                let all = [FIGURES, MACHINE, STABILITY].into_iter().chain(ASSETS);
                assert!(
                    all.into_iter()
                        .any(|asset| asset.path == format!("/assets/{name}")),
                    "{} names {name}",
                    asset.path
                );
                seen += 1;
            }
        }
        assert!(seen > 40, "{seen}");
    }

    #[test]
    fn the_page_is_small_and_puts_no_markup_together() {
        let all = [START, FIGURES, MACHINE, STABILITY].into_iter().chain(ASSETS);
        let bytes: usize = all.map(|asset| asset.bytes.len()).sum();
        assert!(bytes <= 300_000, "{bytes}");
        for asset in &ASSETS {
            for wrong in [
                "innerHTML",
                "outerHTML",
                "insertAdjacentHTML",
                "document.write",
                "eval(",
            ] {
                assert!(!text(asset).contains(wrong), "{} has {wrong}", asset.path);
            }
        }
    }

    #[test]
    fn the_maps_are_the_figures_of_the_laboratory_with_fewer_digits() {
        let full = include_str!("../../../../../docs/science/data/stability.csv");
        // Only names have commas within quotes.
        let cells = |line: &str| -> Vec<String> {
            let parts: Vec<&str> = line.split('"').collect();
            let Some(name) = parts.get(1) else {
                return line.split(',').map(str::to_owned).collect();
            };
            let (before, after) = (parts[0].trim_end_matches(','), parts[2].trim_start_matches(','));
            let rest = after.split(',').map(str::to_owned);
            [before.to_owned(), (*name).to_owned()]
                .into_iter()
                .chain(rest)
                .collect()
        };
        let rounded = |cells: Vec<String>| {
            let number = |at: usize, digits: usize| {
                let value: f64 = cells[at].parse().unwrap();
                format!("{value:.digits$}")
            };
            let all = [
                cells[0].clone(),
                cells[1].clone(),
                cells[3].clone(),
                number(4, 3),
                number(5, 3),
                number(11, 1),
                cells[13].clone(),
            ];
            all.join(";")
        };
        let expected: Vec<String> = full.lines().skip(1).map(|line| rounded(cells(line))).collect();
        assert_eq!(text(&STABILITY).lines().skip(1).collect::<Vec<_>>(), expected);
    }
}
