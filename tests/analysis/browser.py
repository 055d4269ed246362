"""A headless Chromium for tests, spoken to in the WebDriver protocol (W3C) through its driver."""

import json
import os
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any
from urllib.error import URLError
from urllib.request import ProxyHandler, Request, build_opener

import pytest

WANTED = "CDPR8_BROWSER_WANTED"
"""Set by `.ci/run`: there, a browser that is not installed fails the test."""

_OPENER = build_opener(ProxyHandler({}))


class Browser:
    """One window."""

    def __init__(self, port: int) -> None:
        self._address = f"http://127.0.0.1:{port}"
        arguments = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"]
        options = {
            "goog:chromeOptions": {"args": arguments, "binary": shutil.which("chromium")},
            "goog:loggingPrefs": {"performance": "ALL"},
        }
        made = self._ask("POST", "/session", {"capabilities": {"alwaysMatch": options}})
        self._session = f"/session/{made['sessionId']}"

    def __enter__(self) -> "Browser":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._ask("DELETE", self._session)

    def look(self, page: Path, *, width: int, dark: bool) -> None:
        """Open a page at a width, in light or dark."""
        metrics = {"width": width, "height": 844, "deviceScaleFactor": 2, "mobile": width < 600}
        self._devtools("Emulation.setDeviceMetricsOverride", metrics)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self._devtools("Emulation.setEmulatedMedia", {"features": [scheme]})
        self._ask("POST", f"{self._session}/url", {"url": page.resolve().as_uri()})

    def run(self, script: str) -> Any:
        """What a script returns."""
        body = {"script": script, "args": []}
        return self._ask("POST", f"{self._session}/execute/sync", body)

    def screenshot(self, path: Path) -> None:
        """The whole page as a picture."""
        from base64 import b64decode

        found = self._devtools("Page.captureScreenshot", {"captureBeyondViewport": True})
        path.write_bytes(b64decode(found["data"]))

    def requests(self) -> list[str]:
        """Everything that was asked for since the last call."""
        rows = self._ask("POST", f"{self._session}/se/log", {"type": "performance"})
        messages = [json.loads(row["message"])["message"] for row in rows]
        return [
            one["params"]["request"]["url"]
            for one in messages
            if one["method"] == "Network.requestWillBeSent"
        ]

    def _devtools(self, command: str, parameters: dict[str, Any]) -> Any:
        body = {"cmd": command, "params": parameters}
        return self._ask("POST", f"{self._session}/goog/cdp/execute", body)

    def _ask(self, method: str, path: str, body: dict[str, Any] | None = None) -> Any:
        data = None if body is None else json.dumps(body).encode()
        request = Request(self._address + path, data, method=method)
        request.add_header("Content-Type", "application/json")
        with _OPENER.open(request, timeout=60) as answer:
            return json.loads(answer.read())["value"]


@contextmanager
def open_browser() -> Iterator[Browser]:
    """A browser; where none is installed, skip, or fail where one is wanted."""
    driver = shutil.which("chromedriver")
    if driver is None or shutil.which("chromium") is None:
        reason = "no chromium and chromedriver here: apt-get install chromium chromium-driver"
        if os.environ.get(WANTED):
            pytest.fail(reason)
        pytest.skip(reason)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    process = subprocess.Popen(
        [driver, f"--port={port}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        _wait(port)
        with Browser(port) as browser:
            yield browser
    finally:
        process.terminate()
        process.wait(timeout=20)


def _wait(port: int) -> None:
    """Until the driver answers."""
    for _ in range(200):
        try:
            with _OPENER.open(f"http://127.0.0.1:{port}/status", timeout=5):
                return
        except (URLError, ConnectionError):
            time.sleep(0.05)
    pytest.fail("chromedriver does not answer")
