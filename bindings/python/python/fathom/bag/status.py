"""Exit statuses of commands with recordings; those of all commands of `fathom`."""

from __future__ import annotations

import signal
import sqlite3
import sys
from collections.abc import Callable, Sequence
from typing import Any, NoReturn

from fathom.bag.recording import Recording
from fathom.bag.report import Report, format_stamp
from fathom.errors import FathomError

DONE, SOME_FRAMES, BAD_INPUT = 0, 1, 2


def run(command: Callable[[Sequence[str]], int], arguments: Sequence[str]) -> int:
    """Run a command and return its exit status; errors are printed."""
    # Temporary files are removed on the way out of a signal too.
    _received.clear()
    before = {number: signal.signal(number, _stop) for number in (signal.SIGINT, signal.SIGTERM)}
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
        for number, handler in before.items():
            signal.signal(number, handler)


def end(recording: Recording, report: Report) -> int:
    """Print the summary and return the exit status: 1 if frames are missing."""
    report.summarize()
    if recording.cut is not None:
        end_ns = recording.end_ns
        time = "before its first message" if end_ns is None else f"at {format_stamp(end_ns)} s"
        print(f"fathom: {recording.path} is cut off: it ends {time} ({recording.cut})", file=sys.stderr)
    return SOME_FRAMES if recording.cut is not None or report.left_out else DONE


def end_if_stopped() -> None:
    """Raise again what a signal raised, if code that called back into Python has taken it for an error of its own."""
    if _received:
        _raise(_received[-1])


_received: list[int] = []


def _stop(number: int, _: Any) -> None:
    _received.append(number)
    _raise(number)


def _raise(number: int) -> NoReturn:
    if number == signal.SIGINT:
        raise KeyboardInterrupt
    raise SystemExit(128 + number)
