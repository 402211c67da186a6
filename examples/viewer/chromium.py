# SPDX-License-Identifier: BSL-1.0
"""A page in headless Chromium, driven over a pipe by the DevTools protocol: for tests and for pictures.

Needs Debian's chromium and nothing else. WebGL is drawn by the processor.
"""
import base64
import json
import os
import pathlib
import select
import subprocess
import tempfile
import time

FLAGS = ["--headless", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
         "--ignore-gpu-blocklist", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage", "--hide-scrollbars",
         "--remote-debugging-pipe",
         "--allow-pre-commit-input"]  # else input before the first frame is dropped, however long that takes


class BrowserError(Exception):
    """The browser did not answer, or the page failed."""


class Page:
    """One page. `errors` are console errors and uncaught exceptions, `requests` the addresses that it asked for."""

    def __init__(self, width=1200, height=800, seconds=120):
        self.seconds, self.n_sent, self.errors, self.requests, self.answers, self.loaded = seconds, 0, [], [], {}, set()
        self.folder = tempfile.TemporaryDirectory(prefix="framehex-chromium-", ignore_cleanup_errors=True)
        to_browser, self.to_browser = os.pipe()
        self.from_browser, from_browser = os.pipe()

        def take_places():  # the browser reads from descriptor 3 and writes to 4
            read, write = os.dup(to_browser), os.dup(from_browser)
            os.dup2(read, 3)
            os.dup2(write, 4)

        self.process = subprocess.Popen(
            ["chromium", *FLAGS, f"--user-data-dir={self.folder.name}", f"--window-size={width},{height}", "about:blank"],
            preexec_fn=take_places, close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            start_new_session=True)
        os.close(to_browser)
        os.close(from_browser)
        self.buffer, self.session = b"", None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Runtime", "Page", "Network", "Log"):
            self.call(f"{domain}.enable")
        self.call("Page.setLifecycleEventsEnabled", enabled=True)
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.session = None
            self.call("Browser.close")
            self.process.wait(10)
        except (BrowserError, subprocess.TimeoutExpired, OSError):
            self.process.kill()
            self.process.wait()
        os.close(self.to_browser)
        os.close(self.from_browser)
        self.folder.cleanup()

    def call(self, method, **parameters):
        self.n_sent += 1
        message = {"id": self.n_sent, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to_browser, json.dumps(message).encode() + b"\0")
        number, until = self.n_sent, time.monotonic() + self.seconds
        while number not in self.answers:
            self.listen(until)
        answer = self.answers.pop(number)
        if "error" in answer:
            raise BrowserError(f"{method}: {answer['error']['message']}")
        return answer["result"]

    def listen(self, until):
        """Takes in what the browser says next."""
        ready, _, _ = select.select([self.from_browser], [], [], max(0, until - time.monotonic()))
        if not ready:
            raise BrowserError(f"no answer within {self.seconds} s")
        received = os.read(self.from_browser, 1 << 20)
        if not received:
            raise BrowserError("the browser has ended")
        *messages, self.buffer = (self.buffer + received).split(b"\0")
        for message in map(json.loads, messages):
            if "id" in message:
                self.answers[message["id"]] = message
            else:
                self.note(message["method"], message["params"])

    def note(self, event, details):
        if event == "Page.lifecycleEvent" and details["name"] == "load":
            self.loaded.add(details["loaderId"])
        elif event == "Runtime.exceptionThrown":
            thrown = details["exceptionDetails"]
            self.errors.append(thrown.get("exception", {}).get("description", thrown["text"]))
        elif event == "Runtime.consoleAPICalled" and details["type"] in ("error", "warning", "assert"):
            self.errors.append(" ".join(str(a.get("value", a.get("description", ""))) for a in details["args"]))
        elif event == "Log.entryAdded" and details["entry"]["level"] == "error":
            self.errors.append(details["entry"]["text"])
        elif event == "Network.requestWillBeSent":
            self.requests.append(details["request"]["url"])

    def open(self, path, address=""):
        """Loads a file and waits until it is drawn. `address`: what stands after the # (docs/viewer.md)."""
        url = pathlib.Path(path).resolve().as_uri() + (f"#{address}" if address else "")
        if self.evaluate("location.href").split("#")[0] == url.split("#")[0]:
            self.navigate("about:blank")  # another # alone would load nothing
        self.navigate(url)
        self.settle()

    def navigate(self, url):
        """Goes to an address and waits until that one, and not what was there before, has been loaded."""
        answer = self.call("Page.navigate", url=url)
        if answer.get("errorText"):
            raise BrowserError(f"{url}: {answer['errorText']}")
        until = time.monotonic() + self.seconds
        while answer["loaderId"] not in self.loaded:
            self.listen(until)

    def settle(self):
        """Waits for two frames: changes are shown in the next one."""
        self.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))")

    def evaluate(self, expression):
        answer = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in answer:
            raise BrowserError(answer["exceptionDetails"].get("exception", {}).get("description", expression))
        return answer["result"].get("value")

    def press(self, key, shift=False):
        code = {"Tab": 9, "Enter": 13, "Escape": 27, " ": 32}.get(key)
        text = {"Enter": "\r"}.get(key, key if len(key) == 1 else None)
        details = {"key": key, "modifiers": 8 if shift else 0}
        if code:
            details["windowsVirtualKeyCode"] = code
        if text:
            details["text"] = text
        self.call("Input.dispatchKeyEvent", type="keyDown", **details)
        self.call("Input.dispatchKeyEvent", type="keyUp", **details)
        self.settle()

    def drag(self, start, end, n_steps=5, shift=False):
        modifiers = 8 if shift else 0
        mouse = {"button": "left", "modifiers": modifiers, "clickCount": 1}
        self.call("Input.dispatchMouseEvent", type="mousePressed", x=start[0], y=start[1], **mouse)
        for i in range(1, n_steps + 1):
            x, y = (a + (b - a) * i / n_steps for a, b in zip(start, end))
            self.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y, buttons=1, **mouse)
            self.settle()
        self.call("Input.dispatchMouseEvent", type="mouseReleased", x=end[0], y=end[1], **mouse)

    def picture(self, path=None):
        """What is seen, as the bytes of a PNG; also into a file."""
        png = base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])
        if path:
            pathlib.Path(path).write_bytes(png)
        return png
