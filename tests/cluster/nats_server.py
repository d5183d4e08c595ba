"""NATS servers with JetStream, started, killed and wiped by the tests."""

from __future__ import annotations

import shutil
import signal
import socket
import subprocess
import time
from pathlib import Path

from harness import free_port


class NatsServer:
    """One server; with peers it is a member of a cluster."""

    def __init__(self, folder: Path, name: str = "one", port: int | None = None, routes: dict[str, int] | None = None):
        self.folder = folder / name
        self.folder.mkdir(parents=True)
        self.name = name
        self.port = port or free_port()
        self.routes = routes or {}
        self.process: subprocess.Popen[bytes] | None = None

    @property
    def url(self) -> str:
        return f"nats://127.0.0.1:{self.port}"

    def start(self) -> "NatsServer":
        config = [
            f"listen: 127.0.0.1:{self.port}",
            f"server_name: {self.name}",
            f'jetstream {{ store_dir: "{self.folder / "data"}", sync_interval: always }}',
        ]
        if self.routes:
            routes = ", ".join(f"nats://127.0.0.1:{port}" for name, port in self.routes.items() if name != self.name)
            config.append(f"cluster {{ name: fathom, listen: 127.0.0.1:{self.routes[self.name]}, routes: [{routes}] }}")
        (self.folder / "nats.conf").write_text("\n".join(config) + "\n")
        log = (self.folder / "log").open("ab")
        command = ["nats-server", "-c", str(self.folder / "nats.conf")]
        self.process = subprocess.Popen(command, stdout=log, stderr=log)
        self._wait()
        return self

    def _wait(self) -> None:
        deadline = time.monotonic() + 20
        while time.monotonic() < deadline:
            try:
                with socket.create_connection(("127.0.0.1", self.port), timeout=1):
                    return
            except OSError:
                time.sleep(0.05)
        raise AssertionError((self.folder / "log").read_text())

    def kill(self) -> None:
        if self.process:
            self.process.send_signal(signal.SIGKILL)
            self.process.wait()
            self.process = None

    def wipe(self) -> None:
        """Forgets everything: the server is killed, its data removed, and it starts again at the same address."""
        self.kill()
        shutil.rmtree(self.folder / "data", ignore_errors=True)
        self.start()


def start_cluster(folder: Path, size: int = 3) -> list[NatsServer]:
    """Servers that keep copies of each other's messages."""
    routes = {f"server{number}": free_port() for number in range(size)}
    return [NatsServer(folder, name, routes=routes).start() for name in routes]
