//! Waters of the users' own, in memory beside the shipped ones; the catalogue keeps them.

pub(crate) mod routes;
pub(crate) mod view;

use std::collections::BTreeMap;
use std::sync::{Arc, PoisonError, RwLock};

use catalogue::{Catalogue, CatalogueError, WaterRow};
use optics::preset::{self, Preset, parse_own};
use serde_json::{Map, Value};
use spec::OwnWater;
use tokio::sync::Mutex;

use crate::app::Shared;
use crate::http::problem::{Problem, Slug};

/// The waters of the users' own.
pub(crate) struct Waters {
    own: RwLock<Vec<Own>>,
    /// Held while catalogue and memory change together.
    turn: Mutex<()>,
}

/// A water of a user's own.
#[derive(Debug, Clone)]
pub(crate) struct Own {
    pub(crate) preset: Preset,
    pub(crate) created_ms: u64,
    water: OwnWater,
}

impl Own {
    pub(crate) fn new((water, preset): (OwnWater, Preset), created_ms: u64) -> Self {
        Self {
            preset,
            created_ms,
            water,
        }
    }
}

impl Waters {
    /// Reads them from the catalogue. One that today's tests refuse stays stored and is left out with a word in the log.
    pub(crate) async fn open(catalogue: &Catalogue) -> Result<Self, CatalogueError> {
        let mut own: Vec<Own> = Vec::new();
        for row in catalogue.waters().await? {
            match parse_own(row.description.as_bytes(), &[]) {
                Ok(water) if preset::find(&row.name).is_none() => own.push(Own::new(water, row.created_ms)),
                Ok(_) => tracing::warn!(
                    water = row.name,
                    "a shipped water has this name now: it hides the user's own"
                ),
                Err(errors) => tracing::warn!(water = row.name, %errors, "a stored water is left out"),
            }
        }
        Ok(Self {
            own: RwLock::new(own),
            turn: Mutex::default(),
        })
    }

    /// What stands for each name in a job.
    pub(crate) fn words(&self) -> BTreeMap<String, Map<String, Value>> {
        let all = self.own.read().unwrap_or_else(PoisonError::into_inner);
        all.iter()
            .map(|own| (own.preset.name.clone(), own.water.optics()))
            .collect()
    }

    /// All of them by name.
    pub(crate) fn all(&self) -> Vec<Own> {
        self.own.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn add(&self, own: Own) {
        let mut all = self.own.write().unwrap_or_else(PoisonError::into_inner);
        let place = all.partition_point(|other| other.preset.name < own.preset.name);
        all.insert(place, own);
    }

    fn remove(&self, name: &str) {
        let mut all = self.own.write().unwrap_or_else(PoisonError::into_inner);
        all.retain(|own| own.preset.name != name);
    }
}

/// Checks and stores a water; jobs may use it at once. Goes on to its end when the client goes away.
pub(crate) async fn create(app: &Shared, body: Vec<u8>) -> Result<Own, Problem> {
    let app = Arc::clone(app);
    let task = tokio::spawn(async move {
        let _turn = app.waters.turn.lock().await;
        let others: Vec<Preset> = app.waters.all().into_iter().map(|own| own.preset).collect();
        let (water, preset) = parse_own(&body, &others)?;
        let name = water.name.clone();
        let taken = || Problem::new(Slug::NameTaken, format!("there is a water `{name}` already"));
        if preset::find(&name).is_some() {
            return Err(taken());
        }
        let created_ms = app.clock.unix_ms();
        let row = WaterRow {
            name: name.clone(),
            description: water.description(),
            created_ms,
        };
        if !app.catalogue.insert_water(row).await? {
            return Err(taken());
        }
        let own = Own::new((water, preset), created_ms);
        app.waters.add(own.clone());
        tracing::info!(water = name, "water stored");
        Ok(own)
    });
    task.await.map_err(|error| Problem::internal(&error))?
}

/// Deletes a water. Jobs hold its numbers and go on.
pub(crate) async fn delete(app: &Shared, name: String) -> Result<(), Problem> {
    let app = Arc::clone(app);
    let task = tokio::spawn(async move {
        let _turn = app.waters.turn.lock().await;
        let there = app.catalogue.delete_water(&name).await?;
        app.waters.remove(&name);
        match (there, preset::find(&name)) {
            (true, _) => Ok(()),
            (false, Some(_)) => Err(Problem::not_found(format!(
                "water `{name}` comes with the service and stays"
            ))),
            (false, None) => Err(Problem::not_found(format!("no water `{name}`"))),
        }
    });
    task.await.map_err(|error| Problem::internal(&error))?
}
