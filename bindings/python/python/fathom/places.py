"""Folders here or at a URL that fsspec reads."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol
from urllib.parse import urlsplit
from urllib.request import url2pathname

from fathom.errors import InvalidArgument, MissingPackage

ReadRange = Callable[[int, int], bytes]
"""Returns a range of a file by its begin and length."""


class Place(Protocol):
    """A folder of files."""

    read_ahead: int
    """Bytes to read at a time from a file with many small parts."""

    def read(self, name: str, begin: int, length: int) -> bytes:
        """Return a range of a file; shorter at its end."""

    def read_files(self, names: Sequence[str]) -> Mapping[str, bytes]:
        """Return whole files by their names. Raises `FileNotFoundError`."""

    def list_names(self, folder: str) -> list[str]:
        """Return the sorted names in a folder below this one, none for an absent folder."""

    def open_file(self, name: str) -> Any:
        """Return a context with the `ReadRange` of a file."""


class Local:
    """A folder of this machine."""

    read_ahead = 4096

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __str__(self) -> str:
        return str(self.folder)

    def read(self, name: str, begin: int, length: int) -> bytes:
        """Return a range of a file."""
        with self.open_file(name) as read:
            return read(begin, length)

    def read_files(self, names: Sequence[str]) -> dict[str, bytes]:
        """Return whole files."""
        return {name: (self.folder / name).read_bytes() for name in names}

    def list_names(self, folder: str) -> list[str]:
        """Return the names in a folder."""
        try:
            return sorted(os.listdir(self.folder / folder))
        except FileNotFoundError:
            return []

    @contextmanager
    def open_file(self, name: str) -> Iterator[ReadRange]:
        """Open a file once for many ranges."""
        with (self.folder / name).open("rb") as file:

            def read(begin: int, length: int) -> bytes:
                file.seek(begin)
                return file.read(length)

            yield read


class Remote:
    """A folder at a URL such as `s3://bucket/set`; every reading process opens its connection."""

    read_ahead = 1 << 18

    def __init__(self, url: str) -> None:
        self.url = url.rstrip("/")
        self._files: tuple[int, Any, str] | None = None

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_files": None}

    def __str__(self) -> str:
        return self.url

    def _open(self) -> tuple[Any, str]:
        if self._files is None or self._files[0] != os.getpid():
            self._files = os.getpid(), *_open_url(self.url)
        return self._files[1:]

    def read(self, name: str, begin: int, length: int) -> bytes:
        """Return a range of a file."""
        files, folder = self._open()
        part: bytes = files.cat_file(f"{folder}/{name}", start=begin, end=begin + length)
        return part

    def read_files(self, names: Sequence[str]) -> dict[str, bytes]:
        """Return whole files, several at a time."""
        files, folder = self._open()
        if not names:
            return {}
        read: Mapping[str, bytes] = files.cat([f"{folder}/{name}" for name in names])
        by_name = {path.rsplit("/", 1)[1]: content for path, content in read.items()}
        return {name: by_name[name.rsplit("/", 1)[-1]] for name in names}

    def list_names(self, folder: str) -> list[str]:
        """Return the names in a folder, as they are now."""
        files, root = self._open()
        files.invalidate_cache()
        try:
            paths: list[str] = files.ls(f"{root}/{folder}", detail=False)
        except FileNotFoundError:
            return []
        return sorted(path.rstrip("/").rsplit("/", 1)[1] for path in paths)

    @contextmanager
    def open_file(self, name: str) -> Iterator[ReadRange]:
        """Read every range of a file in a separate request."""
        yield lambda begin, length: self.read(name, begin, length)


def _open_url(url: str) -> tuple[Any, str]:
    """Return the file system of a URL, and its path there. Raises `MissingPackage` and `InvalidArgument`."""
    try:
        import fsspec

        files, path = fsspec.url_to_fs(url)
    except ImportError as error:
        # fsspec itself, or its package for the kind of URL, such as s3fs.
        message = f"{url} needs a package that is not installed: {error}"
        if error.name == "fsspec" or url.lower().startswith("s3:"):
            message += "; run: pip install 'fathom-datasets[buckets]'"
        raise MissingPackage(message) from error
    except ValueError as error:
        raise InvalidArgument(
            f"`place` is {url}: {error}; must be a folder or a URL such as s3://bucket/set"
        ) from error
    return files, path


def find_place(place: str | os.PathLike[str]) -> Local | Remote:
    """Return the folder of a path, of a `file://` URL or of another URL."""
    text = os.fspath(place)
    if text.lower().startswith("file://"):
        return Local(Path(url2pathname(urlsplit(text).path)))
    return Remote(text) if "://" in text else Local(Path(place))


def read_if_present(place: Place, name: str) -> bytes | None:
    """Return a whole file, `None` if it is absent."""
    try:
        return place.read_files([name])[name]
    except FileNotFoundError:
        return None
