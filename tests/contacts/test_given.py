"""An option that a planner does not have is refused, also when it is given with its default."""

from pathlib import Path

import pytest

from jaxleas import cli
from jaxleas.contacts import read_plan
from jaxleas.files import write_npz
from jaxleas.terrain.scene_file import write_scene
from jaxleas.types import InputError
from tests.contacts.sampling.worlds import stairs, straight
from tests.contacts.test_commands import folder  # noqa: F401 (a fixture)


@pytest.mark.parametrize(
    ("line", "option"),
    [
        ("plan good.json --planner sampling --max-combinations 2000", "--max-combinations"),
        ("plan good.json --planner mip --max-combinations 2000", "--max-combinations"),
        ("contacts guide.npz --scene scene.json --planner sampling --model two_com", "--model"),
        ("contacts guide.npz --scene scene.json --planner sampling --window 0.8", "--window"),
        (
            "contacts guide.npz --scene scene.json --planner sampling --candidates window",
            "--candidates",
        ),
    ],
)
@pytest.mark.usefixtures("folder")
def test_what_is_given_is_given(line: str, option: str) -> None:
    with pytest.raises(InputError, match=option):
        cli.run([*line.split(), "--out", "plan.json"])
    assert not Path("plan.json").exists()


@pytest.mark.usefixtures("folder")
def test_what_is_left_out_has_the_planners_own_default() -> None:
    guide, names = straight(2.4, climbing=True), ("time", "position", "yaw", "velocity", "valid")
    write_npz("climb.npz", **{name: getattr(guide, name) for name in names})
    write_scene("stairs.json", stairs())
    line = "contacts climb.npz --scene stairs.json --planner sl1m --out"
    stated = "--model two_com --candidates window --window 0.8 --max-combinations 2000 --cost none"
    cli.run([*line.split(), "one.json"])
    cli.run([*line.split(), "two.json", *stated.split()])
    one, two = read_plan("one.json"), read_plan("two.json")
    assert one.feasible
    assert one.surfaces == two.surfaces
    assert one.footholds.tolist() == two.footholds.tolist()
