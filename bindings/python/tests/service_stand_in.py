"""A stand-in for a service or a proxy, which responds as a test requires."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

Reply = tuple[int, dict[str, str], bytes]


@dataclass
class StandIn:
    """Address and received requests."""

    address: str
    requests: list[tuple[str, str]] = field(default_factory=list)
    bodies: list[bytes] = field(default_factory=list)


def reply_json(status: int, body: Any, **headers: str) -> Reply:
    kind = "application/json" if status < 400 else "application/problem+json"
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    return status, {"content-type": kind} | named, json.dumps(body).encode()


LOCKED = reply_json(
    503, {"type": "/problems/overloaded", "title": "The service is too busy", "detail": "locked"}, retry_after="1"
)


@contextmanager
def serve(respond: Callable[[str, str, int], Reply]) -> Iterator[StandIn]:
    """Serve on a free port; `respond` receives method, target and the number of earlier requests."""

    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def handle_request(self) -> None:
            body = self.rfile.read(int(self.headers.get("content-length", 0)))
            status, headers, content = respond(self.command, self.path, len(stand_in.requests))
            stand_in.requests.append((self.command, self.path))
            stand_in.bodies.append(body)
            self.send_response(status)
            for name, value in (headers | {"content-length": str(len(content))}).items():
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(content)

        do_GET = do_POST = do_CONNECT = handle_request  # noqa: N815

        def log_message(self, format: str, *arguments: Any) -> None:
            pass

    class Server(ThreadingHTTPServer):
        daemon_threads = True
        block_on_close = False

    with Server(("127.0.0.1", 0), Handler) as server:
        stand_in = StandIn(f"http://127.0.0.1:{server.server_address[1]}")
        thread = threading.Thread(target=server.serve_forever, args=(0.02,), daemon=True)
        thread.start()
        try:
            yield stand_in
        finally:
            server.shutdown()
            thread.join()
