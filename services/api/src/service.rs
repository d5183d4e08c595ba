//! The service as a whole: start, background tasks, shutdown.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;

use tokio::net::TcpListener;
use tokio::task::{JoinError, JoinHandle};
use tokio_util::sync::CancellationToken;
use wire::limits::shorten;

use crate::app::{App, StartError};
use crate::bytes::{reclaim, unnamed};
use crate::clock::ordered_id;
use crate::config::{Config, Surroundings};
use crate::data::FolderLock;
use crate::http::auth::Tokens;
use crate::http::hosts::Hosts;
use crate::http::listener;
use crate::images::heal;
use crate::jobs::{machines, probe};
use crate::leases::Leases;
use crate::operations::replica;
use crate::operations::routes::backup;
use crate::processes::fleet::{Fleet, OnExit, Recipe};
use crate::router;

/// Interval of collecting expired leases.
const EXPIRY_INTERVAL: Duration = Duration::from_millis(200);
/// Interval of dropping expired metrics and digest protections.
const UPKEEP_INTERVAL: Duration = Duration::from_secs(5);

/// A running service.
pub struct Service {
    address: SocketAddr,
    app: App,
    fleet: Fleet,
    /// Ends the tasks, after the workers have returned their leases.
    end: CancellationToken,
    /// The server and the background tasks.
    tasks: Vec<JoinHandle<()>>,
    _lock: FolderLock,
}

/// Starts a service on this machine.
///
/// # Errors
/// [`StartError`] if the service cannot serve requests.
pub async fn start(config: Config) -> Result<Service, StartError> {
    let surroundings = Surroundings::of_this_machine(&config);
    start_in(config, surroundings).await
}

/// Starts a service in given surroundings.
///
/// # Errors
/// [`StartError`] if the service cannot serve requests.
pub async fn start_in(config: Config, surroundings: Surroundings) -> Result<Service, StartError> {
    let mut tokens = Tokens::parse(config.token.as_deref(), config.listen)?;
    let (are_tokens_needed, own_secret) = (tokens.are_needed(), random_secret());
    tokens.add_own_worker(&own_secret);
    let limits = surroundings.limits;
    let (app, lock) = App::open(&config, &surroundings).await?;
    if let Err(error) = backup::clear_unfinished(&config.data) {
        tracing::warn!(%error, "could not remove unfinished backups");
    }
    app.jobs.resume_all().await?;
    app.sets.resume_all().await?;
    let bound = TcpListener::bind(config.listen).await;
    let bound = bound.and_then(|listener| Ok((listener.local_addr()?, listener)));
    let (address, listener) = bound.map_err(|source| StartError::Listen {
        address: config.listen,
        source,
    })?;
    let end = CancellationToken::new();
    let hosts = Hosts::new(are_tokens_needed, &config.hosts);
    let router = router::router(app.clone(), &Arc::new(tokens), hosts, &limits);
    let tasks = vec![
        tokio::spawn(listener::serve(listener, router, limits, end.clone())),
        tokio::spawn(expire_leases(Arc::clone(&app.leases), end.clone())),
        tokio::spawn(tidy_up(app.clone(), end.clone())),
        tokio::spawn(reclaim::run(Arc::clone(&app.bytes), end.clone())),
        tokio::spawn(unnamed::run(Arc::clone(&app.bytes), limits.unnamed, end.clone())),
        tokio::spawn(replica::run(Arc::clone(&app.catalogue), end.clone())),
        tokio::spawn(Arc::clone(&app.sets).show_shared()),
        tokio::spawn(heal::run(Arc::clone(&app.images), end.clone())),
        tokio::spawn(probe::run(Arc::clone(&app.jobs), end.clone())),
        tokio::spawn(machines::run(Arc::clone(&app.jobs), end.clone())),
    ];
    let recipe = recipe(&config, address, own_secret);
    let fleet = Fleet::start(recipe, config.workers, &frames_back(&app.leases));
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
    /// The listen address.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Stops the service in order: waiting requests get their response, the service's workers return their leases and
    /// stop, open requests finish, the catalogue and the store are closed.
    ///
    /// # Errors
    /// A task of the service had failed before. No acknowledged data is lost.
    pub async fn stop(self) -> Result<(), JoinError> {
        self.app.stop.cancel();
        self.fleet.stop().await;
        self.end.cancel();
        let mut ended = Ok(());
        for task in self.tasks {
            ended = ended.and(task.await);
        }
        self.app.catalogue.close().await;
        self.app.bytes.store.close().await;
        tracing::info!("service stopped");
        ended
    }
}

/// A secret shared only by the service and its workers.
fn random_secret() -> String {
    format!("{}{}", ordered_id().simple(), ordered_id().simple())
}

fn recipe(config: &Config, address: SocketAddr, token: String) -> Recipe {
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
    for (option, path) in config.style_options() {
        arguments.extend([option.to_owned(), path.display().to_string()]);
    }
    arguments.extend([
        "--frame-limit-s".to_owned(),
        config.frame_limit.as_secs_f64().to_string(),
    ]);
    Recipe {
        program: config.program.clone(),
        arguments,
        token: Some(token),
    }
}

/// Offers the frames of one of the service's workers again as soon as its process has ended.
fn frames_back(leases: &Arc<Leases>) -> OnExit {
    let leases = Arc::clone(leases);
    Arc::new(move |name, tail| {
        let leases = Arc::clone(&leases);
        Box::pin(async move {
            let (registered, mut events) = leases.dispatch.drop_workers_named(&name);
            for event in events.iter_mut().filter(|_| !tail.is_empty()) {
                event.error = shorten(&format!("{}; it printed last:\n{tail}", event.error));
            }
            leases.record_strikes(events).await;
            registered
        })
    })
}

async fn expire_leases(leases: Arc<Leases>, end: CancellationToken) {
    let mut ticks = tokio::time::interval(EXPIRY_INTERVAL);
    while end.run_until_cancelled(ticks.tick()).await.is_some() {
        leases.record_strikes(leases.dispatch.expire()).await;
    }
}

async fn tidy_up(app: App, end: CancellationToken) {
    let mut ticks = tokio::time::interval(UPKEEP_INTERVAL);
    while end.run_until_cancelled(ticks.tick()).await.is_some() {
        app.bytes.naming.tidy_up();
        app.leases
            .pending
            .drop_ended(|token| app.leases.dispatch.has_lease(token));
        let dispatch = &app.leases.dispatch;
        app.leases
            .probes
            .retain_registered(|worker| dispatch.has_worker(worker));
        app.leases
            .proofs
            .retain_registered(|worker| dispatch.has_worker(worker));
    }
}
