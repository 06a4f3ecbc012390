"""Runs a page in headless Chromium, with a web server of its own, and collects what the page posts.

A page of a test tells its results by `fetch("/post/NAME", {method: "POST", body})` and ends by posting to /post/done,
whose body is the verdict: "ok", or what is wrong. Names may repeat. The server sends no headers that a static host does
not send, too, and Chromium may reach no other host.

Use it so:

    import harness
    with harness.Server(folder, {"/test.html": page}) as server:
        posts = harness.run(server, "/test.html", seconds=60)
    for name, body in posts: ...

`python3 tests/web/harness.py FOLDER /PAGE.html [SECONDS]` runs a page that is there, and prints what it posts.
"""
import contextlib
import http.server
import os
import queue
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

SKIPPED = 77  # exit status of a test that cannot run here


class Failed(Exception):
    """Tells that a page did not end, or that its verdict is not ok."""


def chromium():
    """Returns the path of Chromium, or None if there is none."""
    for name in ("chromium", "chromium-browser", "google-chrome"):
        if path := shutil.which(name):
            return path
    return None


def skip_unless(condition, message):
    """Ends the program as skipped, with a message, unless the condition holds."""
    if not condition:
        print(f"skipped: {message}")
        sys.exit(SKIPPED)


class Handler(http.server.SimpleHTTPRequestHandler):
    """Serves the files of a folder and those in memory, and takes posts."""

    extensions_map = {**http.server.SimpleHTTPRequestHandler.extensions_map,
                      ".js": "text/javascript", ".mjs": "text/javascript", ".wasm": "application/wasm"}

    def do_GET(self):
        path = self.path.split("?")[0]
        self.server.requested.append(path)
        extra = self.server.extra.get(path)
        if extra is None:
            return super().do_GET()
        body = extra.encode() if isinstance(extra, str) else extra
        self.send_response(200)
        self.send_header("Content-Type", self.guess_type(path))
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def do_POST(self):
        body = self.rfile.read(int(self.headers["Content-Length"] or 0))
        self.send_response(204)
        self.end_headers()
        if self.path.startswith("/post/"):
            self.server.posts.put((self.path[len("/post/"):], body))

    def log_message(self, *_):
        pass


class Server(contextlib.AbstractContextManager):
    """Web server on a free port of this machine, for one test."""

    def __init__(self, folder, extra=None):
        handler = lambda *arguments: Handler(*arguments, directory=str(folder))  # noqa: E731
        self.http = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
        self.http.daemon_threads = True
        self.http.extra = extra or {}
        self.http.posts = queue.Queue()
        self.http.requested = []
        threading.Thread(target=self.http.serve_forever, daemon=True).start()

    def __exit__(self, *_):
        self.http.shutdown()
        self.http.server_close()

    @property
    def address(self):
        return f"http://127.0.0.1:{self.http.server_port}"

    @property
    def requested(self):
        """Returns the paths of all requests so far; each that is not of the folder is a request too many."""
        return list(self.http.requested)


@contextlib.contextmanager
def browser(address, options=()):
    """Starts Chromium at an address, and ends it and all that it has started."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        command = [chromium(), "--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--no-first-run",
                   "--disable-extensions", "--disable-background-networking", "--disable-component-update",
                   "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--force-color-profile=srgb",
                   "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",  # reaches this machine only
                   "--enable-logging=stderr", f"--user-data-dir={profile}", *options, address]
        with open(Path(profile) / "log", "w+b") as log:
            process = subprocess.Popen(command, stdout=log, stderr=log, start_new_session=True)
            try:
                yield process, log
            finally:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process.pid, 9)
                process.wait()


def console_lines(log):
    """Returns what pages wrote to the console so far."""
    log.seek(0)
    return [line for line in log.read().decode(errors="replace").splitlines() if "CONSOLE" in line]


def run(server, path, seconds=60, options=()):
    """Opens a page, waits until it has posted `done`, and returns all posts as (name, bytes).

    Raises Failed, with what the page wrote to the console, if it does not end in time or its verdict is not "ok".
    """
    posts, deadline = [], time.monotonic() + seconds
    with browser(server.address + path, options) as (process, log):
        while True:
            try:
                name, body = server.http.posts.get(timeout=0.2)
            except queue.Empty:
                if process.poll() is None and time.monotonic() < deadline:
                    continue
                state = "has ended" if process.poll() is not None else f"has not ended in {seconds} s"
                raise Failed("\n".join([f"{path} {state}", *console_lines(log)])) from None
            if name != "done":
                posts.append((name, body))
                continue
            if body != b"ok":
                raise Failed("\n".join([body.decode(errors="replace"), *console_lines(log)]))
            return posts


def main(arguments):
    if len(arguments) not in (2, 3):
        print(__doc__, file=sys.stderr)
        return 2
    skip_unless(chromium(), "Chromium is not installed (Debian: chromium)")
    with Server(arguments[0]) as server:
        try:
            for name, body in run(server, arguments[1], float(arguments[2]) if len(arguments) == 3 else 60):
                print(f"{name}: {body.decode(errors='replace')}")
        except Failed as failed:
            print(failed, file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
