"""A running `fathom serve`, asked over HTTP."""

import contextlib
import json
import os
import signal
import subprocess
import time
import urllib.error
import urllib.request
import uuid

START_LIMIT_S = 90
JOB_LIMIT_S = 300


class Service:
    """What a service says."""

    def __init__(self, url):
        self.url = url

    def ask(self, path, body=None, method=None, kind="application/json", **headers):
        """Status, media type and bytes of a response."""
        data = json.dumps(body).encode() if isinstance(body, (dict, list)) else body
        headers = {key.replace("_", "-"): value for key, value in headers.items()} | ({"Content-Type": kind} if data is not None else {})
        request = urllib.request.Request(self.url + path, data=data, headers=headers, method=method)
        try:
            response = urllib.request.urlopen(request, timeout=120)
        except urllib.error.HTTPError as refused:
            response = refused
        with response:
            return response.status, response.headers.get("Content-Type", ""), response.read()

    def json(self, path, body=None, method=None, expect=(200, 201, 202, 204), **headers):
        status, _, data = self.ask(path, body, method, **headers)
        if status not in expect:
            raise SystemExit(f"{method or ('GET' if body is None else 'POST')} {path}: {status} {data.decode()}")
        return json.loads(data or b"null")

    def form(self, path, **fields):
        """POST of a multipart form."""
        boundary = uuid.uuid4().hex
        parts = b""
        for name, value in fields.items():
            data = value if isinstance(value, bytes) else str(value).encode()
            parts += f'--{boundary}\r\nContent-Disposition: form-data; name="{name}"\r\n\r\n'.encode() + data + b"\r\n"
        status, _, data = self.ask(path, parts + f"--{boundary}--\r\n".encode(), kind=f"multipart/form-data; boundary={boundary}")
        if status not in (200, 201):
            raise SystemExit(f"{path}: {status} {data.decode()}")
        return json.loads(data)

    def wait(self, job, until):
        """Waits until a job fulfills a condition and returns it."""
        end = time.monotonic() + JOB_LIMIT_S
        while time.monotonic() < end:
            found = self.json(f"/v1/jobs/{job}")
            if until(found):
                return found
            time.sleep(0.01)
        raise SystemExit(f"job {job} does not get there: {found}")

    def ended(self, job):
        return self.wait(job, lambda found: found["state"] in ("done", "done_with_failures", "cancelled"))


@contextlib.contextmanager
def serve(binary, data, work, workers, **environment):
    """A service over a data folder, stopped in order at the end."""
    clean = {key: value for key, value in os.environ.items() if not key.startswith("FATHOM_")}
    command = [binary, "serve", "--listen", "127.0.0.1:0", "--data", str(data), "--workers", str(workers), "--slots", "2", "--styles", "styles"]
    log = work / "serve.log"
    with log.open("w") as said:
        process = subprocess.Popen(command, cwd=work, env=clean | {"FATHOM_LOG": "warn"} | environment, stderr=said)
    try:
        yield Service(address(process, log))
    finally:
        process.send_signal(signal.SIGTERM)
        process.wait(60)


def address(process, log):
    end = time.monotonic() + START_LIMIT_S
    while time.monotonic() < end and process.poll() is None:
        for line in log.read_text().splitlines(keepends=True):
            # The program writes its lines in pieces.
            if line.startswith("fathom listens on ") and line.endswith("\n"):
                return line.removeprefix("fathom listens on ").strip()
        time.sleep(0.02)
    process.kill()
    raise SystemExit("the service does not listen:\n" + log.read_text())
