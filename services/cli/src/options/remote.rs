//! The options that name a service.

use client::Client;

use crate::table::escape_cell;

/// Where `fathom serve` listens by default.
pub const LOCAL_SERVICE: &str = "http://127.0.0.1:7311";

/// The URL of a service, whose scheme may be left out.
fn server_url(text: &str) -> Result<String, String> {
    match text.split_once("://") {
        Some(("http" | "https", _)) | None => Ok(text.to_owned()),
        Some((scheme, _)) => Err(format!("the scheme is {scheme}; must be http or https")),
    }
}

/// The service to use.
#[derive(Debug, Clone, clap::Args)]
pub struct ServerArguments {
    /// Base URL of the service.
    #[arg(long, env = "FATHOM_SERVER", default_value = LOCAL_SERVICE, value_parser = server_url)]
    pub server: String,
    /// Bearer token, if the service requires one.
    #[arg(long, env = "FATHOM_TOKEN", hide_env_values = true)]
    pub token: Option<String>,
}

impl ServerArguments {
    /// A client of the service.
    pub fn client(&self) -> Client {
        Client::new(&self.server, self.token.as_deref()).with_damage_report(report_damage)
    }

    /// A client for requests that may take the service up to an hour.
    pub fn patient_client(&self) -> Client {
        Client::with_patience(&self.server, self.token.as_deref()).with_damage_report(report_damage)
    }
}

/// A service to use in place of this program itself.
#[derive(Debug, Clone, clap::Args)]
pub struct OtherServer {
    /// Use a service instead of this program [URL: FATHOM_SERVER, or else http://127.0.0.1:7311]
    #[arg(long, value_name = "URL", num_args = 0..=1, value_parser = server_url)]
    server: Option<Option<String>>,
    /// Bearer token, if the service requires one.
    #[arg(long, env = "FATHOM_TOKEN", hide_env_values = true)]
    token: Option<String>,
}

impl OtherServer {
    /// A client of the service; `None` without `--server`.
    pub fn client(&self) -> Option<Client> {
        let server = self
            .server
            .clone()?
            .or_else(|| std::env::var("FATHOM_SERVER").ok())
            .unwrap_or_else(|| LOCAL_SERVICE.to_owned());
        Some(Client::new(&server, self.token.as_deref()).with_damage_report(report_damage))
    }
}

/// Warns about damaged rows that a list leaves out.
fn report_damage(damaged: &[String]) {
    for what in damaged {
        let what = escape_cell(what);
        eprintln!(
            "left out: {what} is damaged; the service restores images, `fathom scrub` lists all damage"
        );
    }
}
