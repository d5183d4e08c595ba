"""Exit statuses of commands with recordings; those of all commands of `fathom`."""

from __future__ import annotations

import signal
import sqlite3
import sys
from collections.abc import Callable, Sequence
from typing import Any

from fathom.bag.recording import Recording
from fathom.bag.report import Report, format_stamp
from fathom.errors import FathomError

DONE, SOME_FRAMES, BAD_INPUT = 0, 1, 2


def run(command: Callable[[Sequence[str]], int], arguments: Sequence[str]) -> int:
    """Run a command and return its exit status; errors are printed."""
    # Temporary files are removed on the way out of a signal too.
    before = signal.signal(signal.SIGTERM, _stop)
    try:
        return command(arguments)
    except FathomError as error:
        print(f"fathom: {error}", file=sys.stderr)
        return BAD_INPUT
    except (OSError, sqlite3.Error) as error:
        print(f"fathom: the output cannot be written: {error}", file=sys.stderr)
        return SOME_FRAMES
    except KeyboardInterrupt:
        print("fathom: stopped; nothing was written", file=sys.stderr)
        return 128 + signal.SIGINT
    finally:
        signal.signal(signal.SIGTERM, before)


def end(recording: Recording, report: Report) -> int:
    """Print the summary and return the exit status: 1 if frames are missing."""
    report.summarize()
    if recording.cut is not None:
        end_ns = recording.end_ns
        time = "before its first message" if end_ns is None else f"at {format_stamp(end_ns)} s"
        print(f"fathom: {recording.path} is cut off: it ends {time} ({recording.cut})", file=sys.stderr)
    return SOME_FRAMES if recording.cut is not None or report.left_out else DONE


def _stop(number: int, _: Any) -> None:
    raise SystemExit(128 + number)
