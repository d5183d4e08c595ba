"""An S3 server over a folder, for tests that kill it: what it has acknowledged is there when it starts again.

It does what sets need and no more, and is strict where a mistake of ours would show: conditions are atomic, checksums that are sent are
compared. Usage: s3_server.py PORT FOLDER
"""

import base64
import hashlib
import os
import re
import secrets
import shutil
import sys
import threading
from datetime import datetime, timezone
from email.utils import formatdate
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import parse_qs, quote, unquote, urlsplit
from xml.sax.saxutils import escape

LOCK = threading.Lock()
PAGE = 1000


class Refused(Exception):
    """A request that gets an error: its status and code."""


class Handler(BaseHTTPRequestHandler):
    """One connection."""

    protocol_version = "HTTP/1.1"
    folder: Path

    def handle_one(self):
        parts = urlsplit(self.path)
        self.query = {name: values[0] for name, values in parse_qs(parts.query, keep_blank_values=True).items()}
        bucket, _, self.key = unquote(parts.path).lstrip("/").partition("/")
        self.bucket = self.folder / "objects" / bucket
        self.body = self.rfile.read(int(self.headers.get("Content-Length") or 0))
        wanted = self.headers.get("x-amz-checksum-sha256")
        try:
            if wanted and base64.b64encode(hashlib.sha256(self.body).digest()).decode() != wanted:
                raise Refused(400, "BadDigest")
            getattr(self, f"on_{self.command.lower()}")()
        except Refused as refused:
            status, code = refused.args
            self.reply(status, f"<Error><Code>{code}</Code><Message>{code}</Message></Error>".encode())
        except FileNotFoundError:
            self.reply(404, b"<Error><Code>NoSuchKey</Code><Message>NoSuchKey</Message></Error>")

    do_GET = do_HEAD = do_PUT = do_POST = do_DELETE = handle_one

    def reply(self, status, body=b"", length=None, **headers):
        self.send_response(status)
        self.send_header("Content-Length", str(len(body) if length is None else length))
        for name, value in headers.items():
            self.send_header(name.replace("_", "-"), value)
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(body)

    def path_of(self, key):
        # A key is one name, so that no key is the folder of another.
        return self.bucket / quote(key, safe="")

    def etag_of(self, path):
        return f'"{hashlib.md5(path.read_bytes()).hexdigest()}"'

    def store(self, data):
        """Writes the object if the conditions of the request hold."""
        path, new = self.path_of(self.key), self.folder / f"new-{secrets.token_hex(8)}"
        if not self.bucket.is_dir():
            raise Refused(404, "NoSuchBucket")
        with new.open("wb") as file:
            file.write(data)
        with LOCK:
            there = self.etag_of(path) if path.exists() else None
            match = self.headers.get("If-Match")
            if (self.headers.get("If-None-Match") == "*" and there) or (match and match != there):
                new.unlink()
                raise Refused(412, "PreconditionFailed")
            new.rename(path)

    def on_put(self):
        if not self.key:
            self.bucket.mkdir(parents=True, exist_ok=True)
            return self.reply(200)
        etag = f'"{hashlib.md5(self.body).hexdigest()}"'
        if "uploadId" in self.query:
            (self.upload() / f"{int(self.query['partNumber']):05}").write_bytes(self.body)
        else:
            self.store(self.body)
        return self.reply(200, ETag=etag)

    def upload(self):
        folder = self.folder / "uploads" / re.sub(r"\W", "", self.query["uploadId"])
        if not folder.is_dir():
            raise Refused(404, "NoSuchUpload")
        return folder

    def on_post(self):
        if "delete" in self.query:
            keys = re.findall(r"<Key>(.*?)</Key>", self.body.decode())
            for key in keys:
                self.path_of(key).unlink(missing_ok=True)
            deleted = "".join(f"<Deleted><Key>{key}</Key></Deleted>" for key in keys)
            return self.reply(200, f"<DeleteResult>{deleted}</DeleteResult>".encode())
        if "uploads" in self.query:
            name = secrets.token_hex(8)
            (self.folder / "uploads" / name).mkdir(parents=True)
            return self.named("InitiateMultipartUploadResult", f"<UploadId>{name}</UploadId>")
        folder = self.upload()
        parts = re.findall(r"<PartNumber>(\d+)<", self.body.decode())
        self.store(b"".join((folder / f"{int(part):05}").read_bytes() for part in parts))
        shutil.rmtree(folder)
        etag = escape(self.etag_of(self.path_of(self.key)))
        return self.named("CompleteMultipartUploadResult", f"<ETag>{etag}</ETag>")

    def named(self, what, more):
        """A reply about an upload."""
        place = f"<Bucket>{self.bucket.name}</Bucket><Key>{escape(self.key)}</Key>"
        self.reply(200, f"<{what}>{place}{more}</{what}>".encode())

    def on_delete(self):
        if "uploadId" in self.query:
            shutil.rmtree(self.upload())
        else:
            self.path_of(self.key).unlink(missing_ok=True)
        self.reply(204)

    def on_head(self):
        path = self.path_of(self.key)
        self.reply(200, length=path.stat().st_size, **self.about(path))

    def about(self, path):
        return {"ETag": self.etag_of(path), "Last_Modified": formatdate(path.stat().st_mtime, usegmt=True)}

    def on_get(self):
        if not self.key:
            return self.list()
        path = self.path_of(self.key)
        data = path.read_bytes()
        if ranged := re.fullmatch(r"bytes=(\d+)-(\d*)", self.headers.get("Range", "")):
            first, last = int(ranged[1]), min(int(ranged[2] or len(data)), len(data) - 1)
            if first >= len(data):
                raise Refused(416, "InvalidRange")
            place = f"bytes {first}-{last}/{len(data)}"
            return self.reply(206, data[first : last + 1], Content_Range=place, **self.about(path))
        return self.reply(200, data, **self.about(path))

    def list(self):
        if not self.bucket.is_dir():
            raise Refused(404, "NoSuchBucket")
        prefix, delimiter = self.query.get("prefix", ""), self.query.get("delimiter", "")
        after = self.query.get("continuation-token") or self.query.get("start-after", "")
        keys = sorted(unquote(name) for name in os.listdir(self.bucket))
        keys = [key for key in keys if key.startswith(prefix) and key > after]
        folders = set()
        if delimiter:
            folders = {prefix + key[len(prefix) :].split(delimiter)[0] + delimiter for key in keys if delimiter in key[len(prefix) :]}
            keys = [key for key in keys if delimiter not in key[len(prefix) :]]
        page, more = keys[:PAGE], len(keys) > PAGE
        found = [f"<CommonPrefixes><Prefix>{escape(name)}</Prefix></CommonPrefixes>" for name in sorted(folders)]
        for key in page:
            try:
                status = self.path_of(key).stat()
            except FileNotFoundError:
                continue
            when = datetime.fromtimestamp(status.st_mtime, timezone.utc).strftime("%Y-%m-%dT%H:%M:%S.%fZ")
            about = f"<LastModified>{when}</LastModified><Size>{status.st_size}</Size>"
            found.append(f"<Contents><Key>{escape(key)}</Key>{about}</Contents>")
        token = f"<NextContinuationToken>{escape(page[-1])}</NextContinuationToken>" if more else ""
        text = f"<ListBucketResult><IsTruncated>{str(more).lower()}</IsTruncated>{token}{''.join(found)}</ListBucketResult>"
        return self.reply(200, text.encode(), Content_Type="application/xml")

    def log_message(self, *_):
        """Says nothing."""


if __name__ == "__main__":
    Handler.folder = Path(sys.argv[2])
    (Handler.folder / "objects").mkdir(parents=True, exist_ok=True)
    ThreadingHTTPServer(("127.0.0.1", int(sys.argv[1])), Handler).serve_forever()
