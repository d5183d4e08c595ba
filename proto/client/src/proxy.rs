//! Proxies of the environment. Loopback addresses and those of `no_proxy` are connected directly.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr};

use ureq::Proxy;

/// The proxy for a URL by the environment variables `http_proxy`, `https_proxy`, `all_proxy` and `no_proxy`, in lower or
/// upper case. `None` for loopback addresses.
///
/// # Errors
/// [`InvalidProxy`]: the variable has no URL of a proxy.
pub fn choose_proxy(url: &str) -> Result<Option<Proxy>, InvalidProxy> {
    let read = |name: &str| {
        let variables = [name.to_owned(), name.to_ascii_uppercase()];
        let values = variables
            .iter()
            .filter_map(|variable| std::env::var(variable).ok());
        values.into_iter().find(|value| !value.trim().is_empty())
    };
    let Some(address) = find_proxy(url, read) else {
        return Ok(None);
    };
    if address.trim().to_ascii_lowercase().starts_with("socks") {
        return Err(InvalidProxy::Socks { address });
    }
    match Proxy::new(&address) {
        Ok(proxy) if has_valid_port(&address) => Ok(Some(proxy)),
        _ => Err(InvalidProxy::NoUrl { address }),
    }
}

/// Whether the port of a proxy is a number or absent. `ureq` replaces any other text by 80.
fn has_valid_port(address: &str) -> bool {
    let rest = address.split_once("://").map_or(address, |(_, rest)| rest);
    let authority = rest.split(['/', '?', '#']).next().unwrap_or_default();
    let server = authority.rsplit_once('@').map_or(authority, |(_, server)| server);
    let port = server.rsplit_once(']').map_or(server, |(_, port)| port);
    port.split_once(':')
        .is_none_or(|(_, port)| port.is_empty() || port.parse::<u16>().is_ok())
}

/// A variable of the environment that has no usable proxy.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum InvalidProxy {
    /// Its value is not a URL.
    #[error(
        "the proxy `{address}` of the environment is not a URL such as http://host:3128; correct or unset the variable"
    )]
    NoUrl {
        /// The value of the variable.
        address: String,
    },
    /// Its protocol is SOCKS.
    #[error(
        "the proxy `{address}` of the environment uses SOCKS, which fathom does not; unset the variable, set http_proxy to an HTTP proxy, or list the server in no_proxy"
    )]
    Socks {
        /// The value of the variable.
        address: String,
    },
}

impl From<InvalidProxy> for ureq::Error {
    fn from(error: InvalidProxy) -> Self {
        Self::Other(Box::new(error))
    }
}

/// The proxy of an environment as text.
fn find_proxy(url: &str, read: impl Fn(&str) -> Option<String>) -> Option<String> {
    let target = Target::parse(url)?;
    let is_excepted = target.is_loopback() || read("no_proxy").is_some_and(|list| target.is_listed(&list));
    if is_excepted {
        return None;
    }
    let own = match url.starts_with("https:") {
        true => read("https_proxy"),
        false => read("http_proxy"),
    };
    own.or_else(|| read("all_proxy"))
}

/// Host and port of a URL.
struct Target {
    host: String,
    port: u16,
}

impl Target {
    fn parse(url: &str) -> Option<Self> {
        let (scheme, rest) = url.split_once("://")?;
        let authority = rest.split(['/', '?', '#']).next()?;
        let authority = authority.rsplit_once('@').map_or(authority, |(_, host)| host);
        let usual = if scheme == "https" { 443 } else { 80 };
        let (host, port) = split_port(authority);
        Some(Self {
            host: host.to_ascii_lowercase(),
            port: port.unwrap_or(usual),
        })
    }

    fn is_loopback(&self) -> bool {
        match self.host.parse::<IpAddr>() {
            Ok(IpAddr::V4(address)) => address.is_loopback() || address.is_unspecified(),
            Ok(IpAddr::V6(address)) => {
                let mapped = address.to_ipv4_mapped();
                address.is_loopback()
                    || address.is_unspecified()
                    || mapped.is_some_and(|address| address.is_loopback())
            }
            Err(_) => self.host == "localhost" || self.host.ends_with(".localhost"),
        }
    }

    /// Whether a list of names, addresses and networks, separated by commas or spaces, contains the host.
    fn is_listed(&self, list: &str) -> bool {
        let entries = list.split([',', ' ', ';']).map(str::trim);
        let mut entries = entries.filter(|entry| !entry.is_empty());
        entries.any(|entry| self.fits(&entry.to_ascii_lowercase()))
    }

    fn fits(&self, entry: &str) -> bool {
        if entry == "*" {
            return true;
        }
        let address = self.host.parse::<IpAddr>().ok();
        if let (Some(address), Some((network, bits))) = (address, entry.split_once('/')) {
            let network = network.trim_matches(['[', ']']).parse();
            return network.is_ok_and(|network| is_in_network(address, network, bits));
        }
        let (name, port) = split_port(entry);
        if port.is_some_and(|port| port != self.port) {
            return false;
        }
        if let (Some(address), Ok(other)) = (address, name.parse::<IpAddr>()) {
            return address == other;
        }
        let name = name.trim_start_matches('*').trim_start_matches('.');
        let rest = self.host.strip_suffix(name);
        !name.is_empty() && rest.is_some_and(|rest| rest.is_empty() || rest.ends_with('.'))
    }
}

/// Splits `host:port`. An IPv6 address with a port has brackets.
fn split_port(authority: &str) -> (&str, Option<u16>) {
    if let Some((host, rest)) = authority.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
        return (host, rest.strip_prefix(':').and_then(|port| port.parse().ok()));
    }
    match authority.split_once(':') {
        Some((host, port)) if !port.contains(':') => (host, port.parse().ok()),
        _ => (authority, None),
    }
}

fn is_in_network(address: IpAddr, network: IpAddr, bits: &str) -> bool {
    let Ok(bits) = bits.parse::<u32>() else {
        return false;
    };
    let has_prefix = |one: u128, other: u128, width: u32| {
        bits <= width && (bits == 0 || (one ^ other) >> (width - bits) == 0)
    };
    let v4 = |address: Ipv4Addr| u128::from(u32::from(address));
    match (address, network) {
        (IpAddr::V4(address), IpAddr::V4(network)) => has_prefix(v4(address), v4(network), 32),
        (IpAddr::V6(address), IpAddr::V6(network)) => {
            let number = |address: Ipv6Addr| u128::from(address);
            has_prefix(number(address), number(network), 128)
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn proxy(url: &str, no_proxy: &str) -> Option<String> {
        find_proxy(url, |name| match name {
            "http_proxy" => Some("http://proxy:1".to_owned()),
            "https_proxy" => Some("http://proxy:2".to_owned()),
            "no_proxy" => Some(no_proxy.to_owned()),
            _ => None,
        })
    }

    #[test]
    fn loopback_has_no_proxy_whatever_the_environment_contains() {
        for url in [
            "http://127.0.0.1:7311",
            "http://127.9.9.9/v1",
            "http://localhost:7311",
            "http://a.localhost",
            "http://[::1]:7311",
            "http://[::ffff:127.0.0.1]",
            "http://0.0.0.0:7311",
            "http://user:word@localhost",
        ] {
            assert_eq!(proxy(url, ""), None, "{url}");
        }
        assert_eq!(proxy("http://lab:7311", "").as_deref(), Some("http://proxy:1"));
        assert_eq!(proxy("https://lab", "").as_deref(), Some("http://proxy:2"));
    }

    #[test]
    fn a_port_is_a_number() {
        for (address, is_valid) in [
            ("http://lab:3128", true),
            ("lab", true),
            ("http://user:word@lab:3128/", true),
            ("http://[fd00::7]:80", true),
            ("socks5://lab:1080", true),
            ("lab:port", false),
            ("http://[fd00::7]:x", false),
            ("http://lab:70000", false),
        ] {
            assert_eq!(has_valid_port(address), is_valid, "{address}");
        }
    }

    #[test]
    fn exceptions_are_names_addresses_and_networks() {
        for (url, list, has_proxy) in [
            ("http://10.1.2.3", "10.0.0.0/8", false),
            ("http://11.1.2.3", "10.0.0.0/8", true),
            ("http://10.1.2.3:80", "10.1.2.3", false),
            ("http://10.1.2.3:81", "10.1.2.3:80", true),
            ("http://[fd00::7]:80", "fd00::/8", false),
            ("http://[fd00::7]", "fd00::7", false),
            ("http://store.lab.example", "lab.example", false),
            ("http://store.lab.example", ".lab.example", false),
            ("http://store.lab.example", "*.lab.example", false),
            ("http://mylab.example", "lab.example", true),
            ("http://Lab.Example", "other, lab.example", false),
            ("http://lab.example:8080", "lab.example:8080", false),
            ("http://lab.example:8081", "lab.example:8080", true),
            ("http://anything", "*", false),
            ("http://10.1.2.3", "0.0.0.0/0", false),
            ("http://10.1.2.3", "10.0.0.0/99", true),
        ] {
            assert_eq!(proxy(url, list).is_some(), has_proxy, "{url} {list}");
        }
    }
}
