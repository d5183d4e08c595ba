"""Exports of a service's datasets, which the command `fathom export` writes."""

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
    """Run the command and return the folder."""
    kinds = list_names("kinds", kinds)
    command = [sys.executable, "-m", "fathom", "export", dataset, "--out", os.fspath(out), "--server", server]
    command += ["--format", format, "--kinds", ",".join(kinds), f"--filter={filter}"]
    if split is not None:
        command += ["--split", ",".join(f"{name}={share}" for name, share in split.items())]
    if shard_size is not None:
        command += ["--shard-size", str(shard_size)]
    if license is not None:
        command += ["--license", license]
    environment = dict(os.environ)
    environment.pop("FATHOM_TOKEN", None)
    if token:
        environment["FATHOM_TOKEN"] = token
    ended = subprocess.run(command, env=environment, capture_output=True, text=True)
    if ended.returncode != 0:
        reason = ended.stderr.strip().removeprefix("fathom: ")
        raise CommandError(reason or f"the export ended with {ended.returncode}", ended.returncode)
    return Path(out)
