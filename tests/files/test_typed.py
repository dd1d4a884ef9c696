"""What a file holds is what its reader counts on, or the first wrong key is named."""

import json
from dataclasses import dataclass

import pytest

from jaxleas.files import read_typed, typed
from jaxleas.types import InputError


@dataclass(frozen=True)
class Walk:
    steps: int
    places: tuple[float, ...]
    name: str = "walk"


def test_plain_values_become_typed_ones(tmp_path):
    path = tmp_path / "walk.json"
    path.write_text(json.dumps({"steps": 2, "places": [0, 0.5]}))
    assert read_typed(Walk, path, "walk") == Walk(2, (0.0, 0.5))
    assert typed(list[Walk], [{"steps": 1, "places": []}], "no walks") == [Walk(1, ())]


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ({"steps": "2", "places": []}, "walk.json is no walk: steps: Input should be"),
        ({"steps": True, "places": []}, "steps: Input should be"),
        ({"steps": 2, "places": [0, None]}, "places.1: Input should be"),
        ({"places": []}, "steps: Field required"),
        ([1], "walk.json is no walk: "),
        (None, "walk.json is no walk: "),
    ],
)
def test_what_is_wrong_is_one_sentence(tmp_path, value, words):
    path = tmp_path / "walk.json"
    path.write_text(json.dumps(value))
    with pytest.raises(InputError) as refusal:
        read_typed(Walk, path, "walk")
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)
