"""Runs the blocks of one page in order, in a network and a process namespace of the page where the system allows it."""

import dataclasses
import json
import os
import pathlib
import shlex
import shutil
import signal
import subprocess
import sys
import time

from blocks import SHELLS, SQL, Block

# Seconds of one block.
LIMIT_S = 300
# Last characters of a failed block's output in the report.
TAIL = 1500
UNSHARE = ["unshare", "--map-root-user", "--net", "--pid", "--fork", "--kill-child", "--mount-proc"]

# Variables and the folder pass from one block to the next, as in one terminal. `declare -p` also prints read-only variables
# of bash, which cannot be set.
SHELL = """
if [ -f {state} ]; then . {state} 2>/dev/null; cd "$FATHOM_DOCS_FOLDER"; fi
set -e
trap 'echo "failed: $BASH_COMMAND" >&2' ERR
. {block}
trap - ERR
FATHOM_DOCS_FOLDER=$PWD
declare -p | grep -v '^declare -[a-zA-Z]*r' >{state}
"""

RUN_SQL = """
import sys, duckdb
rows = duckdb.sql(open(sys.argv[1]).read()).fetchall()
print(*rows, sep="\\n")
sys.exit(0 if rows else "the query returned no rows")
"""


@dataclasses.dataclass(frozen=True)
class Result:
    """Outcome of a block: `ran`, `marked` or `failed`, with the end of its output if it failed."""

    line: int
    outcome: str
    seconds: float = 0.0
    output: str = ""


def can_isolate() -> bool:
    """Whether pages can have namespaces."""
    if not shutil.which("unshare") or not shutil.which("ip"):
        return False
    return subprocess.run([*UNSHARE, "ip", "link", "set", "lo", "up"], capture_output=True).returncode == 0


def write_script(block: Block, folder: pathlib.Path) -> pathlib.Path:
    """Write a block as a shell script and return its path.

    A job is planned, which checks it and makes its first scene. DuckDB runs SQL, which has to find rows.
    """
    script = folder / f"block-{block.line}.sh"
    if block.language in SHELLS:
        script.write_text(block.code)
        return script
    if block.is_python:
        source, program = script.with_suffix(".py"), "python"
    elif block.language == SQL:
        source, program = script.with_suffix(".sql"), f"python -c {shlex.quote(RUN_SQL)}"
    else:
        source, program = script.with_suffix(".json"), "fathom plan"
    source.write_text(block.code)
    script.write_text(f"{program} {source}\n")
    return script


def run_block(block: Block, folder: pathlib.Path, environment: dict[str, str], limit_s: float) -> Result:
    """Run a block in a process group. Its services stay for the next blocks."""
    called = write_script(block, folder)
    script = SHELL.format(state=folder / "state", block=called)
    log = folder / f"block-{block.line}.log"
    began = time.monotonic()
    with open(log, "wb") as output:
        process = subprocess.Popen(
            ["bash", "-c", script], cwd=folder / "fathom", env=environment, stdin=subprocess.DEVNULL, stdout=output,
            stderr=subprocess.STDOUT, start_new_session=True,
        )  # fmt: skip
        try:
            status = process.wait(limit_s)
            problem = f"exit status {status}" if status else ""
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            problem = f"still running after {limit_s} s; start services with `&`"
    seconds = round(time.monotonic() - began, 1)
    if not problem:
        return Result(block.line, "ran", seconds)
    return Result(block.line, "failed", seconds, f"{problem}\n{log.read_text(errors='replace')[-TAIL:]}")


def stop_services(folder: pathlib.Path) -> None:
    """End every process that works in the folder of the page."""
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            place = pathlib.Path(os.readlink(process / "cwd"))
            if place.is_relative_to(folder / "fathom"):
                os.kill(int(process.name), signal.SIGKILL)
        except OSError:
            continue


def play_blocks(blocks: list[Block], folder: pathlib.Path, environment: dict[str, str], limit_s: float) -> list[Result]:
    """Run the blocks that have no requirements, and stop what they started."""
    results = []
    try:
        for block in blocks:
            marked = Result(block.line, "marked")
            results.append(marked if block.needs else run_block(block, folder, environment, limit_s))
    finally:
        stop_services(folder)
    return results


def play_page(blocks: list[Block], folder: pathlib.Path, environment: dict[str, str], limit_s: float = LIMIT_S) -> list[Result]:
    """Run the blocks of a page in a copy that `tree.make_copy` made in `folder`."""
    if not can_isolate():
        return play_blocks(blocks, folder, environment, limit_s)
    order = {"blocks": [dataclasses.asdict(block) for block in blocks], "environment": environment, "limit_s": limit_s}
    (folder / "order.json").write_text(json.dumps(order))
    command = [*UNSHARE, sys.executable, __file__, str(folder)]
    subprocess.run(command, check=True, stdin=subprocess.DEVNULL)
    return [Result(**result) for result in json.loads((folder / "results.json").read_text())]


def main() -> None:
    """Run the blocks of `order.json` inside the namespaces."""
    folder = pathlib.Path(sys.argv[1])
    subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
    order = json.loads((folder / "order.json").read_text())
    blocks = [Block(**block | {"needs": tuple(block["needs"])}) for block in order["blocks"]]
    results = play_blocks(blocks, folder, order["environment"], order["limit_s"])
    (folder / "results.json").write_text(json.dumps([dataclasses.asdict(result) for result in results]))


if __name__ == "__main__":
    main()
