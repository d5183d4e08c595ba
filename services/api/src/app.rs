//! State of a running service, composed of its topics.

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;

use axum::extract::FromRef;
use catalogue::{Catalogue, CatalogueError};
use tokio_util::sync::CancellationToken;

use crate::bytes::Bytes;
use crate::bytes::sets::SetFiles;
use crate::config::{Config, Surroundings};
use crate::data::{Data, DataError, FolderLock};
use crate::datasets::Datasets;
use crate::engine::Engine;
use crate::http::auth::TokenError;
use crate::http::budget::Share;
use crate::images::Images;
use crate::jobs::Jobs;
use crate::jobs::prices::Prices;
use crate::leases::probes::Probes;
use crate::leases::proofs::Proofs;
use crate::leases::{Checks, Leases};
use crate::limits::Limits;
use crate::operations::Operations;
use crate::pictures::Pictures;
use crate::processes::Processes;
use crate::processes::child::Children;
use crate::processes::compute::Compute;
use crate::processes::decoding::Decoding;
use crate::processes::lasting::Lasting;
use crate::processes::live::Live;
use crate::processes::pictures::PictureProcess;
use crate::processes::scratch::Scratch;
use crate::scenes::Scenes;
use crate::sets::Sets;
use crate::styles::{AddedStyleError, Styles};
use crate::waters::Waters;

/// Why the service does not start.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// Invalid token setting.
    #[error(transparent)]
    Token(#[from] TokenError),
    /// The data folder cannot be opened.
    #[error(transparent)]
    Data(#[from] DataError),
    /// The added styles cannot be loaded.
    #[error(transparent)]
    Styles(#[from] AddedStyleError),
    /// The folder for temporary files cannot be emptied.
    #[error("cannot empty the folder `tmp` of the data folder: {0}")]
    Scratch(std::io::Error),
    /// Open jobs cannot be read.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// The listen address cannot be used.
    #[error("cannot listen on {address}: {source}")]
    Listen {
        /// The address.
        address: SocketAddr,
        /// Error of the operating system.
        source: io::Error,
    },
}

/// The state of each topic.
#[derive(Clone, FromRef)]
pub(crate) struct App {
    pub(crate) catalogue: Arc<Catalogue>,
    pub(crate) bytes: Arc<Bytes>,
    pub(crate) leases: Arc<Leases>,
    pub(crate) images: Arc<Images>,
    pub(crate) jobs: Arc<Jobs>,
    pub(crate) sets: Arc<Sets>,
    pub(crate) scenes: Arc<Scenes>,
    pub(crate) datasets: Arc<Datasets>,
    pub(crate) waters: Arc<Waters>,
    pub(crate) styles: Arc<Styles>,
    pub(crate) pictures: Arc<Pictures>,
    pub(crate) operations: Arc<Operations>,
    /// Cancelled when the service stops; waiting requests then return their current result.
    pub(crate) stop: CancellationToken,
}

impl App {
    /// Opens the data folder, which stays locked while the file is open.
    pub(crate) async fn open(
        config: &Config,
        surroundings: &Surroundings,
    ) -> Result<(Self, FolderLock), StartError> {
        let Surroundings { clock, limits, .. } = surroundings;
        let stop = CancellationToken::new();
        let metrics = renderer::vocabulary(&config.library, false).metrics;
        let Data {
            catalogue,
            store,
            lock,
        } = Data::open(&config.data, &metrics).await?;
        let catalogue = Arc::new(catalogue);
        let sets = SetFiles::new(config.buckets.clone());
        let bytes = Bytes::new(
            store,
            sets,
            Arc::clone(&catalogue),
            &config.data,
            limits.reserve_bytes,
        );
        let bytes = Arc::new(bytes);
        let scratch = Scratch::open(&config.data).map_err(StartError::Scratch)?;
        let processes = Arc::new(new_processes(config, limits, scratch));
        let waters = Arc::new(Waters::open(Arc::clone(&catalogue), clock.clone()).await?);
        let styles = Styles::open(
            config,
            surroundings,
            Arc::clone(&bytes),
            Arc::clone(&processes),
            stop.clone(),
        )?;
        let styles = Arc::new(styles);
        let leases = Arc::new(Leases::new(
            Arc::clone(&catalogue),
            Arc::clone(&bytes),
            clock.clone(),
            config.rules(surroundings.style_runtime.as_ref().ok()),
            Checks {
                own: Probes::new(config.spot_check),
                outside: Proofs::new(config.spot_check, catalogue.check_key().await?),
            },
            stop.clone(),
        ));
        let images = Arc::new(Images {
            catalogue: Arc::clone(&catalogue),
            bytes: Arc::clone(&bytes),
            processes: Arc::clone(&processes),
            data: config.data.clone(),
        });
        let jobs = Arc::new(Jobs {
            catalogue: Arc::clone(&catalogue),
            leases: Arc::clone(&leases),
            bytes: Arc::clone(&bytes),
            images: Arc::clone(&images),
            styles: Arc::clone(&styles),
            waters: Arc::clone(&waters),
            processes: Arc::clone(&processes),
            prices: Prices::new(config.prices),
            engine: new_engine(config),
            turn: Default::default(),
            clock: clock.clone(),
            stop: stop.clone(),
        });
        let sets = Sets::new(Arc::clone(&jobs), &config.program, &config.stores);
        let app = Self {
            jobs,
            sets: Arc::new(sets),
            scenes: Arc::new(Scenes {
                catalogue: Arc::clone(&catalogue),
                bytes: Arc::clone(&bytes),
                processes: Arc::clone(&processes),
                clock: clock.clone(),
            }),
            datasets: Arc::new(Datasets {
                catalogue: Arc::clone(&catalogue),
                images: Arc::clone(&images),
                processes: Arc::clone(&processes),
                clock: clock.clone(),
            }),
            pictures: Arc::new(Pictures(Arc::clone(&processes))),
            operations: Arc::new(Operations {
                data: config.data.clone(),
                catalogue: Arc::clone(&catalogue),
                bytes: Arc::clone(&bytes),
                leases: Arc::clone(&leases),
                styles: Arc::clone(&styles),
                processes,
                stop: stop.clone(),
            }),
            catalogue,
            bytes,
            leases,
            images,
            waters,
            styles,
            stop,
        };
        Ok((app, lock))
    }
}

fn new_processes(config: &Config, limits: &Limits, scratch: Scratch) -> Processes {
    let scratch = Arc::new(scratch);
    let program = &config.program;
    let share = Share {
        percent: limits.caller_percent,
    };
    Processes {
        compute: Compute::new(limits.compute),
        children: Children::new(program, config.style_options(), limits.children),
        decoding: Decoding::new(
            program,
            Arc::clone(&scratch),
            limits.uploads + limits.pictures,
            limits.decoding_mib,
        ),
        scratch,
        live: (config.workers > 0).then(|| {
            Live::new(
                || Lasting::new(program, "live", &config.data, config.style_options()),
                config.workers.saturating_mul(config.slots_per_worker),
                share,
            )
        }),
        pictures: (config.workers > 0)
            .then(|| PictureProcess::new(program, &config.data, config.style_options(), share)),
    }
}

fn new_engine(config: &Config) -> Option<Engine> {
    let (options, store) = config.engine.clone().zip(config.stores.first())?;
    Some(Engine::new(&config.program, store, options))
}
