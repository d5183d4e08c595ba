#!/usr/bin/env python3
"""Builds and runs the test binaries of the workspace like `cargo test`, one per core at a time.

Cargo runs one binary after the other, so that a core is idle while a test waits or uses one thread. The output of a binary is printed when it has ended. Documentation tests run last.

    scripts/run_tests.py
"""

import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys
import time
from typing import NamedTuple

CARGO = ["cargo", "test", "--release", "--locked", "--workspace"]
# Binaries that take longest, as package and target; they start first, so that none of them runs alone at the end.
LONGEST = [
    ("fathom-tests", "suite"),
    ("api", "suite"),
    ("fathom-tests", "load"),
    ("fathom-tests", "renderer"),
    ("api", "leases"),
    ("optics", "lamps"),
    ("training", "training"),
    ("fathom-tests", "catalogue"),
    ("enhance", "agreement"),
    ("lab", "lab"),
    ("optics", "agreement"),
    ("store", "suite"),
]


class Binary(NamedTuple):
    """A test binary and the folder of its package."""

    package: str
    target: str
    path: str
    folder: str

    def name(self) -> str:
        """Return package and target for messages."""
        return f"{self.package}/{self.target}"


def build() -> list[Binary]:
    """Build the test binaries; the messages of the compiler are printed."""
    command = [*CARGO, "--no-run", "--message-format", "json-render-diagnostics"]
    built = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    if built.returncode != 0:
        sys.exit(built.returncode)
    messages = (json.loads(line) for line in built.stdout.splitlines() if line.startswith("{"))
    binaries = []
    for message in messages:
        if message.get("executable") and message["profile"]["test"]:
            folder = pathlib.Path(message["manifest_path"]).parent
            # An identifier is `path+file:///…/folder#version` or `…#name@version`.
            package = message["package_id"].rsplit("#", 1)[-1]
            package = package.split("@")[0] if "@" in package else folder.name
            binaries.append(Binary(package, message["target"]["name"], message["executable"], str(folder)))
    return binaries


def run(binary: Binary, libraries: str) -> tuple[int, str, float]:
    """Run a binary in the folder of its package and return its status, output and seconds."""
    environment = os.environ | {"CARGO_MANIFEST_DIR": binary.folder, "LD_LIBRARY_PATH": libraries}
    started = time.monotonic()
    ended = subprocess.run(
        [binary.path],
        cwd=binary.folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        check=False,
    )
    return ended.returncode, ended.stdout, time.monotonic() - started


def find_libraries(binaries: list[Binary]) -> str:
    """Return the search path of shared libraries: tests of procedural macros load the standard library."""
    printed = subprocess.run(["rustc", "--print", "target-libdir"], stdout=subprocess.PIPE, text=True, check=True)
    folders = [str(pathlib.Path(binaries[0].path).parent), printed.stdout.strip(), os.environ.get("LD_LIBRARY_PATH", "")]
    return ":".join(folder for folder in folders if folder)


def main() -> None:
    """Run everything; exit with 1 if a binary fails."""
    binaries = build()
    if not binaries:
        sys.exit("run_tests: no test binary was built")
    rank = {name: position for position, name in enumerate(LONGEST)}
    binaries.sort(key=lambda binary: rank.get((binary.package, binary.target), len(LONGEST)))
    libraries = find_libraries(binaries)
    failed = []
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        running = {pool.submit(run, binary, libraries): binary for binary in binaries}
        for future in concurrent.futures.as_completed(running):
            binary = running[future]
            status, output, seconds = future.result()
            print(f"     Running {binary.name()} ({seconds:.1f} s)\n{output}", flush=True)
            if status != 0:
                failed.append(f"{binary.name()}: exit status {status}")
    status = subprocess.run([*CARGO, "--doc"], check=False).returncode
    if failed or status != 0:
        sys.exit("\n".join(["failed:", *failed]))


if __name__ == "__main__":
    main()
