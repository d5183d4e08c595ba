"""Makes fresh copies of the tracked files in which the blocks of a page run."""

import io
import os
import pathlib
import stat
import subprocess
import tarfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR") or ROOT / "target").resolve()
FATHOM = pathlib.Path(os.environ.get("FATHOM") or TARGET / "release/fathom").resolve()
# Commit or tree of which copies are made.
REVISION = os.environ.get("FATHOM_DOCS_TREE") or "HEAD"
# Scripts that run as they are; of the others, which build and test for minutes, only the existence is checked.
QUICK_SCRIPTS = {"run.sh", "get-onnxruntime.sh"}

NOTHING = "#!/bin/sh\necho \"$(basename \"$0\"): left out by the test of the documentation\"\n"
# The environment of the test already has the packages, so a virtual environment is an empty one on top of it.
PYTHON = """#!/bin/sh
if [ "$1 $2" = "-m venv" ]; then
    mkdir -p "$3/bin" && : >"$3/bin/activate"
elif [ "$1 $2" = "-m pip" ]; then
    exec pip
else
    exec {python} "$@"
fi
"""


def read_archive() -> bytes:
    """Return the tracked files as a tar."""
    return subprocess.run(["git", "archive", "--format=tar", REVISION], cwd=ROOT, check=True, capture_output=True).stdout


def read_pages(archive: bytes) -> dict[str, str]:
    """Return the text of README.md and of each page below docs."""
    with tarfile.open(fileobj=io.BytesIO(archive)) as tar:
        names = [name for name in tar.getnames() if name == "README.md" or (name.startswith("docs/") and name.endswith(".md"))]
        return {name: tar.extractfile(name).read().decode() for name in sorted(names)}


def write_program(path: pathlib.Path, text: str) -> None:
    """Write an executable file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    path.chmod(path.stat().st_mode | stat.S_IXUSR)


def make_copy(archive: bytes, folder: pathlib.Path, python: str) -> pathlib.Path:
    """Extract the files into `folder/fathom` next to stubs of the tools that build, and return it."""
    copy = folder / "fathom"
    with tarfile.open(fileobj=io.BytesIO(archive)) as tar:
        tar.extractall(copy, filter="tar")
    (copy / "target/release").mkdir(parents=True)
    for program in FATHOM.parent.glob("fathom*"):
        if os.access(program, os.X_OK) and program.is_file():
            (copy / "target/release" / program.name).symlink_to(program)
    for name, source in (("target/wheels", TARGET / "wheels"), (".onnxruntime", ROOT / ".onnxruntime")):
        if source.is_dir():
            (copy / name).symlink_to(source)
    for script in (copy / "scripts").glob("*.sh"):
        if script.name not in QUICK_SCRIPTS:
            write_program(script, NOTHING)
    for name in ("cargo", "pip", "pip3"):
        write_program(folder / "stubs" / name, NOTHING)
    for name in ("python", "python3"):
        write_program(folder / "stubs" / name, PYTHON.format(python=python))
    (folder / "home").mkdir()
    return copy


def make_environment(folder: pathlib.Path, python: str, page: str) -> dict[str, str]:
    """Return the environment of a page; a page that exports a PATH with the binaries has to do so itself."""
    paths = [folder / "stubs", pathlib.Path(python).parent]
    if "export PATH=$PWD/target/release" not in page:
        paths.insert(1, folder / "fathom/target/release")
    kept = {name: value for name, value in os.environ.items() if name in ("LANG", "LC_ALL", "TERM", "TMPDIR")}
    return kept | {
        "HOME": str(folder / "home"),
        "PATH": ":".join([*map(str, paths), os.environ["PATH"]]),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
