//! The service as a whole: its start, the tasks beside the requests, and its end.

use std::fs::File;
use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use catalogue::CatalogueError;
use proto::limits::shorten;
use tokio::net::TcpListener;
use tokio::sync::{Mutex, Notify};
use tokio::task::{JoinError, JoinHandle};
use tokio_util::sync::CancellationToken;
use uuid::Uuid;

use crate::app::{App, Shared};
use crate::bytes::naming::Naming;
use crate::bytes::reclaim;
use crate::bytes::space::Space;
use crate::config::{Config, Surroundings};
use crate::data::{Data, DataError};
use crate::http::auth::{TokenError, Tokens};
use crate::http::listener;
use crate::jobs::control;
use crate::leases::changes::Watch;
use crate::leases::costs::Experience;
use crate::leases::dispatch::Dispatch;
use crate::leases::strikes;
use crate::processes::child::Children;
use crate::processes::compute::Compute;
use crate::processes::fleet::{Fleet, OnExit, Recipe};
use crate::styles::trainings::Trainings;
use crate::styles::{AddedStyleError, Styles};
use crate::waters::Waters;
use crate::{router, telemetry};

/// How often ended leases are looked for: a killed worker's frames are offered again this much after their term.
const EXPIRY_INTERVAL: Duration = Duration::from_millis(200);
/// How often silent workers are forgotten and the metrics recorder's histograms are tidied up.
const UPKEEP_INTERVAL: Duration = Duration::from_secs(5);

/// Why the service does not start.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// The token setting.
    #[error(transparent)]
    Token(#[from] TokenError),
    /// The data directory.
    #[error(transparent)]
    Data(#[from] DataError),
    /// The styles that were added earlier.
    #[error(transparent)]
    Styles(#[from] AddedStyleError),
    /// Jobs that were open cannot be read.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// The listen address.
    #[error("cannot listen on {address}: {source}")]
    Listen {
        /// The address.
        address: SocketAddr,
        /// What the system said.
        source: io::Error,
    },
}

/// A running service.
pub struct Service {
    address: SocketAddr,
    app: Shared,
    fleet: Fleet,
    /// Ends the tasks, after the workers have handed their leases back.
    end: CancellationToken,
    /// The server and what runs beside it.
    tasks: Vec<JoinHandle<()>>,
    _lock: File,
}

/// Starts a service on this machine.
///
/// # Errors
/// Whatever keeps it from answering requests.
pub async fn start(config: Config) -> Result<Service, StartError> {
    let surroundings = Surroundings::of_this_machine(&config);
    start_in(config, surroundings).await
}

/// Starts a service in given surroundings.
///
/// # Errors
/// Whatever keeps it from answering requests.
pub async fn start_in(config: Config, surroundings: Surroundings) -> Result<Service, StartError> {
    let mut tokens = Tokens::parse(config.token.as_deref(), config.listen)?;
    let worker_token = tokens.are_needed().then(random_secret);
    if let Some(secret) = &worker_token {
        tokens.add_worker(secret);
    }
    let limits = surroundings.limits;
    let (app, lock) = open(&config, surroundings).await?;
    let app = Arc::new(app);
    take_up_open_jobs(&app).await?;
    let listen = |source| StartError::Listen {
        address: config.listen,
        source,
    };
    let listener = TcpListener::bind(config.listen).await.map_err(listen)?;
    let address = listener.local_addr().map_err(listen)?;
    let end = CancellationToken::new();
    let router = router::router(Arc::clone(&app), &Arc::new(tokens), &limits);
    let tasks = vec![
        tokio::spawn(listener::serve(listener, router, limits, end.clone())),
        tokio::spawn(expire_leases(Arc::clone(&app), end.clone())),
        tokio::spawn(tidy_up(Arc::clone(&app), end.clone())),
        tokio::spawn(reclaim::run(Arc::clone(&app), end.clone())),
    ];
    let recipe = recipe(&config, address, worker_token);
    let fleet = Fleet::start(recipe, config.workers, &frames_back(&app));
    tracing::info!(%address, data = %config.data.display(), workers = config.workers, "service started");
    Ok(Service {
        address,
        app,
        fleet,
        end,
        tasks,
        _lock: lock,
    })
}

impl Service {
    /// Where it listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Ends it in order: waiting requests are answered, the service's workers hand their leases back and stop, open
    /// requests finish, the catalogue and the store are closed.
    ///
    /// # Errors
    /// A task of the service had failed before. Nothing that was acknowledged is lost.
    pub async fn stop(self) -> Result<(), JoinError> {
        self.app.stop.cancel();
        self.fleet.stop().await;
        self.end.cancel();
        let mut ended = Ok(());
        for task in self.tasks {
            ended = ended.and(task.await);
        }
        self.app.catalogue.close().await;
        self.app.store.close().await;
        tracing::info!("service stopped");
        ended
    }
}

async fn open(config: &Config, surroundings: Surroundings) -> Result<(App, File), StartError> {
    let metrics = renderer::vocabulary(&config.library, false).metrics;
    let Data {
        catalogue,
        store,
        lock,
    } = Data::open(&config.data, &metrics).await?;
    let waters = Waters::open(&catalogue).await?;
    let app = App {
        data: config.data.clone(),
        catalogue,
        store,
        dispatch: Dispatch::new(surroundings.clock.clone(), first_token()),
        watch: Watch::default(),
        experience: Experience::default(),
        compute: Compute::new(surroundings.limits.compute),
        children: Children::new(
            &config.worker_program,
            style_options(config),
            surroundings.limits.children,
        ),
        pictures: Compute::new(surroundings.limits.pictures),
        styles: Styles::open(&config.data, config.library.clone())?,
        trainings: Trainings::new(&config.worker_program, surroundings.limits.children),
        style_trial: config.style_trial,
        waters,
        style_runtime: surroundings.style_runtime,
        turn: Mutex::default(),
        upkeep: Mutex::default(),
        naming: Naming::default(),
        space: Arc::new(Space::of(&config.data, surroundings.limits.reserve_bytes)),
        reclaim: Notify::new(),
        clock: surroundings.clock,
        telemetry: telemetry::install(),
        stop: CancellationToken::new(),
    };
    Ok((app, lock))
}

/// Offers the frames that an earlier life of the service left open.
async fn take_up_open_jobs(app: &App) -> Result<(), StartError> {
    let jobs = app.catalogue.open_jobs().await?;
    if !jobs.is_empty() {
        tracing::info!(jobs = jobs.len(), "unfinished jobs are taken up again");
    }
    for job in jobs {
        let submitted_ms = job.row.created_ms;
        app.dispatch.add_job(control::entry(job), submitted_ms);
    }
    Ok(())
}

/// Tokens only grow, also from one life of the service to the next: the high half of a UUIDv7 is the time in
/// milliseconds and a random part.
fn first_token() -> u64 {
    Uuid::now_v7().as_u64_pair().0
}

/// A secret for the service's own workers, known to nobody else.
fn random_secret() -> String {
    format!("{}{}", Uuid::now_v7().simple(), Uuid::now_v7().simple())
}

/// Where processes of ours find styles and their runtime.
fn style_options(config: &Config) -> Vec<(&'static str, PathBuf)> {
    let options = [
        ("--styles", &config.styles),
        ("--onnxruntime", &config.onnxruntime),
    ];
    let given = options
        .into_iter()
        .filter_map(|(option, path)| Some((option, path.clone()?)));
    given.collect()
}

fn recipe(config: &Config, address: SocketAddr, token: Option<String>) -> Recipe {
    let host = match address.ip() {
        IpAddr::V4(ip) if ip.is_unspecified() => Ipv4Addr::LOCALHOST.into(),
        IpAddr::V6(ip) if ip.is_unspecified() => Ipv6Addr::LOCALHOST.into(),
        ip => ip,
    };
    let server = format!("http://{}", SocketAddr::new(host, address.port()));
    let slots = config.slots_per_worker.to_string();
    let mut arguments = vec![
        "worker",
        "--server",
        &server,
        "--slots",
        &slots,
        "--stop-with-stdin",
    ]
    .into_iter()
    .map(str::to_owned)
    .collect::<Vec<_>>();
    for (option, path) in style_options(config) {
        arguments.extend([option.to_owned(), path.display().to_string()]);
    }
    Recipe {
        program: config.worker_program.clone(),
        arguments,
        token,
    }
}

/// What happens when one of the service's workers has ended: its frames are offered again at once.
fn frames_back(app: &Shared) -> OnExit {
    let app = Arc::clone(app);
    Arc::new(move |name, tail| {
        let app = Arc::clone(&app);
        Box::pin(async move {
            let (registered, mut events) = app.dispatch.drop_workers_named(&name);
            for event in events.iter_mut().filter(|_| !tail.is_empty()) {
                event.error = shorten(&format!("{}; it printed last:\n{tail}", event.error));
            }
            strikes::record(&app, events).await;
            registered
        })
    })
}

async fn expire_leases(app: Shared, end: CancellationToken) {
    let mut ticks = tokio::time::interval(EXPIRY_INTERVAL);
    while end.run_until_cancelled(ticks.tick()).await.is_some() {
        strikes::record(&app, app.dispatch.expire()).await;
    }
}

async fn tidy_up(app: Shared, end: CancellationToken) {
    let mut ticks = tokio::time::interval(UPKEEP_INTERVAL);
    while end.run_until_cancelled(ticks.tick()).await.is_some() {
        app.dispatch.forget_workers();
        app.naming.tidy_up();
        app.telemetry.run_upkeep();
    }
}
