//! The options that name a broker, which `fathom render` and `fathom worker` share.

/// The broker that distributes shards to workers.
#[derive(Debug, Clone, clap::Args)]
pub struct EngineArguments {
    /// Broker that distributes shards to workers: nats://HOST, several separated by commas
    #[arg(long, env = "FATHOM_ENGINE", value_name = "URL", hide_env_values = true)]
    pub engine: Option<String>,
    /// Token for the broker, if it requires one
    #[arg(
        long,
        env = "FATHOM_ENGINE_TOKEN",
        hide_env_values = true,
        requires = "engine"
    )]
    pub engine_token: Option<String>,
    /// Seconds without a heartbeat before a worker's shard is reassigned
    #[arg(long, default_value_t = 60.0, value_parser = lease_seconds, requires = "engine")]
    pub lease_s: f64,
    /// Servers of the broker that keep a copy of each message
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=5), requires = "engine")]
    pub replicas: u8,
}

/// A lease is renewed four times before it ends, over a network that may be slow.
fn lease_seconds(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    if (1.0..=3600.0).contains(&value) {
        Ok(value)
    } else {
        Err("must be 1 to 3600 s".to_owned())
    }
}
