"""Every block of README.md and docs runs as typed, in the order of its page, and every job is planned."""

from play import Result


def test_every_block_runs(page: str, results: list[Result]) -> None:
    failed = [f"{page}:{result.line}: {result.output}" for result in results if result.outcome == "failed"]
    assert not failed, "\n".join(failed)
