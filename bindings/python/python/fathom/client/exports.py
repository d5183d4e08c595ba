"""Exports and contact sheets of a service's datasets, which commands of the wheel write."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from fathom.arguments import list_names
from fathom.errors import CommandError


def export(
    server: str,
    token: str | None,
    dataset: str,
    out: str | os.PathLike[str],
    *,
    format: str = "folder",
    kinds: Sequence[str] = ("rgb",),
    filter: str = "",
    split: Mapping[str, float] | None = None,
    shard_size: int | None = None,
    license: str | None = None,
) -> Path:
    """Run `fathom export` and return the folder."""
    command = ["export", dataset, "--out", os.fspath(out), "--format", format]
    command += ["--kinds", ",".join(list_names("kinds", kinds)), f"--filter={filter}"]
    if split is not None:
        command += ["--split", ",".join(f"{name}={share}" for name, share in split.items())]
    if shard_size is not None:
        command += ["--shard-size", str(shard_size)]
    if license is not None:
        command += ["--license", license]
    _run(server, token, command)
    return Path(out)


def draw_sheet(
    server: str,
    token: str | None,
    dataset: str,
    out: str | os.PathLike[str],
    *,
    kind: str = "rgb",
    filter: str = "",
    order_by: str | None = None,
    limit: int = 24,
) -> Path:
    """Run `fathom sheet` and return the file."""
    command = ["sheet", dataset, "--out", os.fspath(out), "--kind", kind, f"--filter={filter}", "--limit", str(limit)]
    if order_by is not None:
        command.append(f"--order-by={order_by}")
    _run(server, token, command)
    return Path(out)


def _run(server: str, token: str | None, command: Sequence[str]) -> None:
    """Run a command against a service. Raises `CommandError` with its reason."""
    environment = dict(os.environ)
    environment.pop("FATHOM_TOKEN", None)
    if token:
        environment["FATHOM_TOKEN"] = token
    program = [sys.executable, "-m", "fathom", *command, "--server", server]
    ended = subprocess.run(program, env=environment, capture_output=True, text=True)
    if ended.returncode != 0:
        reason = ended.stderr.strip().removeprefix("fathom: ")
        raise CommandError(reason or f"`fathom {command[0]}` ended with {ended.returncode}", ended.returncode)
