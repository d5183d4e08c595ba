from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import fathom
from conftest import BINARY
from fathom.client import Submitted

ROOT = Path(__file__).parents[3]


def _run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "fathom", *arguments], capture_output=True, text=True)


def test_the_module_runs_the_commands_of_the_binary() -> None:
    ours, theirs = _run("styles"), subprocess.run([BINARY, "styles"], capture_output=True, text=True)
    assert (ours.returncode, ours.stdout) == (theirs.returncode, theirs.stdout)
    assert "muddy" in ours.stdout
    assert _run("--version").stdout == subprocess.run([BINARY, "--version"], capture_output=True, text=True).stdout


def test_sets_need_no_other_program(job: fathom.Job, tmp_path: Path) -> None:
    (tmp_path / "job.json").write_text(job.canonical)
    place = (tmp_path / "set").as_uri()
    made = _run("render", str(tmp_path / "job.json"), "--out", place, "--frames-per-shard", "4", "--slots", "1")
    assert made.returncode == 0, made.stderr
    assert "2 shards with 8 frames" in made.stdout
    state = _run("status", place, "--json")
    assert state.returncode == 0, state.stderr
    assert _run("verify", place, "--render", "1").returncode == 0
    refused = _run("render", str(tmp_path / "job.json"), "--out", place, "--frames-per-shard", "5")
    assert refused.returncode == 2
    assert "4 frames per shard, not 5" in refused.stderr


def test_the_exit_status_is_that_of_the_binary(tmp_path: Path) -> None:
    path = tmp_path / "wrong.json"
    path.write_text('{"alpha": 2}')
    wrong = _run("render", str(path), "--out", str(tmp_path / "out"))
    assert wrong.returncode == 2
    assert "/alpha" in wrong.stderr
    assert _run("no-such-command").returncode == 2
    assert _run("--help").returncode == 0


def test_the_guide_names_the_counterpart_of_every_command() -> None:
    page = (ROOT / "docs/guide/python.md").read_text(encoding="utf-8")
    reference = (ROOT / "docs/reference/command-line.md").read_text(encoding="utf-8")
    table = page.split("| command | Python |", 1)[1].split("\n\n", 1)[0].splitlines()[2:]
    named = [name for row in table for name in re.findall(r"`([^`]+)`", row.split(" | ", 1)[0])]
    assert len(named) == len(set(named))
    assert set(named) == set(re.findall(r"^### fathom (.+)$", reference, re.MULTILINE))
    client = fathom.Client("http://127.0.0.1:9")
    owners = {"client": client, "job": Submitted(client, {}), "fathom": fathom}
    calls = [match for row in table for match in re.findall(r"\b(client|job|fathom)\.(\w+)", row)]
    assert len(calls) > 30
    assert [f"{owner}.{name}" for owner, name in calls if not callable(getattr(owners[owner], name, None))] == []
