"""Runs pages on several threads and prints a table of them at the end."""

import concurrent.futures
import os
import pathlib
import shutil
import sys

import play
import pytest
import tree
from blocks import extract_blocks

RESULTS: dict[str, list[play.Result]] = {}


def read_all_pages() -> tuple[bytes, dict[str, str]]:
    """Return the archive and its pages with blocks."""
    archive = tree.read_archive()
    return archive, {page: text for page, text in tree.read_pages(archive).items() if extract_blocks(text)}


ARCHIVE, PAGES = read_all_pages()


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Make one test of each page."""
    if "page" in metafunc.fixturenames:
        metafunc.parametrize("page", PAGES)


def play_fresh(page: str, folder: pathlib.Path) -> list[play.Result]:
    """Run a page in a fresh copy, which is deleted afterwards."""
    folder.mkdir()
    try:
        tree.make_copy(ARCHIVE, folder, sys.executable)
        environment = tree.make_environment(folder, sys.executable, PAGES[page])
        return play.play_page(extract_blocks(PAGES[page]), folder, environment)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@pytest.fixture(scope="session")
def played(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> dict:
    """The result of each selected page, as futures. Without namespaces the pages share port 7311 and run one by one."""
    calls = [item.callspec.params for item in request.session.items if hasattr(item, "callspec")]
    pages = [parameters["page"] for parameters in calls if "page" in parameters]
    threads = min(4, os.cpu_count() or 1) if play.can_isolate() else 1
    pool = concurrent.futures.ThreadPoolExecutor(threads)
    base = tmp_path_factory.mktemp("pages")
    # Tutorials take longest, so they start first.
    pages.sort(key=lambda page: not page.startswith("docs/tutorials/"))
    futures = {page: pool.submit(play_fresh, page, base / str(number)) for number, page in enumerate(pages)}
    yield futures
    pool.shutdown(cancel_futures=True)


@pytest.fixture
def results(page: str, played: dict) -> list[play.Result]:
    """The results of the blocks of a page."""
    RESULTS[page] = played[page].result()
    return RESULTS[page]


def count(results: list[play.Result], outcome: str) -> int:
    """Return the number of blocks with this outcome."""
    return sum(result.outcome == outcome for result in results)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print the blocks of each page by outcome."""
    if not RESULTS:
        return
    rows = []
    for page, results in RESULTS.items():
        counts = [count(results, outcome) for outcome in ("ran", "marked", "failed")]
        rows.append((page, *counts, sum(result.seconds for result in results)))
    rows.append(("all", *(sum(row[column] for row in rows) for column in range(1, 5))))
    terminalreporter.section("blocks of the documentation")
    terminalreporter.write_line(f"{'page':50} {'run':>5} {'marked':>7} {'failed':>7} {'seconds':>8}")
    for page, ran, marked, failed, seconds in rows:
        terminalreporter.write_line(f"{page:50} {ran:5} {marked:7} {failed:7} {seconds:8.1f}")
