import pytest

from jaxleas.geometry import Box
from jaxleas.types import InputError


@pytest.mark.parametrize(
    ("low", "high"),
    [
        ((0.0, 0.0, 0.0), (1.0, 0.0, 1.0)),
        ((0.0, 0.0, 2.0), (1.0, 1.0, 1.0)),
        ((0.0, float("nan"), 0.0), (1.0, 1.0, 1.0)),
        ((0.0, 0.0, 0.0), (1.0, 1.0, float("inf"))),
        ((0.0, 0.0), (1.0, 1.0)),
    ],
)
def test_what_is_no_box_is_refused(low, high):
    with pytest.raises(InputError, match="box"):
        Box(low, high)
