"""The viewer as a person meets it: a real browser, real clicks and keys, a picture to look at."""

import os
import queue
import signal
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

from jaxleas.terrain import Scene, write_scene
from jaxleas.terrain.polygons import box_faces
from jaxleas.training.policy import write_policy
from jaxleas.viewer.robot_shape import ROBOTS
from tests.browser import chromium, wait_until
from tests.guide.walkers import homing_policy

pytestmark = pytest.mark.slow
ARTIFACTS = Path(os.environ.get("JAXLEAS_ARTIFACTS", "build/artifacts"))
FLOOR = np.array([[0.0, -2.0, 0.0], [6.0, -2.0, 0.0], [6.0, 2.0, 0.0], [0.0, 2.0, 0.0]])
PRESS_PAD = """
const axes = arguments[0], buttons = [...Array(17)].map(() => ({ pressed: false }));
navigator.getGamepads = () => [{ connected: true, axes, buttons }];
"""


@pytest.fixture
def viewer(tmp_path):
    """The address of `jaxleas view` with two policies side by side; ended with Ctrl-C."""
    pytest.importorskip("viser", reason="viser is in the extra view")
    for name, speed in (("slow", 0.1), ("quick", 0.15)):
        write_policy(tmp_path / name / "policy.npz", homing_policy(speed))
    box = box_faces(np.array([[4.0, 1.0], [4.6, 1.0], [4.6, 1.6], [4.0, 1.6]]), 0.0, 0.7)
    write_scene(tmp_path / "yard.json", Scene({"floor": FLOOR}, box))
    command = [sys.executable, "-m", "jaxleas.cli", "view", str(tmp_path / "yard.json")]
    command += ["--policies", *(str(tmp_path / n / "policy.npz") for n in ("slow", "quick"))]
    command += ["--port", "0", "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        lines: queue.Queue[str] = queue.Queue()
        assert process.stdout is not None
        reader = threading.Thread(target=lambda: [lines.put(each) for each in process.stdout])
        reader.start()
        try:
            yield lines.get(timeout=120).split()[0]
        finally:
            process.send_signal(signal.SIGINT)
            assert process.wait(timeout=60) == 0
            reader.join()


def text_of(page) -> str:
    return page.execute_script("return document.body.innerText")


def test_a_robot_is_sent_by_clicks_keys_and_gamepad(viewer, tmp_path):
    with chromium(tmp_path / "profile") as page:
        from selenium.webdriver.common.action_chains import ActionChains
        from selenium.webdriver.common.by import By

        page.get(viewer)
        wait_until(lambda: "waiting for a goal" in text_of(page), "the robots stand ready")

        def press(label: str) -> None:
            page.find_element(By.XPATH, f"//button[contains(., '{label}')]").click()

        def fields() -> list:
            return page.find_elements(By.CSS_SELECTOR, "input[inputmode]")[:2]

        def goal() -> np.ndarray:
            return np.array([float(each.get_attribute("value")) for each in fields()])

        # A click on the canvas: the camera looks at the middle of the ground.
        canvas = page.find_element(By.TAG_NAME, "canvas")
        ActionChains(page).move_to_element(canvas).click().perform()
        wait_until(lambda: "walks" in text_of(page), "a click sends the robots")
        assert np.abs(goal() - [3.0, 0.0]).max() < 0.2
        wait_until(lambda: text_of(page).count("has arrived") == 2, "both robots arrive")
        take_picture(page, "viewer.png")

        press("Back to the start")
        wait_until(lambda: "waiting for a goal" in text_of(page), "the robots are back")
        ActionChains(page).move_to_element(canvas).send_keys("i").perform()
        wait_until(lambda: "walks" in text_of(page), "a key sends them ahead")
        press("Back to the start")
        wait_until(lambda: "waiting for a goal" in text_of(page), "the robots are back")

        page.execute_script(PRESS_PAD, [0.0, -1.0])
        wait_until(lambda: "walks" in text_of(page), "so does the stick of a gamepad")
        page.execute_script(PRESS_PAD, [0.0, 0.0])

        errors = [each["message"] for each in page.get_log("browser") if each["level"] == "SEVERE"]
        assert not errors


def take_picture(page, name: str) -> None:
    """Keep a picture of the page; require that both robots are in it."""
    ARTIFACTS.mkdir(parents=True, exist_ok=True)
    page.save_screenshot(str(ARTIFACTS / name))
    seen = picture(ARTIFACTS / name)
    for colour in ROBOTS[:2]:
        assert hue_is_seen(seen, colour), colour


def picture(path: Path) -> np.ndarray:
    from PIL import Image

    with Image.open(path) as image:
        return np.asarray(image.convert("RGB"), np.float64)


def hue_is_seen(pixels: np.ndarray, colour: tuple[int, int, int]) -> bool:
    """Whether some hundred pixels left of the panel have a colour's hue, however they are lit."""
    wanted = np.array(colour) - np.mean(colour)
    part = pixels[200:, :1000].reshape(-1, 3)
    offset = part - part.mean(axis=1, keepdims=True)
    length = np.linalg.norm(offset, axis=1)
    cosine = offset @ wanted / (np.linalg.norm(wanted) * np.maximum(length, 1.0))
    return int(((cosine > 0.95) & (length > 40.0)).sum()) > 100
