"""The extractor finds what a reader would run, and a block that fails is reported."""

import os
import pathlib
import re
import sys

import pytest
from blocks import Block, extract_blocks, is_job, read_needs
from play import play_page
from tree import ROOT

PAGE = """# Title

```sh
echo one
```

<!-- needs: slurm, bucket -->
```bash
sbatch job
```

```json
{"not": "run"}
```

```json
{"site": "shaft"}
```

- A list:

  ```console
  $ echo two
  two
  ```

````python
fence = "```"
````

~~~py
print(1)
~~~

```sql
select 1
```
"""


@pytest.fixture
def folder(tmp_path: pathlib.Path) -> pathlib.Path:
    """A folder with an empty copy."""
    (tmp_path / "fathom").mkdir()
    return tmp_path


def run_codes(folder: pathlib.Path, *codes: str, limit_s: float = 30) -> list[tuple[str, str]]:
    """Run codes as the shell blocks of one page and return outcomes and outputs."""
    blocks = [Block(line, "sh", code + "\n") for line, code in enumerate(codes, 1)]
    return [(result.outcome, result.output) for result in play_page(blocks, folder, dict(os.environ), limit_s)]


def test_blocks_have_line_language_code_and_needs() -> None:
    assert extract_blocks(PAGE) == [
        Block(4, "sh", "echo one\n"),
        Block(9, "bash", "sbatch job\n", ("slurm", "bucket")),
        Block(17, "json", '{"site": "shaft"}\n'),
        Block(23, "console", "echo two\n\n"),
        Block(28, "python", 'fence = "```"\n'),
        Block(32, "py", "print(1)\n"),
        Block(36, "sql", "select 1\n"),
    ]


def test_a_block_without_an_end_is_an_error() -> None:
    with pytest.raises(ValueError, match="line 3 has no end"):
        extract_blocks("text\n\n```sh\necho\n")


def test_only_jobs_without_uploads_are_planned() -> None:
    assert is_job('{"scene": {"kind": "procedural", "family": "shaft"}}')
    assert not is_job('{"scene": {"kind": "uploaded", "id": "scn_1"}}')
    assert not is_job('{"1": "pile"}') and not is_job("[1]") and not is_job('{"scene": …}')


def test_only_known_needs_are_accepted_and_only_directly_above() -> None:
    with pytest.raises(ValueError, match="`needs: time` is unknown"):
        read_needs("<!-- needs: time -->")
    assert extract_blocks("<!-- needs: slurm -->\n\n```sh\necho\n```\n")[0].needs == ()


def test_a_failing_block_is_reported_with_its_command_and_the_next_ones_run(folder: pathlib.Path) -> None:
    [first, second] = run_codes(folder, "echo before\nls /missing-folder\necho after", "true")
    assert first[0] == "failed"
    assert "exit status 2" in first[1] and "before" in first[1] and "failed: ls /missing-folder" in first[1]
    assert "after" not in first[1]
    assert second == ("ran", "")


def test_a_block_that_does_not_end_is_reported(folder: pathlib.Path) -> None:
    [(outcome, output)] = run_codes(folder, "sleep 60", limit_s=1)
    assert outcome == "failed" and "still running after 1 s" in output


def test_variables_and_the_folder_pass_to_the_next_block(folder: pathlib.Path) -> None:
    codes = ["mkdir sub && cd sub\nexport A='x y'\nb=\"$A z\"", 'test "$b" = "x y z"\ntest "$(basename "$PWD")" = sub']
    assert run_codes(folder, *codes) == [("ran", ""), ("ran", "")]


def test_services_end_with_their_page(folder: pathlib.Path) -> None:
    assert run_codes(folder, "sleep 4711 &") == [("ran", "")]
    commands = [path.read_bytes() for path in pathlib.Path("/proc").glob("[0-9]*/cmdline") if path.exists()]
    assert b"sleep\x004711\x00" not in commands


def test_python_blocks_run_with_the_variables_of_the_shell(folder: pathlib.Path) -> None:
    blocks = [Block(1, "sh", "export A=3\n"), Block(5, "python", 'import os\nassert os.environ["A"] == "3"\n'), Block(9, "python", "1 / 0\n")]
    results = play_page(blocks, folder, dict(os.environ))
    assert [result.outcome for result in results] == ["ran", "ran", "failed"]
    assert "ZeroDivisionError" in results[2].output


def test_sql_blocks_have_to_find_rows(folder: pathlib.Path) -> None:
    pytest.importorskip("duckdb")
    queries = ["select 1 as one", "select 1 where false", "select missing"]
    own = str(pathlib.Path(sys.executable).parent)
    environment = os.environ | {"PATH": f"{own}:{os.environ['PATH']}"}
    results = play_page([Block(line, "sql", query) for line, query in enumerate(queries, 1)], folder, environment)
    assert [result.outcome for result in results] == ["ran", "failed", "failed"]
    assert "the query returned no rows" in results[1].output and "missing" in results[2].output


def test_the_page_of_exports_names_the_versions_of_the_tests() -> None:
    page = (ROOT / "docs/guide/exports.md").read_text()
    script = (ROOT / "scripts/test-python.sh").read_text()
    for name in ("webdataset", "datasets", "pycocotools", "mlcroissant", "pyyaml"):
        [version] = re.findall(rf"\b{name}==(\S+)", script)
        assert re.search(rf"\b{name} {re.escape(version)}\b", page, re.IGNORECASE), f"{name} {version}"
