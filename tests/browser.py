"""A real browser without a window, for the pages; tests skip where there is none."""

import functools
import shutil
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest

FLAGS = (
    *("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
    *("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--window-size=1400,900"),
)
PATIENCE = 120.0  # [s]: of a browser that draws in software beside other tests


@contextmanager
def chromium(profile: Path) -> Iterator[Any]:
    """Yield a driver of headless Chromium, with a new profile in a folder."""
    browser = shutil.which("chromium") or shutil.which("chromium-browser")
    driver = shutil.which("chromedriver")
    if browser is None or driver is None:
        pytest.skip("no Chromium here: apt-get install chromium chromium-driver")
    webdriver = pytest.importorskip("selenium.webdriver", reason="selenium is in the extra dev")
    options = webdriver.ChromeOptions()
    options.binary_location = browser
    for flag in (*FLAGS, f"--user-data-dir={profile}"):
        options.add_argument(flag)
    page = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
    page.set_script_timeout(PATIENCE)
    try:
        yield page
    finally:
        page.quit()


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """Serve a folder's files on the loopback interface; yield its address."""

    class Quiet(SimpleHTTPRequestHandler):
        def log_message(self, format: str, *args: Any) -> None:
            """Say nothing."""

    handler = functools.partial(Quiet, directory=str(folder))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}"
        finally:
            server.shutdown()
            thread.join()


def wait_until(
    holds: Callable[[], Any], what: str, patience: float = PATIENCE, often: float = 0.1
) -> Any:
    """Return what `holds` does once it is true, asked as often as that [s]."""
    deadline = time.monotonic() + patience
    while time.monotonic() < deadline:
        answer = holds()
        if answer:
            return answer
        time.sleep(often)
    pytest.fail(f"{what}: not within {patience:g} s")
