# SPDX-License-Identifier: GPL-2.0-or-later
"""Drive a real browser without a window, by the DevTools protocol over two pipes."""

from __future__ import annotations

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time
from functools import lru_cache

MISSING = "no Chromium was found; on Debian, as root: apt-get install chromium-headless-shell"
SECONDS = 60
"""Longest time to wait for an answer, far more than one takes: the machine may be busy."""
_NAMES = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")


@lru_cache(maxsize=None)
def command():
    """The browser on the PATH, or None."""
    return next(filter(None, map(shutil.which, _NAMES)), None)


class Browser:
    """One page in a fresh profile; use it in a ``with`` statement.

    Attributes
    ----------
    faults : list of str
        What the page wrote to its console as a warning or an error, and what it failed to load.
    requests : list of str
        Addresses that the page asked for.
    """

    def __init__(self, width=1280, height=1000):
        self.size = (width, height)
        self.faults, self.requests = [], []
        self._number, self._read, self._session = 0, b"", None

    def __enter__(self):
        self._profile = tempfile.TemporaryDirectory(prefix="browser-", ignore_cleanup_errors=True)
        down, self._write = os.pipe()
        self._replies, up = os.pipe()
        flags = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
                 "--remote-debugging-pipe", "--hide-scrollbars", f"--user-data-dir={self._profile.name}",
                 f"--window-size={self.size[0]},{self.size[1]}", "about:blank"]
        # The browser reads commands from its file 3 and writes replies to its file 4.
        shell = f'exec "$@" 3<&{down} 4>&{up}'
        self._process = subprocess.Popen(["bash", "-c", shell, "bash", command(), *flags],
                                         pass_fds=(down, up), stdout=subprocess.DEVNULL,
                                         stderr=subprocess.DEVNULL)
        os.close(down)
        os.close(up)
        pages = self.call("Target.getTargets")["targetInfos"]
        page = next(target["targetId"] for target in pages if target["type"] == "page")
        self._session = self.call("Target.attachToTarget", targetId=page, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        return self

    def __exit__(self, *error):
        os.close(self._write)  # at the end of its commands the browser ends
        try:
            self._process.wait(10)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        os.close(self._replies)
        self._profile.cleanup()

    def call(self, method, **parameters):
        """Give a command and return what it gives back."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        while True:
            reply = self._next(time.monotonic() + SECONDS)
            if reply.get("id") == self._number:
                assert "error" not in reply, reply["error"]
                return reply["result"]
            self._note(reply)

    def _next(self, deadline):
        while b"\0" not in self._read:
            ready, _, _ = select.select([self._replies], [], [], max(deadline - time.monotonic(), 0))
            assert ready, "the browser does not answer"
            piece = os.read(self._replies, 1 << 20)
            assert piece, "the browser has ended"
            self._read += piece
        text, _, self._read = self._read.partition(b"\0")
        return json.loads(text)

    def _note(self, event):
        method, about = event.get("method"), event.get("params", {})
        if method == "Runtime.exceptionThrown":
            self.faults.append(json.dumps(about["exceptionDetails"]))
        elif method == "Runtime.consoleAPICalled" and about["type"] in ("warning", "error", "assert"):
            self.faults.append(json.dumps(about["args"]))
        elif method == "Log.entryAdded":
            self.faults.append(about["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            self.requests.append(about["request"]["url"])

    def open(self, path):
        """Open a file and wait until it is drawn."""
        self.call("Page.navigate", url=path.resolve().as_uri())
        deadline = time.monotonic() + SECONDS
        while self.value("document.readyState") != "complete":
            assert time.monotonic() < deadline, f"{path} is not loaded"
            time.sleep(.02)
        self.settle()

    def settle(self):
        """Wait until what was done is drawn."""
        self.value("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))")

    def value(self, expression):
        """What an expression of JavaScript gives."""
        done = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in done, done["exceptionDetails"]
        return done["result"].get("value")

    def place(self, selector):
        """Left, top, width and height of an element on the screen."""
        return self.value(f"(() => {{ const box = document.querySelector({json.dumps(selector)})"
                          ".getBoundingClientRect(); return [box.x, box.y, box.width, box.height] })()")

    def mouse(self, kind, x, y, **more):
        """Let the mouse do something: pressed, moved, released or wheel."""
        event = {"wheel": "mouseWheel"}.get(kind, f"mouse{kind.capitalize()}")
        self.call("Input.dispatchMouseEvent", type=event, x=x, y=y, **more)

    def drag(self, start, end):
        """Drag from one point of the screen to another."""
        self.mouse("moved", *start)
        self.mouse("pressed", *start, button="left", buttons=1, clickCount=1)
        for part in (.25, .5, .75, 1):
            self.mouse("moved", *(a + (b - a) * part for a, b in zip(start, end)), button="left", buttons=1)
        self.mouse("released", *end, button="left", clickCount=1)
        self.settle()

    def click(self, selector):
        """Click in the middle of an element."""
        left, top, width, height = self.place(selector)
        self.drag((left + width / 2, top + height / 2), (left + width / 2, top + height / 2))

    def press(self, *keys):
        """Press keys, by their names."""
        for key in keys:
            for kind in ("keyDown", "keyUp"):
                self.call("Input.dispatchKeyEvent", type=kind, key=key, text=key if len(key) == 1 else "")
        self.settle()

    def shot(self, whole=False):
        """What is to be seen, or the whole page, as the bytes of a PNG."""
        done = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=whole)
        return base64.b64decode(done["data"])
