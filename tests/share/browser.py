# SPDX-License-Identifier: BSD-3-Clause
"""Chromium without a window, driven through its own pipe by the standard library alone, and PNG files as rows of pixels."""
import base64
import fcntl
import json
import os
import select
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import zlib

SKIPPED = 77
FREE_DESCRIPTOR = 64  # above those of a test


def chromium():
    """The browser, or the end of the test with its name."""
    for name in ("chromium", "chromium-browser"):
        if path := shutil.which(name):
            return path
    print("skipped: chromium is not installed")
    sys.exit(SKIPPED)


class Browser:
    """One page. Everything that it logs, and every load that it asks for, is kept."""

    def __init__(self, width=1500, height=1000, flags=()):
        self.profile = tempfile.mkdtemp(prefix="glint-browser-")
        to_read, self.to = os.pipe()
        self.back, from_write = os.pipe()

        def hand_over():  # Chromium reads commands from 3 and writes answers to 4
            # Either end may be 3 or 4 itself: copies out of the way come first.
            read, write = (fcntl.fcntl(end, fcntl.F_DUPFD, FREE_DESCRIPTOR) for end in (to_read, from_write))
            os.dup2(read, 3)
            os.dup2(write, 4)
            os.setsid()

        self.process = subprocess.Popen(
            [chromium(), "--headless=new", "--remote-debugging-pipe", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
             "--disable-dev-shm-usage", "--no-first-run", "--hide-scrollbars", f"--user-data-dir={self.profile}", f"--window-size={width},{height}",
             *flags, "about:blank"],
            preexec_fn=hand_over, pass_fds=(3, 4), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(from_write)
        self.rest, self.number, self.log, self.loads = b"", 0, [], []
        target = self.call("Target.getTargets", session=None)["targetInfos"]
        page = next(t for t in target if t["type"] == "page")
        self.session = self.call("Target.attachToTarget", {"targetId": page["targetId"], "flatten": True}, session=None)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(domain + ".enable")
        self.call("Emulation.setDeviceMetricsOverride", {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            os.killpg(self.process.pid, signal.SIGKILL)  # its own group alone
        except ProcessLookupError:
            pass
        self.process.wait()
        os.close(self.to)
        os.close(self.back)
        shutil.rmtree(self.profile, ignore_errors=True)

    def read(self, seconds=120):
        end = time.monotonic() + seconds
        while b"\0" not in self.rest:
            if not select.select([self.back], [], [], max(0, end - time.monotonic()))[0]:
                raise TimeoutError("the browser does not answer")
            part = os.read(self.back, 1 << 20)
            if not part:
                raise EOFError("the browser ended")
            self.rest += part
        message, self.rest = self.rest.split(b"\0", 1)
        message = json.loads(message)
        method, params = message.get("method"), message.get("params", {})
        if method == "Runtime.exceptionThrown":
            self.log.append("exception: " + json.dumps(params["exceptionDetails"])[:400])
        elif method == "Runtime.consoleAPICalled" and params["type"] in ("error", "warning", "assert"):
            self.log.append(params["type"] + ": " + json.dumps(params["args"])[:400])
        elif method == "Log.entryAdded" and params["entry"]["level"] in ("error", "warning"):
            self.log.append(params["entry"]["level"] + ": " + params["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            self.loads.append(params["request"]["url"])
        return message

    def call(self, method, params=None, session=""):
        self.number += 1
        message = {"id": self.number, "method": method, "params": params or {}}
        if session is not None:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.read()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]

    def evaluate(self, expression):
        result = self.call("Runtime.evaluate", {"expression": expression, "returnByValue": True, "awaitPromise": True})
        if "exceptionDetails" in result:
            raise RuntimeError(f"{expression}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def open(self, url):
        self.call("Page.navigate", {"url": "about:blank"})
        self.call("Page.navigate", {"url": url})
        self.wait("document.readyState === 'complete' && window.glintPage !== undefined")
        self.settle()

    def wait(self, expression, seconds=60):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if self.evaluate(expression):
                return
            time.sleep(0.05)
        raise TimeoutError(expression)

    def settle(self):
        """Until thumbnails are decoded and nothing is drawn any more."""
        last = None
        for _ in range(100):
            time.sleep(0.15)
            drawn = self.evaluate("glintPage.drawn()")
            if drawn == last:
                return
            last = drawn

    def mouse(self, kind, x, y, buttons=1):
        self.call("Input.dispatchMouseEvent", {"type": kind, "x": x, "y": y, "button": "left", "buttons": buttons, "clickCount": 1})

    def click(self, x, y):
        self.mouse("mouseMoved", x, y, 0)
        self.mouse("mousePressed", x, y)
        self.mouse("mouseReleased", x, y, 0)

    def picture(self, file=None, whole=False):
        png = base64.b64decode(self.call("Page.captureScreenshot", {"format": "png", "captureBeyondViewport": whole})["data"])
        if file:
            with open(file, "wb") as out:
                out.write(png)
        return Picture(png)


class Picture:
    """8-bit RGB or RGBA without interlacing, which is what Chromium writes."""

    def __init__(self, png):
        at, packed = 8, b""
        while at < len(png):
            size, kind = struct.unpack(">I4s", png[at:at + 8])
            body = png[at + 8:at + 8 + size]
            if kind == b"IHDR":
                self.width, self.height, bits, colour = struct.unpack(">IIBB", body[:10])
                assert bits == 8 and colour in (2, 6)
                self.channels = 3 if colour == 2 else 4
            elif kind == b"IDAT":
                packed += body
            at += 12 + size
        self.rows = list(self.unfiltered(zlib.decompress(packed)))

    def unfiltered(self, raw):
        n, stride = self.channels, self.width * self.channels
        above = bytearray(stride)
        for y in range(self.height):
            kind, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
            for i in range(stride) if kind else ():
                left, up, corner = row[i - n] if i >= n else 0, above[i], above[i - n] if i >= n else 0
                if kind == 1:
                    row[i] = (row[i] + left) & 255
                elif kind == 2:
                    row[i] = (row[i] + up) & 255
                elif kind == 3:
                    row[i] = (row[i] + (left + up) // 2) & 255
                else:
                    p = left + up - corner
                    best = min((abs(p - left), 0, left), (abs(p - up), 1, up), (abs(p - corner), 2, corner))
                    row[i] = (row[i] + best[2]) & 255
            yield row
            above = row

    def at(self, x, y):
        n = self.channels
        return tuple(self.rows[y][n * x:n * x + 3])
