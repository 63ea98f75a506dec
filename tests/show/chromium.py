"""Drive a headless Chromium over its own protocol: no package is needed but `websockets`."""

import base64
import json
import shutil
import subprocess
import tempfile
import time
import urllib.request
from contextlib import contextmanager
from itertools import count
from pathlib import Path

from websockets.sync.client import connect

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--remote-debugging-port=0",
)
WHERE = """(() => {{ const said = {};
  for (const one of document.querySelectorAll('button, label, span, div, p')) {{
    if (one.children.length === 0 && one.textContent.trim() === said) {{
      const box = one.getBoundingClientRect();
      one.scrollIntoView({{block: 'nearest'}});
      if (box.width > 0) return [box.x + box.width / 2, box.y + box.height / 2];
  }} }} return null; }})()"""
LIMIT = 60.0  # s, for the browser to start, and for each answer


def program():
    """Return the path of a Chromium, or None."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


class Page:
    """A tab.

    Attributes:
        errors: what it wrote to the console as errors, and what it threw.
        requests: the addresses that it asked for.
    """

    def __init__(self, socket):
        self._socket, self._numbers = socket, count(1)
        self.errors, self.requests = [], []
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def call(self, method, **parameters):
        """Ask for something, and return the answer; events on the way are kept."""
        number = next(self._numbers)
        self._socket.send(json.dumps({"id": number, "method": method, "params": parameters}))
        end = time.monotonic() + LIMIT
        while True:
            message = json.loads(self._socket.recv(timeout=max(0.01, end - time.monotonic())))
            if message.get("id") == number:
                assert "error" not in message, (method, message["error"])
                return message["result"]
            self._keep(message.get("method"), message.get("params", {}))

    def _keep(self, event, said):
        if event == "Runtime.exceptionThrown":
            self.errors.append(json.dumps(said["exceptionDetails"])[:500])
        elif event == "Runtime.consoleAPICalled" and said["type"] in ("error", "assert"):
            self.errors.append(json.dumps(said["args"])[:500])
        elif event == "Log.entryAdded" and said["entry"]["level"] == "error":
            self.errors.append(f"{said['entry']['text']} {said['entry'].get('url', '')}")
        elif event == "Network.requestWillBeSent":
            self._ask(said["request"]["url"])
        elif event == "Network.webSocketCreated":
            self._ask(said["url"])

    def _ask(self, address):
        if not address.startswith(("data:", "blob:")):  # they come with the page
            self.requests.append(address)

    def open(self, address):
        self.call("Page.navigate", url=address)

    def size(self, width, height, scale=1, *, phone=False, dark=False):
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width, height=height, deviceScaleFactor=scale, mobile=phone,
        )  # fmt: skip
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.call("Emulation.setEmulatedMedia", features=[scheme])

    def run(self, script):
        """Return the value of an expression."""
        answer = self.call(
            "Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True
        )
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def wait(self, script, limit=LIMIT):
        """Wait until an expression is true, for so many seconds at most."""
        end = time.monotonic() + limit
        while not (value := self.run(script)):
            assert time.monotonic() < end, f"not within {limit} s: {script}"
            time.sleep(0.1)
        return value

    def drag(self, begin, end, steps=8):
        """Press the mouse at (x, y), move it to another, and let go."""
        self._mouse("mouseMoved", begin, "none")
        time.sleep(0.5)  # what is under it lights up a frame later
        self._mouse("mousePressed", begin, "left")
        for i in range(1, steps + 1):
            at = tuple(a + (b - a) * i / steps for a, b in zip(begin, end, strict=True))
            self._mouse("mouseMoved", at, "left")
            time.sleep(0.1)
        self._mouse("mouseReleased", end, "left")

    def click(self, words):
        """Click on the middle of the element with these words, as soon as there is one."""
        where = WHERE.format(json.dumps(words))
        self.wait(where)  # scrolls to it
        time.sleep(0.3)
        at = self.run(where)
        self.drag(at, at, steps=1)

    def _mouse(self, kind, at, button):
        pressed = {"buttons": 0 if button == "none" else 1, "clickCount": 1}
        self.call("Input.dispatchMouseEvent", type=kind, x=at[0], y=at[1], button=button, **pressed)

    def picture(self):
        """Return what is seen as PNG."""
        return base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])

    def close(self):
        self.call("Page.close")


@contextmanager
def chromium():
    """Run a browser with an empty profile and yield a function that opens a tab."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        command = [program(), *FLAGS, f"--user-data-dir={profile}", "about:blank"]
        quiet = {"stdin": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, **quiet) as process:
            try:
                port = _port(Path(profile) / "DevToolsActivePort")
                sockets = []

                def tab():
                    ask = urllib.request.Request(
                        f"http://127.0.0.1:{port}/json/new?about:blank", method="PUT"
                    )
                    found = json.loads(urllib.request.urlopen(ask, timeout=LIMIT).read())
                    socket = connect(found["webSocketDebuggerUrl"], max_size=None, proxy=None)
                    sockets.append(socket)
                    return Page(socket)

                yield tab
                for socket in sockets:
                    socket.close()
            finally:
                process.terminate()
                try:
                    process.wait(5)
                except subprocess.TimeoutExpired:
                    process.kill()


def _port(file):
    end = time.monotonic() + LIMIT
    while True:
        lines = file.read_text().splitlines() if file.exists() else []
        if lines:
            return int(lines[0])
        assert time.monotonic() < end, "the browser does not start"
        time.sleep(0.05)
