"""A headless Chromium for tests, by plain WebDriver: no more than a page's tests need."""

import json
import os
import shutil
import signal
import subprocess
import threading
import urllib.request
from contextlib import contextmanager

import psutil

from farhand.common.link.ports import free_ports

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--hide-scrollbars",
    "--no-first-run",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)
VIRTUAL = {"Escape": 27}


class Browser:
    """Args:
    width, height: of the page (px).
    flags: further ones.
    """

    def __init__(self, width=1280, height=720, flags=()):
        (port,) = free_ports(1)
        self._url = f"http://127.0.0.1:{port}"
        self._driver = subprocess.Popen(
            [DRIVER, f"--port={port}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        options = {"binary": CHROMIUM, "args": [*FLAGS, *flags, f"--window-size={width},{height}"]}
        wanted = {"capabilities": {"alwaysMatch": {"goog:chromeOptions": options}}}
        pause = threading.Event()
        for _ in range(100):
            try:
                self._session = self._ask("POST", "/session", wanted)["sessionId"]
                break
            except OSError:
                pause.wait(0.1)
        else:
            raise AssertionError("chromedriver does not answer")
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 700}
        self.cdp("Emulation.setDeviceMetricsOverride", **size)

    def _ask(self, method, path, body=None):
        data = json.dumps(body or {}).encode() if method == "POST" else None
        request = urllib.request.Request(
            self._url + path, data, {"Content-Type": "application/json"}, method=method
        )
        with urllib.request.urlopen(request, timeout=60) as answer:
            return json.loads(answer.read())["value"]

    def post(self, path, **body):
        return self._ask("POST", f"/session/{self._session}/{path}", body)

    def cdp(self, command, **params):
        return self.post("goog/cdp/execute", cmd=command, params=params)

    def open(self, url):
        self.post("url", url=url)

    def run(self, script):
        return self.post("execute/sync", script=script, args=[])

    def text(self, name):
        return self.run(f"return document.getElementById('{name}').innerText")

    def click(self, selector):
        self.run(f"document.querySelector({selector!r}).click()")

    def key(self, code, down=True, repeat=False):
        key = code.removeprefix("Key").lower() if code.startswith("Key") else code
        self.cdp(
            "Input.dispatchKeyEvent",
            type="keyDown" if down else "keyUp",
            code=code,
            key=key,
            windowsVirtualKeyCode=VIRTUAL.get(code, ord(key[0].upper())),
            autoRepeat=repeat,
        )

    @contextmanager
    def later(self, code):
        """A key that goes down while the browser may be frozen, and up at the end."""
        thread = threading.Thread(target=self.key, args=(code,), daemon=True)
        thread.start()
        try:
            yield
        finally:
            thread.join(20)
            self.key(code, down=False)

    def hang(self, seconds):
        """Keep the page's own thread busy, without waiting for it."""
        self.run(
            f"setTimeout(() => {{const t = performance.now(); while (performance.now() - t < {seconds * 1e3});}}, 0)"
        )

    def new_tab(self, in_front=True):
        """Another tab, which is gone to if it is in front."""
        before = self.tab
        handle = self.post("window/new", type="tab")["handle"]
        self.post("window", handle=handle if in_front else before)
        self.cdp("Page.bringToFront")
        return handle

    @property
    def tabs(self):
        return self._ask("GET", f"/session/{self._session}/window/handles")

    @property
    def tab(self):
        return self._ask("GET", f"/session/{self._session}/window")

    def go_to(self, handle):
        self.post("window", handle=handle)

    def close_tab(self):
        self._ask("DELETE", f"/session/{self._session}/window")

    def processes(self):
        """Those of the browser, not its driver's."""
        return psutil.Process(self._driver.pid).children(recursive=True)

    def freeze(self, frozen=True):
        for process in self.processes():
            process.send_signal(signal.SIGSTOP if frozen else signal.SIGCONT)

    def picture(self, path):
        import base64

        path.write_bytes(base64.b64decode(self._ask("GET", f"/session/{self._session}/screenshot")))

    def close(self):
        left = self.processes()
        for process in left:
            process.send_signal(signal.SIGCONT)
        self._driver.terminate()
        self._driver.wait(10)
        for process in left:
            try:
                os.kill(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
