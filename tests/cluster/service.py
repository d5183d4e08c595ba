"""A running `fathom serve`, asked over HTTP."""

import json
import os
import re
import subprocess
import threading
import urllib.error
import urllib.request

from harness import FATHOM, PATIENCE_S, ROOT, wait_until


class Service:
    """A service on a free port."""

    def __init__(self, data, *options, env=None):
        command = [FATHOM, "serve", "--listen", "127.0.0.1:0", "--data", data, "--workers", "0", *options]
        environment = os.environ | {"FATHOM_LOG": "warn"} | (env or {})
        environment.pop("FATHOM_TOKEN", None)
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(list(map(str, command)), stderr=pipe, text=True, env=environment, cwd=ROOT)
        self.said, self.url = [], None
        threading.Thread(target=self.read, daemon=True).start()
        wait_until(lambda: self.url or self.process.poll() is not None, "the service listens")
        assert self.url, "".join(self.said)

    def read(self):
        """Keeps what the service prints."""
        for line in self.process.stderr:
            self.said.append(line)
            if found := re.match(r"fathom listens on (\S+)", line):
                self.url = found[1]

    def ask(self, path, body=None, method=None, headers=()):
        """A request: the status and the bytes of the response."""
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.url + path, data=data, method=method)
        for name, value in [("content-type", "application/json"), *headers]:
            request.add_header(name, value)
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE_S) as response:
                return response.status, response.read()
        except urllib.error.HTTPError as error:
            return error.code, error.read()

    def json(self, path, body=None, method=None, headers=()):
        """A request that must succeed, as JSON."""
        status, text = self.ask(path, body, method, headers)
        assert status < 300, f"{path}: {status} {text.decode()}"
        return json.loads(text)

    def job(self, job):
        """A job as it is now."""
        return self.json(f"/v1/jobs/{job}")

    def wait_for(self, job, **fields):
        """Waits until a job has these fields; returns it."""
        wait_until(lambda: fields.items() <= self.job(job).items(), f"{job} has {fields}: {self.said}")
        return self.job(job)

    def stop(self):
        """Ends it in order; returns its exit status."""
        self.process.terminate()
        return self.process.wait(PATIENCE_S)

    def kill(self):
        """SIGKILL."""
        self.process.kill()
        self.process.wait()
