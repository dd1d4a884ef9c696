"""What a configuration names becomes a condition; what it cannot name is refused in a sentence."""

import sys

import jax.numpy as jnp
import numpy as np
import pytest
import yaml

from jaxleas.conditions.named import STANDARD, SurrogateSettings, harmless, pinned
from jaxleas.configuration.loading import to_yaml
from jaxleas.envs.steering import SteeringConfig, SteeringEnv
from jaxleas.surrogates import SurrogateForesight
from jaxleas.surrogates.surrogate_file import write_surrogate
from jaxleas.training.run_config import load_run_config
from jaxleas.types import InputError, RootMotion
from tests.surrogates.test_foresight import surrogate

OWN = '''
"""Conditions of one's own."""

import numpy as np


class Level:
    """Hold while the ground ahead rises by less than 0.2 m."""

    def __init__(self, robot, candidates):
        self.points_in_root = np.array([[0.5, 0.0], [0.7, 0.0]])
        self.height = robot.walking_height

    def __call__(self, heights_in_root, motion):
        return 0.2 - (heights_in_root[..., 1] + self.height)


class Deaf:
    def __init__(self, robot, candidates):
        pass

    def __call__(self, heights_in_root, motion):
        return motion.yaw


class Odd(Deaf):
    points_in_root = [[0.0, 0.0, 0.0]]


class One:
    points_in_root = [[0.0, 0.0]]

    def __init__(self, robot, candidates):
        pass

    def __call__(self, heights_in_root, motion):
        return heights_in_root.max()


class Raising:
    def __init__(self, robot, candidates):
        raise ValueError(f"no {robot.name}")


class Memory:
    def __init__(self, robot, candidates):
        pass

    def begin(self, heights_in_root, motion, chance):
        return chance, chance

    def follow(self, memory, look_around, motion):
        return memory, memory
'''


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A working folder with conditions of one's own and a surrogate."""
    (tmp_path / "my_conditions.py").write_text(OWN)
    write_surrogate(tmp_path / "surrogate.npz", surrogate(hazard=0.1))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))
    yield tmp_path
    sys.modules.pop("my_conditions", None)


def run_config(folder, conditions, **env):
    (folder / "run.yaml").write_text(yaml.safe_dump({"env": {"conditions": conditions, **env}}))
    return load_run_config(folder / "run.yaml")


def margins(env, ahead):
    """Margins of standing robots with some ground ahead, level elsewhere."""
    heights = np.full((len(ahead), len(env.points_in_root)), -env.robot.walking_height)
    x = env.points_in_root[:, 0]
    heights[:, x > 0.6] += np.asarray(ahead)[:, None]
    count = len(ahead)
    motion = RootMotion(jnp.zeros((count, 3)), jnp.zeros((count, 3)), jnp.zeros(count))
    return np.asarray(env.condition(jnp.asarray(heights, jnp.float32), motion))


def test_by_default_they_are_strict_reachability_and_collision(folder):
    assert SteeringConfig().conditions == STANDARD == ("strict_reachability", "collision")
    named, plain = (
        SteeringEnv(run_config(folder, ["collision", "strict_reachability"]).env),
        SteeringEnv(SteeringConfig()),
    )
    np.testing.assert_array_equal(named.points_in_root, plain.points_in_root)
    assert margins(named, [0.0, 0.5]) == pytest.approx(margins(plain, [0.0, 0.5]), abs=0.0)


def test_a_condition_of_ones_own_reads_its_own_points_beside_the_others(folder):
    config = run_config(folder, ["collision", "my_conditions:Level"])
    with pytest.raises(InputError, match=r"env\.conditions: .* --allow my_conditions:Level"):
        SteeringEnv(config.env)
    assert "my_conditions" not in sys.modules
    env = SteeringEnv(config.env, allow=["my_conditions:Level"])
    plain = SteeringEnv(SteeringConfig())
    # What is sampled anyway keeps its place; the two points follow.
    np.testing.assert_array_equal(env.points_in_root[:-2], plain.points_in_root)
    np.testing.assert_array_equal(env.points_in_root[-2:], [[0.5, 0.0], [0.7, 0.0]])
    assert margins(env, [0.0, 0.15, 0.3]) == pytest.approx([0.15, 0.05, -0.1], abs=0.16)
    assert margins(env, [0.15, 0.3])[1] == pytest.approx(-0.1, abs=1e-6)
    # Passed, it wins: the configuration's own is neither needed nor imported.
    assert SteeringEnv(config.env, plain.condition).foresight is None


def test_a_surrogate_becomes_the_foresight(folder):
    config = run_config(folder, [*STANDARD, {"surrogate": "surrogate.npz", "threshold": 0.5}])
    env = SteeringEnv(config.env)
    assert isinstance(env.foresight, SurrogateForesight)
    assert env.foresight.threshold == 0.5
    assert len(env.endings.points_read) < len(env.points_in_root)
    other = SurrogateForesight(surrogate(hazard=0.1))
    assert SteeringEnv(config.env, foresight=other).foresight is other


def test_a_foresight_of_ones_own_needs_no_points(folder):
    named = [*STANDARD, "my_conditions:Memory"]
    env = SteeringEnv(run_config(folder, named).env, allow=["my_conditions:Memory"])
    assert type(env.foresight).__name__ == "Memory"


def test_the_resolved_configuration_finds_its_surrogate_from_anywhere(folder, monkeypatch):
    config = run_config(folder, ["reachability", "collision", {"surrogate": "surrogate.npz"}])
    kept = config.env.model_copy(update={"conditions": pinned(config.env.conditions)})
    (folder / "elsewhere").mkdir()
    monkeypatch.chdir(folder / "elsewhere")
    text = to_yaml(config.model_copy(update={"env": kept}))
    (folder / "elsewhere" / "config.yaml").write_text(text)
    again = load_run_config("config.yaml").env
    assert again == kept
    assert SteeringEnv(again).foresight is not None
    with pytest.raises(InputError, match=r"env\.conditions: surrogate\.npz does not exist"):
        SteeringEnv(config.env)
    write_surrogate(folder / "surrogate.npz", surrogate(hazard=0.2))
    with pytest.raises(InputError, match=r"env\.conditions: .*surrogate\.npz has changed"):
        SteeringEnv(again)


@pytest.mark.parametrize(
    ("conditions", "said"),
    [
        (["colision"], r"env\.conditions .* no condition 'colision'; perhaps you meant collision;"),
        (["balance"], "there are reachability, strict_reachability, collision, surrogate, or"),
        ([], r"env\.conditions is \[\], but it should hold at least 1"),
        (["surrogate"], r"needs its file: \{surrogate: FILE\}"),
        ([{"surrogate": "a.npz"}], "judged by itself, too: give strict_reachability, collision"),
        (["collision", {"surrogate": "a"}, {"surrogate": "b"}], "two surrogates"),
        ([3], r"env\.conditions\.0\.name is 3"),
        (["collision", {"surrogate": "a", "threshold": 1.0}], r"threshold is 1\.0"),
        (["collision", {"surrogate": "a", "treshold": 0.5}], "treshold"),
        ("collision", r"env\.conditions is 'collision'"),
    ],
)
def test_names_that_mean_nothing_are_refused_when_they_are_read(folder, conditions, said):
    with pytest.raises(InputError, match=said) as refusal:
        run_config(folder, conditions)
    assert str(folder / "run.yaml") in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("conditions", "said"),
    [
        ([*STANDARD, {"surrogate": "gone.npz"}], r"env\.conditions: gone\.npz does not exist"),
        ([*STANDARD, {"surrogate": "run.yaml"}], r"env\.conditions: run\.yaml is not a readable"),
        (["my_conditions:Deaf"], "my_conditions:Deaf makes a condition without points_in_root"),
        (["my_conditions:One"], r"One answers 2 robots with .*one margin for each"),
        (["my_conditions:Odd"], r"points of shape \(1, 3\)"),
        (["my_conditions:Memory"], "no condition judges a configuration by itself"),
        (
            [*STANDARD, "my_conditions:Memory", {"surrogate": "surrogate.npz"}],
            "one condition with memory",
        ),
        (["my_conditions:OWN"], "cannot be loaded"),
        (["my_conditions:Raising"], r"raises ValueError: no talos \(my_conditions.py, line "),
    ],
)
def test_what_cannot_be_had_is_refused_when_it_is_made(folder, conditions, said):
    config = run_config(folder, conditions)
    with pytest.raises(InputError, match=said) as refusal:
        SteeringEnv(config.env, allow=[each for each in conditions if isinstance(each, str)])
    assert str(refusal.value).startswith("env.conditions: ")


def test_a_surrogate_of_another_observation_is_refused(folder):
    named = [*STANDARD, {"surrogate": "surrogate.npz"}]
    config = run_config(folder, named, observation="icra81")
    with pytest.raises(InputError, match=r"env\.conditions: surrogate\.npz .* observation = "):
        SteeringEnv(config.env)


def test_files_and_code_of_strangers_are_not_harmless():
    assert harmless(("reachability",))
    assert not harmless(("reachability", "os:system"))
    assert harmless(("reachability", "my:Own"), ["my:Own"])
    assert not harmless((*STANDARD, SurrogateSettings(surrogate="a.npz")))
