//! Waters of the users' own, in memory beside the shipped ones; the catalogue keeps them.

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

/// The waters of the users' own.
pub(crate) struct Waters {
    own: RwLock<Vec<Own>>,
    /// Held while catalogue and memory change together.
    turn: Mutex<()>,
    catalogue: Arc<Catalogue>,
    clock: Clock,
}

/// A water of a user's own.
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
    /// Reads the waters from the catalogue. One that today's tests refuse stays stored, is logged and left out.
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
                    "a shipped water has this name now: it hides the user's own"
                ),
                Err(errors) => tracing::warn!(water = name, %errors, "a stored water is left out"),
            }
        }
        Ok(Self {
            own: RwLock::new(own),
            turn: Mutex::default(),
            catalogue,
            clock,
        })
    }

    /// The optics that each name stands for in a job.
    pub(crate) fn words(&self) -> BTreeMap<String, Map<String, Value>> {
        let words = |own: Own| (own.name().to_owned(), own.water.optics());
        self.own().into_iter().map(words).collect()
    }

    /// The shipped waters, then the users' own by name.
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

    /// Checks and stores a water; jobs may use it at once. Goes on to its end when the client goes away.
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
                let detail = format!("there is a water `{name}` already");
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

    /// Deletes a water. Jobs hold its numbers and go on.
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
                    "water `{name}` comes with the service and stays"
                ))),
                (false, None) => Err(Problem::not_found(format!("no water `{name}`"))),
            }
        })
        .await
    }
}
