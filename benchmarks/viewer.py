"""The viewer for a user: time to the first picture, frames per second while driving.

    python -m benchmarks.viewer runs/leas_p1 --terrain scene.json --json viewer.json

Needs Chromium and its driver, and the extras `view` and `dev`. `jaxleas view` and the browser,
which draws in software, share the cores of the machine.
"""

import argparse
import queue
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.measurements import Figure, Measurement, Metric, this_machine, write_measurements
from jaxleas.cli_guard import run_guarded
from jaxleas.viewer import SKY_ABOVE, SKY_BELOW
from tests.browser import chromium, wait_until

SECONDS = 10.0
"""Duration of driving that is counted [s]."""
GOAL_FPS, GOAL_SECONDS = 30.0, 3.0
COUNT_PICTURES = """
window.pictures = [], window.grounds = 0;
let drawn = false, ground = false;
for (const name of ["drawElements", "drawArrays"]) {
  const draw = WebGL2RenderingContext.prototype[name];
  WebGL2RenderingContext.prototype[name] = function (...given) {
    drawn = true, ground ||= name === "drawElements" && given[2] === this.UNSIGNED_INT;
    return draw.apply(this, given);
  };
}
const look = (now) => {
  if (drawn) window.pictures.push(now);
  if (ground) window.grounds += 1;
  drawn = ground = false;
  requestAnimationFrame(look);
};
requestAnimationFrame(look);
"""
"""A script that keeps the times of the frames in which the canvas was drawn, and counts those with
the ground, whose indices have 32 bits, unlike those of viser's own meshes."""


def frames_sent(address: str, seconds: float) -> int:
    """Count, as a second client of the page's server, the messages that move the first robot."""
    import viser
    import zstandard
    from websockets.exceptions import ConnectionClosed
    from websockets.sync.client import connect
    from websockets.typing import Subprotocol

    unpack, count = zstandard.ZstdDecompressor(), 0
    protocol = Subprotocol(f"viser-v{viser.__version__}")
    with connect(
        address.replace("http", "ws"), subprotocols=[protocol], max_size=None, compression=None
    ) as socket:
        deadline, begin = time.monotonic() + 2.0, 0.0
        while (now := time.monotonic()) < (begin + seconds if begin else deadline):
            try:
                packed = socket.recv(timeout=1.0)
            except (TimeoutError, ConnectionClosed):
                break
            if not begin and now > deadline - 1.0:  # earlier messages are the scene itself
                begin, count = now, 0
            assert isinstance(packed, bytes)
            size = int.from_bytes(packed[8:16], "little")
            content = unpack.decompress(packed[16 : 16 + size])
            count += b"SetPositionMessage" in content and b"/robot_0" in content
    return count


@contextmanager
def viewing(policies: Sequence[Path], terrain: Path) -> Iterator[tuple[str, float]]:
    """Yield the page's address, and the time until it was available [s]."""
    command = [sys.executable, "-m", "jaxleas.cli", "view", str(terrain), "--port", "0"]
    command += ["--no-browser", "--policies", *map(str, policies)]
    begin = time.perf_counter()
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        lines: queue.Queue[str] = queue.Queue()
        stdout = process.stdout
        assert stdout is not None
        reader = threading.Thread(target=lambda: [lines.put(each) for each in stdout])
        reader.start()
        try:
            yield lines.get(timeout=60).split()[0], time.perf_counter() - begin
        finally:
            process.send_signal(signal.SIGINT)
            process.wait(timeout=60)
            reader.join()


def is_drawn(page: Any) -> bool:
    """Return whether the ground is visible: the middle of the picture is not all background."""
    from io import BytesIO

    from PIL import Image

    with Image.open(BytesIO(page.get_screenshot_as_png())) as image:
        pixels = np.asarray(image.convert("RGB"), np.int64)
    middle = pixels[300:700, 200:900]
    ground = np.abs(middle - np.mean([SKY_ABOVE, SKY_BELOW], axis=0)).sum(axis=-1) > 60
    white = middle.min(axis=-1) > 250
    return bool((ground & ~white).mean() > 0.01)


def first_picture(page: Any, policies: Sequence[Path], terrain: Path) -> tuple[float, float]:
    """Return the seconds from the command, and from opening the page, to the first picture."""
    with viewing(policies, terrain) as (address, started):
        begin = time.perf_counter()
        page.get(address)
        # When the third frame begins the first is on the screen; a screenshot, which would delay
        # it, is taken only then.
        wait_until(
            lambda: page.execute_script("return window.grounds > 2"),
            "the ground is drawn",
            often=0.03,
        )
        drawn = time.perf_counter() - begin
        assert is_drawn(page), "the ground is not to be seen"
        page.get("about:blank")
    return started + drawn, drawn


def driving(page: Any, policies: Sequence[Path], terrain: Path) -> tuple[float, float, float]:
    """Return frames sent and pictures painted per second, and the longest pause, while robots walk.

    A key sends the robots ahead.
    """
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By

    with viewing(policies, terrain) as (address, _):
        page.get(address)
        text = lambda: page.execute_script("return document.body.innerText")  # noqa: E731
        wait_until(lambda: "waiting for a goal" in text(), "the robots stand ready")
        canvas = page.find_element(By.TAG_NAME, "canvas")
        ActionChains(page).move_to_element(canvas).send_keys("i").perform()
        wait_until(lambda: "walks" in text(), "a key sends the robots ahead")
        page.execute_script("window.pictures.length = 0")
        time.sleep(SECONDS)
        painted = np.array(page.execute_script("return window.pictures"))
        sent = frames_sent(address, 0.5 * SECONDS) / (0.5 * SECONDS)
        assert "walks" in text(), "the robots arrived before the time was over"
        page.get("about:blank")
    pause = float(np.diff(painted).max()) if len(painted) > 1 else 1000.0 * SECONDS
    return sent, len(painted) / SECONDS, pause


def main(arguments: Sequence[str]) -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("policies", nargs="+", type=Path)
    parser.add_argument("--terrain", type=Path, required=True)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--json", type=Path, required=True)
    given = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder, chromium(Path(folder)) as page:
        page.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": COUNT_PICTURES})
        page.get("about:blank")
        first = [first_picture(page, given.policies, given.terrain) for _ in range(given.runs)]
        drive = [driving(page, given.policies, given.terrain) for _ in range(given.runs)]
    lower = {"better": "lower", "tolerance": 0.3}
    figures = [
        (
            Metric("viewer_first_picture", "s", **lower),
            Figure([each[0] for each in first], limit=GOAL_SECONDS),
        ),
        (
            Metric("viewer_page_opened", "s", **lower),
            Figure([each[1] for each in first], limit=GOAL_SECONDS),
        ),
        (
            Metric("viewer_frames_sent", "frames/s"),
            Figure([each[0] for each in drive], limit=GOAL_FPS),
        ),
        (
            Metric("viewer_frames_painted", "frames/s"),
            Figure([each[1] for each in drive], limit=GOAL_FPS),
        ),
        (Metric("viewer_longest_pause", "ms", **lower), Figure([each[2] for each in drive])),
    ]
    machine = this_machine()
    measured = [Measurement.of(metric, figure, machine) for metric, figure in figures]
    write_measurements(given.json, measured)
    for each in measured:
        print(f"{each.name:24}{each.value:>8.4g} {each.unit}")


if __name__ == "__main__":
    sys.exit(run_guarded(lambda: main(sys.argv[1:])))
