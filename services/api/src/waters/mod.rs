//! User-defined waters, cached in memory; the catalogue stores them.

pub(crate) mod routes;
pub(crate) mod view;

use std::collections::BTreeMap;
use std::sync::{Arc, PoisonError, RwLock};

use catalogue::{Catalogue, CatalogueError, UnixMs, WaterRow};
use client::WaterView;
use optics::own_water::parse_own;
use optics::preset::{self, Preset};
use serde_json::{Map, Value};
use spec::OwnWater;
use tokio::sync::Mutex;

use crate::clock::Clock;
use crate::http::problem::{Problem, Slug};
use crate::processes::compute::to_the_end;
use view::water_view;

/// The user-defined waters.
pub(crate) struct Waters {
    own: RwLock<Vec<Own>>,
    /// Held while catalogue and cache change together.
    turn: Mutex<()>,
    catalogue: Arc<Catalogue>,
    clock: Clock,
}

/// A user-defined water.
#[derive(Clone)]
struct Own {
    water: OwnWater,
    preset: Preset,
    created_at: UnixMs,
}

impl Own {
    fn name(&self) -> &str {
        &self.water.name
    }

    fn view(&self) -> WaterView {
        water_view(&self.preset, Some(self.created_at))
    }
}

impl Waters {
    /// Reads the waters from the catalogue. A water that fails the current checks stays stored, but is logged and
    /// skipped.
    pub(crate) async fn open(catalogue: Arc<Catalogue>, clock: Clock) -> Result<Self, CatalogueError> {
        let mut own: Vec<Own> = Vec::new();
        for WaterRow {
            name,
            description,
            created_at,
        } in catalogue.waters().await?
        {
            match parse_own(description.as_bytes(), &[]) {
                Ok((water, preset)) if preset::find(&name).is_none() => own.push(Own {
                    water,
                    preset,
                    created_at,
                }),
                Ok(_) => tracing::warn!(
                    water = name,
                    "a built-in water with this name now hides the user-defined one"
                ),
                Err(errors) => tracing::warn!(water = name, %errors, "skipped a stored water"),
            }
        }
        Ok(Self {
            own: RwLock::new(own),
            turn: Mutex::default(),
            catalogue,
            clock,
        })
    }

    /// The optics of each name in a job.
    pub(crate) fn words(&self) -> BTreeMap<String, Map<String, Value>> {
        self.own()
            .into_iter()
            .map(|own: Own| (own.name().to_owned(), own.water.optics()))
            .collect()
    }

    /// The shipped waters, then the user-defined ones by name.
    fn all(&self) -> Vec<WaterView> {
        let shipped = preset::presets().iter().map(|preset| water_view(preset, None));
        shipped.chain(self.own().iter().map(Own::view)).collect()
    }

    fn find(&self, name: &str) -> Option<WaterView> {
        let shipped = preset::find(name).map(|preset| water_view(preset, None));
        shipped.or_else(|| self.own().iter().find(|own| own.name() == name).map(Own::view))
    }

    fn own(&self) -> Vec<Own> {
        self.own.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Checks and stores a water, which jobs may then use. Completes even if the client disconnects.
    async fn create(self: &Arc<Self>, body: Vec<u8>) -> Result<WaterView, Problem> {
        let waters = Arc::clone(self);
        to_the_end(async move {
            let _turn = waters.turn.lock().await;
            let others: Vec<Preset> = waters.own().into_iter().map(|own| own.preset).collect();
            let (water, preset) = parse_own(&body, &others)?;
            let name = water.name.clone();
            let created_at = waters.clock.wall();
            let row = WaterRow {
                name: name.clone(),
                description: water.description(),
                created_at,
            };
            if preset::find(&name).is_some() || !waters.catalogue.insert_water(row).await? {
                let detail = format!("the water `{name}` exists; choose another name");
                return Err(Problem::new(Slug::NameTaken, detail));
            }
            let own = Own {
                water,
                preset,
                created_at,
            };
            let view = own.view();
            let mut all = waters.own.write().unwrap_or_else(PoisonError::into_inner);
            let place = all.partition_point(|other| *other.name() < *name);
            all.insert(place, own);
            tracing::info!(water = name, "water stored");
            Ok(view)
        })
        .await
    }

    /// Deletes a water. Jobs are unaffected: they contain its numbers.
    async fn delete(self: &Arc<Self>, name: String) -> Result<(), Problem> {
        let waters = Arc::clone(self);
        to_the_end(async move {
            let _turn = waters.turn.lock().await;
            let deleted = waters.catalogue.delete_water(&name).await?;
            let mut all = waters.own.write().unwrap_or_else(PoisonError::into_inner);
            all.retain(|own| own.name() != name);
            match (deleted, preset::find(&name)) {
                (true, _) => Ok(()),
                (false, Some(_)) => Err(Problem::not_found(format!(
                    "water `{name}` is built in and cannot be deleted"
                ))),
                (false, None) => Err(Problem::not_found(format!("no water `{name}`"))),
            }
        })
        .await
    }
}
