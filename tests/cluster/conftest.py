"""What the tests share: a server, the digest that every way must lead to, and the table of figures."""

import time

import pytest
from harness import Moto, call, end
from harness import job as describe
from slurm import Slurm

FIGURES = []


@pytest.fixture(scope="session")
def moto():
    """An S3 server."""
    server = Moto()
    yield server
    server.kill()


@pytest.fixture(scope="session")
def slurm(tmp_path_factory):
    """A Slurm cluster of this machine."""
    if missing := Slurm.missing():
        pytest.skip(f"SKIPPED: {', '.join(missing)} not installed here (apt-get install slurm-wlm munge)")
    cluster = Slurm(tmp_path_factory.mktemp("slurm"))
    yield cluster
    cluster.stop()


@pytest.fixture(scope="session")
def expected(tmp_path_factory):
    """The digest of a job as `fathom render` computes it without a set."""
    found = {}

    def digest(frames, **changes):
        description = describe(frames, **changes)
        if (name := str(description)) not in found:
            folder = tmp_path_factory.mktemp("plain")
            path = folder / "job.json"
            path.write_text(str(description).replace("'", '"'))
            ended = end(call("render", path, "--out", folder / "out"))
            assert ended.code == 0, ended.err
            found[name] = ended.digest
        return found[name]

    return digest


@pytest.fixture
def figure():
    """Puts a line into the table that is printed at the end."""
    begun = time.monotonic()

    def add(way, digest, note=""):
        FIGURES.append((way, time.monotonic() - begun, digest, note))

    return add


def pytest_terminal_summary(terminalreporter):
    if FIGURES:
        terminalreporter.write_line("\n| the same job through | seconds | content digest | |\n|---|---|---|---|")
        for way, seconds, digest, note in FIGURES:
            terminalreporter.write_line(f"| {way} | {seconds:.1f} | {digest[:12]} | {note} |")
