import json
from dataclasses import asdict, fields, replace

import numpy as np
import pytest

from jaxleas.files import write_npz
from jaxleas.footsteps import (
    FootstepRecords,
    Footsteps,
    join_footsteps,
    movement_of,
    read_footsteps,
    write_footsteps,
)
from jaxleas.types import ControllerIdentity, InputError
from tests.footsteps.made import IDENTITY, walked

NAMES = [each.name for each in fields(Footsteps)]


@pytest.fixture
def records():
    made = walked(runs=5, steps=8)
    return replace(made, collection={"seed": 3, "friction": [0.5, 1.0]})


def test_footsteps_survive_their_file(tmp_path, records):
    write_footsteps(tmp_path / "steps.npz", records)
    found = read_footsteps(tmp_path / "steps.npz")
    for name in NAMES:
        np.testing.assert_array_equal(
            getattr(found.footsteps, name), getattr(records.footsteps, name)
        )
    assert found.controller == IDENTITY
    assert (found.definition, found.rejected) == ("contact", {"apex too low": 3})
    assert found.collection == {"seed": 3, "friction": [0.5, 1.0]}


def test_movements_have_names():
    commands = [(1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, -1), (0, 0, 1), (0, 0, 0), (1, 1, 0)]
    names = movement_of(np.array(commands, dtype=float))
    wanted = ["forward", "left", "right", "clockwise", "counter-clockwise", "standing", "mixed"]
    assert list(names) == wanted
    assert list(movement_of(np.array([[-1.0, 0, 0]]))) == ["mixed"]


def test_joined_runs_stay_apart():
    first, second = walked(runs=2, steps=3).footsteps, walked(runs=3, steps=3).footsteps
    joined = join_footsteps([first, second])
    assert list(np.unique(joined.run)) == [0, 1, 2, 3, 4]
    np.testing.assert_array_equal(joined.com_after[6:], second.com_after)


@pytest.mark.parametrize("name", NAMES)
def test_what_is_no_array_of_footsteps_is_refused_by_name(records, name):
    array = getattr(records.footsteps, name)
    with pytest.raises(InputError, match=rf"^{name if name != 'run' else 'time'} has shape"):
        replace(records, footsteps=replace(records.footsteps, **{name: array[:-1]}))
    if array.dtype.kind == "f" and name != "apex":
        broken = array.copy()
        broken[3] = np.nan
        with pytest.raises(InputError, match=f"^{name} of footstep 3 is not finite"):
            replace(records, footsteps=replace(records.footsteps, **{name: broken}))


def test_a_pair_that_the_controller_lacks_is_refused(records):
    pair = records.footsteps.pair.copy()
    pair[4] = 2
    with pytest.raises(InputError, match=r"pair of footstep 4 is 2; .* has the pairs 0 to 1"):
        replace(records, footsteps=replace(records.footsteps, pair=pair))


def test_a_damaged_file_is_refused_by_key(tmp_path, records):
    path = tmp_path / "steps.npz"
    write_footsteps(path, records)
    arrays = dict(np.load(path))
    metadata = json.loads(str(arrays["metadata"]))

    def rewritten(change) -> None:
        write_npz(path, **arrays | {"metadata": np.array(json.dumps(metadata | change))})

    rewritten({"definition": "guess"})
    with pytest.raises(InputError, match=r"steps.npz: metadata.*: definition"):
        read_footsteps(path)
    rewritten({"version": 2})
    with pytest.raises(InputError, match="of version 2"):
        read_footsteps(path)
    rewritten({"controller": metadata["controller"] | {"pairs": [[0, 3], [1, 3]]}})
    with pytest.raises(InputError, match="must hold each of its 4 feet once"):
        read_footsteps(path)
    arrays.pop("apex")
    write_npz(path, **arrays)
    with pytest.raises(InputError, match="lacks the array apex"):
        read_footsteps(path)


def test_another_controller_is_refused_in_words():
    other = replace(IDENTITY, swing_height=0.1, settings={"cycle_time": 0.5})
    with pytest.raises(InputError) as caught:
        IDENTITY.require_same(other, "model.npz", "the footsteps")
    assert str(caught.value) == (
        "model.npz is of another controller than the footsteps: swing_height: 0.1 instead of"
        " 0.08; settings.cycle_time: 0.5 instead of not stated"
    )
    IDENTITY.require_same(ControllerIdentity(**asdict(IDENTITY)), "model.npz", "the footsteps")


def test_public_footsteps_alternate(public: FootstepRecords):
    steps = public.footsteps
    assert len(steps) == 7395
    assert (steps.pair == 0).sum() == 3698
    assert len(np.unique(steps.run)) == 23
    assert set(steps.movement) == {"forward", "standing"}
