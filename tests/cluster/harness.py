"""Runs `fathom` on sets in a folder or a bucket, and reads what is in them."""

import dataclasses
import json
import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path
from urllib.parse import urlsplit

import boto3

ROOT = Path(__file__).resolve().parents[2]
FATHOM = os.environ.get("FATHOM", str(ROOT / "target/release/fathom"))
PATIENCE_S = 300


def job(frames, width=40, height=24, **changes):
    """A job of small frames."""
    return {
        "dataset": "sets",
        "count": frames,
        "seed": 3,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
        "camera": {"width": width, "height": height, "hfov_deg": 80},
        "water": {"optics": "jerlov-3C"},
        "artifacts": ["rgb", "range"],
    } | changes


@dataclasses.dataclass
class Ended:
    """A command that has ended."""

    code: int
    out: str
    err: str

    @property
    def digest(self):
        """The digest that was printed."""
        found = re.search(r"^digest (\w+)$", self.out, re.MULTILINE)
        return found and found[1]


def end(process):
    """Waits for a command."""
    out, err = process.communicate(timeout=PATIENCE_S)
    return Ended(process.returncode, out, err)


def call(*words, env=None):
    """Starts `fathom` with these words."""
    environment = os.environ | (env or {})
    pipe = subprocess.PIPE
    return subprocess.Popen([FATHOM, *map(str, words)], stdout=pipe, stderr=pipe, text=True, env=environment, cwd=ROOT)


def wait_until(condition, what):
    """Waits for a condition, with an end."""
    until = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < until, f"waited in vain: {what}"
        time.sleep(0.01)


def children(process):
    """Process ids of the children of a process."""
    try:
        return [int(pid) for pid in Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()]
    except OSError:
        return []


def kill(pid):
    """SIGKILL; returns whether somebody was there."""
    try:
        os.kill(pid, signal.SIGKILL)
    except ProcessLookupError:
        return False
    return True


class Set:
    """A job and the set that it is rendered into."""

    def __init__(self, folder, url, description, env=None):
        self.url, self.env = str(url), env or {}
        self.job = folder / "job.json"
        self.job.write_text(json.dumps(description))

    def start(self, *options, **env):
        """Starts to render."""
        return call("render", self.job, "--out", self.url, "--slots", "1", *options, env=self.env | env)

    def render(self, *options, **env):
        """Renders what is missing."""
        return end(self.start(*options, **env))

    def run(self, command, *options):
        """Runs another command on the set."""
        return end(call(command, self.url, *options, env=self.env))

    def status(self):
        """What `fathom status` says."""
        ended = self.run("status", "--json")
        assert ended.code == 0, ended.err
        return json.loads(ended.out)


class Folder(Set):
    """A set in a folder."""

    def __init__(self, folder, description):
        self.path = folder / "set"
        super().__init__(folder, f"file://{self.path}", description)

    def run(self, command, *options):
        """Runs another command on the set."""
        return end(call(command, self.path, *options))

    def names(self, part):
        """Names of the files in a part of the set."""
        return sorted(path.name for path in (self.path / part).glob("*"))

    def read(self, name):
        """Bytes of a file."""
        return (self.path / name).read_bytes()


class Bucket(Set):
    """A set in a bucket of a server."""

    def __init__(self, folder, server, description, prefix="set"):
        super().__init__(folder, f"s3://{server.BUCKET}/{prefix}", description, server.env())
        self.server, self.prefix = server, prefix

    def names(self, part):
        """Names of the objects in a part of the set."""
        pages = self.server.client().get_paginator("list_objects_v2")
        pages = pages.paginate(Bucket=self.server.BUCKET, Prefix=f"{self.prefix}/{part}/")
        return sorted(entry["Key"].rsplit("/", 1)[1] for page in pages for entry in page.get("Contents", []))

    def read(self, name):
        """Bytes of an object."""
        return self.server.client().get_object(Bucket=self.server.BUCKET, Key=f"{self.prefix}/{name}")["Body"].read()


def free_port():
    """A port that nobody listens on."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


class Moto:
    """An S3 server of its own process, with one bucket."""

    BUCKET = "reef"

    def __init__(self, **env):
        self.port, self.given = free_port(), env
        self.process = None
        self.start()

    @property
    def url(self):
        """Where it listens."""
        return f"http://127.0.0.1:{self.port}"

    def start(self):
        """Starts it with a bucket; of what it had before nothing is there."""
        quiet = subprocess.DEVNULL
        self.process = subprocess.Popen(self.command(), stdout=quiet, stderr=quiet, env=os.environ | self.given)
        wait_until(self.listens, "the S3 server listens")
        self.client().create_bucket(Bucket=self.BUCKET)

    def command(self):
        """What starts it."""
        return [sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", str(self.port)]

    def listens(self):
        """Whether it takes connections."""
        with socket.socket() as attempt:
            return attempt.connect_ex(("127.0.0.1", self.port)) == 0

    def kill(self):
        """SIGKILL."""
        self.process.kill()
        self.process.wait()

    def env(self, url=None):
        """The environment that leads to it."""
        return {
            "AWS_ENDPOINT_URL": url or self.url,
            "AWS_REGION": "us-east-1",
            "AWS_ACCESS_KEY_ID": "key",
            "AWS_SECRET_ACCESS_KEY": "hush-hush",
        }

    def client(self):
        """A client that is not ours."""
        return boto3.client(
            "s3",
            endpoint_url=self.url,
            region_name="us-east-1",
            aws_access_key_id="key",
            aws_secret_access_key="hush-hush",
        )


class KeptServer(Moto):
    """An S3 server whose data outlives it."""

    def __init__(self, folder):
        self.folder = folder
        super().__init__()

    def command(self):
        return [sys.executable, Path(__file__).with_name("s3_server.py"), str(self.port), self.folder]


class Wire:
    """A connection to a server that can be cut, and that can rewrite what is sent.

    A server that is restarted with its data looks the same from outside: connections break, none is accepted for a
    while, then everything is there again.
    """

    def __init__(self, server, rewrite=lambda data: data):
        self.port, self.target, self.rewrite = free_port(), urlsplit(server.url).port, rewrite
        self.listener, self.open = None, []
        self.mend()

    @property
    def url(self):
        """Where it listens."""
        return f"http://127.0.0.1:{self.port}"

    def mend(self):
        """Takes connections."""
        self.listener = socket.create_server(("127.0.0.1", self.port))
        threading.Thread(target=self.accept, args=[self.listener], daemon=True).start()

    def cut(self):
        """Breaks all connections and takes no more."""
        # Without the first, a thread that waits in accept() keeps the port open.
        self.listener.shutdown(socket.SHUT_RDWR)
        self.listener.close()
        for connection in self.open:
            shut(connection)
        self.open.clear()

    def accept(self, listener):
        while True:
            try:
                near, _ = listener.accept()
                far = socket.create_connection(("127.0.0.1", self.target))
            except OSError:
                return
            self.open += [near, far]
            for source, sink, change in [(near, far, self.rewrite), (far, near, lambda data: data)]:
                threading.Thread(target=pump, args=[source, sink, change], daemon=True).start()


def pump(source, sink, change):
    """Carries bytes until one side is closed, then closes both."""
    try:
        while data := source.recv(1 << 16):
            sink.sendall(change(data))
    except OSError:
        pass
    shut(source)
    shut(sink)


def shut(connection):
    """Ends a connection, also for a thread that reads from it."""
    try:
        connection.shutdown(socket.SHUT_RDWR)
    except OSError:
        # It has ended already.
        pass
