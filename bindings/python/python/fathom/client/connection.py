"""Address of a service, errors of its connection and pauses between attempts, shared by both clients."""

from __future__ import annotations

import os
import time
from typing import Any

import httpx

from fathom.client.proxies import find_proxy, hide_password
from fathom.errors import FathomError, InvalidJob, Problem, Unreachable

SERVER = "http://127.0.0.1:7311"
TIMEOUT = httpx.Timeout(90, connect=5)
"""Longer than the service holds a request back: beyond it the connection is dead."""
VERIFY_TIMEOUT = httpx.Timeout(330, connect=5)
"""Longer than the service reads the bytes of a version, five minutes."""
PATIENCE_S = 60.0
"""How long a request is repeated while the service is overloaded or its catalogue is locked."""
LONGEST_PAUSE_S = 10.0
"""Longest pause between two attempts, even if the service requests a longer one."""


class Connection:
    """Address and token of a service, and the proxy to it."""

    def __init__(self, server: str | None, token: str | None) -> None:
        """Read the environment for absent values. Raises `FathomError` for an invalid address or proxy."""
        given = server or os.environ.get("FATHOM_SERVER") or SERVER
        self.server = (given if "://" in given else f"http://{given}").rstrip("/")
        self.token = token or os.environ.get("FATHOM_TOKEN")
        try:
            url = httpx.URL(self.server)
            is_valid = url.scheme in ("http", "https") and bool(url.host)
        except httpx.InvalidURL:
            is_valid = False
        if not is_valid:
            raise FathomError(f"the server is `{given}`; must be a URL such as {SERVER}")
        self.proxy = find_proxy(self.server)
        self._proxy_settings = self.proxy and self.proxy.settings()

    @property
    def name(self) -> str:
        """The address without a password."""
        return hide_password(self.server)

    def options(self) -> dict[str, Any]:
        """Return the options of httpx's client."""
        headers = {"Authorization": f"Bearer {self.token}"} if self.token else {}
        return {"base_url": self.server, "headers": headers, "timeout": TIMEOUT}

    def transport_options(self) -> dict[str, Any]:
        """Return the options of httpx's transport. With a transport of its own httpx reads no proxy variables."""
        return {"proxy": self._proxy_settings}

    def check(self, response: httpx.Response) -> httpx.Response:
        """Return a response of success. Raises `Problem`, for a description `InvalidJob`."""
        if response.status_code < 400:
            return response
        try:
            body = response.json()
        except ValueError:
            body = None
        if not isinstance(body, dict):
            if self.proxy:
                status = f"{response.status_code} {response.reason_phrase}".strip()
                raise Unreachable(f"{self.proxy} responded with {status} for {self.name}; {self.proxy.remedy}")
            body = {"title": response.text[:200]} if response.text else {}
        is_invalid = str(body.get("type", "")).endswith("/validation")
        raise (InvalidJob if is_invalid else Problem)(response.status_code, body)

    def unreachable(self, error: httpx.RequestError) -> Unreachable:
        """Return the exception of a request without a response."""
        reason = str(error) or type(error).__name__
        if self.proxy:
            return Unreachable(
                f"no service responds at {self.name} through {self.proxy}: {reason}; {self.proxy.remedy}"
            )
        if "CERTIFICATE_VERIFY_FAILED" in reason:
            remedy = "set SSL_CERT_FILE to the certificate of the authority that signed the service's"
        elif isinstance(error, (httpx.ConnectError, httpx.ConnectTimeout)):
            remedy = "start one with `fathom serve`, or correct the address"
        else:
            return Unreachable(f"the connection to {self.name} broke off: {reason}; repeat the request")
        return Unreachable(f"no service responds at {self.name}: {reason}; {remedy}")


class Attempts:
    """Attempts at one request. A service that responds with 503 and `Retry-After` has not begun the request."""

    def __init__(self, patience_s: float) -> None:
        self._deadline = time.monotonic() + patience_s

    def pause_s(self, response: httpx.Response) -> float | None:
        """Return the pause before the next attempt, `None` if this response is final."""
        if response.status_code not in (429, 503) or "retry-after" not in response.headers:
            return None
        try:
            pause = float(response.headers["retry-after"])
        except ValueError:
            # A date, which no version of the service sends.
            pause = 1.0
        pause = min(max(pause, 0.05), LONGEST_PAUSE_S)
        left = self._deadline - time.monotonic()
        return None if left <= 0 else min(pause, left)
