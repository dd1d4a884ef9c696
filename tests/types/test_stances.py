import numpy as np
import pytest

from jaxleas.types import Contact, InputError, Pose, Stance, SupportPhase


def contact(effector: str, x: float, surface: str = "floor") -> Contact:
    return Contact(effector, surface, Pose.from_yaw(np.array([x, 0.0, 0.0]), 0.3))


@pytest.fixture
def stance() -> Stance:
    return Stance.of([contact("LF", 0.1), contact("RF", -0.1)])


def test_making_and_breaking_undo_each_other(stance):
    palm = contact("LP", 0.5, "wall")
    more = stance.making(palm)
    assert len(stance) == 2
    assert len(more) == 3
    assert stance.changed(more) == more.changed(stance) == ("LP",)
    assert stance.changed(more.breaking("LP")) == ()


def test_a_moved_contact_is_one_change(stance):
    moved = stance.making(contact("LF", 0.2))
    assert len(moved) == 2
    assert stance.changed(moved) == ("LF",)
    assert stance.changed(moved, within=0.11) == ()
    assert stance.changed(stance.making(contact("LF", 0.1, "step"))) == ("LF",)


def test_opposite_quaternions_are_the_same_contact(stance):
    left = stance["LF"]
    other = Contact("LF", "floor", Pose(left.pose.position, -left.pose.quaternion))
    assert left.is_at(other)
    assert not left.is_at(contact("RF", 0.1))
    np.testing.assert_allclose(left.normal, [0.0, 0.0, 1.0])


def test_a_stance_cannot_be_changed_from_outside(stance):
    with pytest.raises(TypeError):
        stance.contacts["LF"] = contact("LF", 3.0)


def test_what_is_no_stance_is_refused(stance):
    with pytest.raises(InputError, match="at most one contact of each effector"):
        Stance.of([contact("LF", 0.0), contact("LF", 0.1)])
    with pytest.raises(InputError, match="'RF' is listed under 'LF'"):
        Stance({"LF": contact("RF", 0.0)})
    with pytest.raises(InputError, match="'LP' has no contact in this stance; LF, RF has"):
        stance.breaking("LP")
    with pytest.raises(InputError, match="one pose, not a batch"):
        Contact("LF", "floor", Pose.from_yaw(np.zeros((2, 3)), np.zeros(2)))


@pytest.mark.parametrize("duration", [0.0, -1.0, float("nan"), float("inf")])
def test_a_phase_lasts_a_positive_time(stance, duration):
    assert SupportPhase(stance, 0.5).stance is stance
    with pytest.raises(InputError, match="positive time"):
        SupportPhase(stance, duration)
