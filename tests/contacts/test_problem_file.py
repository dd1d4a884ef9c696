import copy
import math

import numpy as np
import pytest

from jaxleas.contacts import Phase
from jaxleas.contacts.problem_file import parse_problem, read_problem, write_problem
from jaxleas.files import write_json
from jaxleas.types.errors import InputError
from tests.contacts.worlds import problem, rectangle, stones


def change(described: dict, path: list, value) -> dict:
    changed = copy.deepcopy(described)
    here = changed
    for key in path[:-1]:
        here = here[key]
    if value is KeyError:
        del here[path[-1]]
    else:
        here[path[-1]] = value
    return changed


BENT = [[0, 0, 0], [1, 0, 0], [1, 1, 0.2], [0, 1, 0]]
TWICE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]] * 2
DART = [[0, 0, 0], [1, 0, 0], [0.3, 0.3, 0], [0, 1, 0]]


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        (["surfaces", "stone_1"], BENT, ["'stone_1' is not planar", "0.04951 m off"]),
        (["surfaces", "stone_1"], DART, ["'stone_1' is not convex", "m outside an edge"]),
        (["surfaces", "stone_1"], [[0, 0, 0], [1, 0, 0]], ["'stone_1' has 2 vertices"]),
        (["surfaces", "stone_1", 0, 2], math.nan, ["'stone_1'", "not finite"]),
        (["surfaces", "stone_1", 0, 2], "high", ["'stone_1'", "three numbers"]),
        (["surfaces"], {}, ["surfaces must be a non-empty object"]),
        (["phases", 1, "candidates"], ["start", "moon"], ["phase 1", "'moon' is no surface"]),
        (["phases", 2, "candidates"], [], ["phase 2 has no candidate surfaces"]),
        (["phases", 2, "foot"], "left", ["phase 2", "must be 'LF' or 'RF'", "'left'"]),
        (["phases", 1, "rotation"], [[2, 0, 0], [0, 1, 0], [0, 0, 1]], ["phase 1: 'rotation' is"]),
        (["initial", "LF", "orientation"], [0, 0, 0, 1], ["LF: 'orientation' is not", "vertical"]),
        (["phases", 2, "yaw"], 90.0, ["phase 2", "yaw 90 is beyond a full turn", "radians"]),
        (["phases", 2, "yaw"], [[1, 0], [0, 1]], ["phase 2", "one finite number of radians"]),
        (["phases", 2, "yaw"], math.nan, ["phase 2", "one finite number of radians"]),
        (["phases", 2, "yaw"], KeyError, ["phase 2", "foot, yaw and candidates"]),
        (["phases", 0, "root"], [0, 1], ["phase 0: root must be three numbers"]),
        (["phases"], [], ["at least one phase"]),
        (["initial", "LF", "position", 2], 0.1, ["initial LF", "'start', is 0.1 m away"]),
        (["initial", "RF"], KeyError, ["where LF and RF stand"]),
        (["model"], "com", ["model must be 'two_com' or 'feet'", "'com'"]),
        (["polytopes", "COM_in_LF"], KeyError, ["polytopes lacks COM_in_LF"]),
        (["polytopes", "RF_in_LF", "b"], [1.0], ["RF_in_LF: A has shape (6, 3) and b (1,)"]),
        (["polytopes", "RF_in_LF", "b"], [-1.0] * 6, ["RF_in_LF bounds no volume"]),
        (["polytopes", "RF_in_LF", "A", 0], [0, 0, 0], ["RF_in_LF: A has a row of zeros"]),
        (["foot_half_size"], [10, 6], ["foot_half_size", "not between 0 and 1 m"]),
        (["version"], 2, ["is of version 2"]),
        (["version"], True, ["is of version True"]),
        (["robot"], 3, ["robot must be a name", "not 3"]),
        (["polytop"], {}, ["unknown key 'polytop'", "did you mean 'polytopes'"]),
        (["phases", 1, "candidate"], ["start"], ["phase 1", "did you mean 'candidates'"]),
        (["phases", 1, "candidates"], "start", ["phase 1: candidates must be a list of names"]),
        (["phases", 2, "yaw"], 10**400, ["phase 2", "one finite number of radians"]),
        (["foot_half_size"], [10**400, 0.1], ["foot_half_size must be two numbers"]),
        (["polytopes", "RF_in_LF", "b"], [10**400] * 6, ["A and b must be lists of numbers"]),
        (["polytopes", "RF_in_LF", "b"], ["1"] * 6, ["A and b must be lists of numbers"]),
        (["polytopes", "RF_in_LH"], {}, ["unknown key 'RF_in_LH'", "did you mean"]),
        (["surfaces", "stone_1"], TWICE, ["'stone_1' repeats a vertex"]),
        (["phases"], KeyError, ["lacks phases"]),
        (["parts"], ["stone_1"], ["parts must be an object"]),
        (["parts"], {"stone_1": "moon"}, ["'stone_1' is part of 'moon'", "no surface"]),
        (["parts"], {"stone_1": "start", "stone_2": "stone_1"}, ["'stone_1' is a whole and also"]),
    ],
)
def test_a_mistake_is_one_sentence_that_names_it(path: list, value, words: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        parse_problem("p.json", change(stones(0.1), path, value))
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith("p.json")
    assert all(word in str(caught.value) for word in words), caught.value


def test_polytopes_may_be_left_out_for_a_known_robot_only() -> None:
    described = stones(0.1)
    del described["polytopes"]
    read = parse_problem("p.json", described)
    assert set(read.polytopes.com) == {"LF", "RF"}
    with pytest.raises(InputError, match="no step polytopes for robot 'spot'"):
        parse_problem("p.json", {**described, "robot": "spot"})


def test_a_problem_survives_its_file(tmp_path) -> None:
    before = problem({**stones(0.1, rise=0.05), "parts": {"stone_1": "start"}})
    write_problem(tmp_path / "p.json", before)
    after = read_problem(tmp_path / "p.json")
    assert list(after.surfaces) == list(before.surfaces)
    assert after.parts == {"stone_1": "start"}
    for name, surface in before.surfaces.items():
        np.testing.assert_allclose(after.surfaces[name].vertices, surface.vertices, atol=1e-12)
    assert [(p.foot, p.yaw, p.candidates) for p in after.steps] == [
        (p.foot, p.yaw, p.candidates) for p in before.steps
    ]
    assert list(before.polytopes.relative) == ["RF_in_LF", "LF_in_RF"]
    for group in ("relative", "com"):
        for name, one in getattr(before.polytopes, group).items():
            two = getattr(after.polytopes, group)[name]
            np.testing.assert_allclose(one.normals, two.normals, atol=1e-12)
            np.testing.assert_allclose(one.offsets, two.offsets, atol=1e-12)


def test_a_file_that_is_no_problem(tmp_path) -> None:
    write_json(tmp_path / "list.json", [1, 2])
    with pytest.raises(InputError, match="must be a JSON object"):
        read_problem(tmp_path / "list.json")


def test_either_winding_and_a_needless_corner_are_the_same_surface() -> None:
    square = rectangle(0.2, 0.4, -0.3, 0.3)
    listed = {"wound back": square[::-1], "with a needless corner": [*square, [0.2, 0.0, 0.0]]}
    for vertices in listed.values():
        described = stones(0.1)
        described["surfaces"]["stone_0"] = vertices
        surface = problem(described).surfaces["stone_0"]
        assert len(surface.vertices) == 4
        np.testing.assert_allclose(surface.normal, [0, 0, 1])
        np.testing.assert_allclose(surface.edge_normals @ [0.3, 0.0, 0.0] < surface.edge_offsets, 1)


def test_steps_keep_their_former_names() -> None:
    asked = problem(stones(0.1))
    assert asked.phases is asked.steps
    assert isinstance(asked.steps[0], Phase)
