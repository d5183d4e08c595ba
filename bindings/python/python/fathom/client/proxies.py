"""Proxies of the environment, with the rules of the command line.

httpx reads the same variables, but ignores networks in `no_proxy` and fails on a SOCKS proxy that `no_proxy` excludes.
"""

from __future__ import annotations

import importlib.util
import ipaddress
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass

import httpx

from fathom.errors import FathomError

_PASSWORD = re.compile(r"(?<=://)([^/@]*):[^/@]*@")
_HOST_AND_PORT = re.compile(r"(?:\[(?P<v6>[^\]]*)\]|(?P<host>[^:]*))(?::(?P<port>\d+))?")


@dataclass(frozen=True)
class Proxy:
    """A proxy and the variable of the environment that names it."""

    variable: str
    address: str
    target: str
    """Host of the service."""

    def __str__(self) -> str:
        return f"the proxy {hide_password(self.address)} of `{self.variable}`"

    @property
    def remedy(self) -> str:
        """Instruction to connect without the proxy."""
        return f"add `{self.target}` to `no_proxy` to connect directly"

    def settings(self) -> httpx.Proxy:
        """Return the settings of httpx. Raises `FathomError` for an address that cannot be used."""
        address = self.address if "://" in self.address else f"http://{self.address}"
        scheme = address.partition("://")[0].lower()
        if scheme.startswith("socks"):
            self._check_socks(scheme)
        try:
            proxy = httpx.Proxy(address)
            is_valid = bool(proxy.url.host)
        except (ValueError, httpx.InvalidURL):
            is_valid = False
        if not is_valid:
            value = hide_password(self.address)
            raise FathomError(
                f"`{self.variable}` is `{value}`; must be a URL such as http://host:3128; correct or unset the variable"
            )
        return proxy

    def _check_socks(self, scheme: str) -> None:
        value = f"`{self.variable}` is {hide_password(self.address)}"
        if scheme not in ("socks5", "socks5h"):
            raise FathomError(f"{value}; `{scheme}` proxies are not supported; use an http:// proxy, or {self.remedy}")
        if importlib.util.find_spec("socksio") is None:
            raise FathomError(
                f"{value}; SOCKS proxies need the package socksio: pip install 'httpx[socks]'; "
                f"or use an http:// proxy, or {self.remedy}"
            )


def find_proxy(server: str, environment: Mapping[str, str] | None = None) -> Proxy | None:
    """Return the proxy for the URL of a service; `None` for loopback addresses and those of `no_proxy`."""
    variables = os.environ if environment is None else environment
    url = httpx.URL(server)
    host = url.host.lower()
    port = url.port or (443 if url.scheme == "https" else 80)
    excepted = _read(variables, "no_proxy")
    if is_loopback(host) or (excepted and is_listed(host, port, excepted[1])):
        return None
    found = _read(variables, f"{url.scheme}_proxy") or _read(variables, "all_proxy")
    return Proxy(*found, target=host) if found else None


def is_loopback(host: str) -> bool:
    """Return whether a host is this machine."""
    address = _parse_address(host)
    if address is None:
        return host == "localhost" or host.endswith(".localhost")
    mapped = getattr(address, "ipv4_mapped", None) or address
    return address.is_loopback or address.is_unspecified or mapped.is_loopback


def is_listed(host: str, port: int, entries: str) -> bool:
    """Return whether a list of names, addresses and networks, separated by commas or spaces, contains the host."""
    return any(_fits(host, port, entry.lower()) for entry in re.split(r"[,;\s]+", entries) if entry)


def hide_password(address: str) -> str:
    """Return the URL without its password."""
    return _PASSWORD.sub(r"\1:***@", address)


def _fits(host: str, port: int, entry: str) -> bool:
    if entry == "*":
        return True
    address = _parse_address(host)
    if address is not None and "/" in entry:
        try:
            return address in ipaddress.ip_network(entry.replace("[", "").replace("]", ""), strict=False)
        except ValueError:
            return False
    other = _parse_address(entry)
    if other is None and (parts := _HOST_AND_PORT.fullmatch(entry)):
        if parts["port"] and int(parts["port"]) != port:
            return False
        entry = parts["v6"] or parts["host"] or ""
        other = _parse_address(entry)
    if address is not None and other is not None:
        return address == other
    name = entry.lstrip("*").lstrip(".")
    return bool(name) and (host == name or host.endswith(f".{name}"))


def _parse_address(text: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    try:
        return ipaddress.ip_address(text.strip("[]"))
    except ValueError:
        return None


def _read(variables: Mapping[str, str], name: str) -> tuple[str, str] | None:
    """Return the name and the value of a variable in lower or upper case."""
    for variable in (name, name.upper()):
        value = variables.get(variable, "").strip()
        if value:
            return variable, value
    return None
