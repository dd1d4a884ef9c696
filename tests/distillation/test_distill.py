"""A distillation, very small: it goes through all stages, and goes on where it was stopped."""

import shutil

import jax
import numpy as np
import pytest
import yaml

from jaxleas import cli
from jaxleas.conditions.named import STANDARD
from jaxleas.configuration.loading import load_config, to_yaml
from jaxleas.distillation.config import DistillationConfig
from jaxleas.distillation.folder import DistillationFolder
from jaxleas.distillation.opening import open_folder
from jaxleas.distillation.practice import practice_config, read_run
from jaxleas.distillation.workplace import Workplace
from jaxleas.envs.steering import Steering
from jaxleas.files import read_json
from jaxleas.runs.folder import RunFolder
from jaxleas.surrogates import read_surrogate
from jaxleas.terrain import write_height_map
from jaxleas.terrain.generator import generate_arena
from jaxleas.training.loop import train
from jaxleas.training.networks.mlp import layers_of
from jaxleas.training.policy import read_policy
from jaxleas.training.worlds import training_world
from jaxleas.types import InputError

from ..guide.walkers import flat_map
from ..training.runs import ROOT, tiny

SHIPPED = sorted((ROOT / "configs").glob("leas_p2_*.yaml"))
# Every planner, and both modes: the others of them differ in numbers alone.
RUN = [ROOT / f"configs/leas_p2_{name}.yaml" for name in ("mip", "sl1m", "sampling_faithful")]
YAML = """\
planner: sampling
parameters: {samples: 2000}
rounds: 1
collect: {guides: 480, steps: 60, disturbances: [0.3, 0.9]}
fit: {epochs: 1, code: 8, hidden: 4, held_out: 0.5}
practice: {steps: 2048}
judge: {suites: [hole], starts: 4}
"""


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_shipped_configurations_load_and_mean_the_same_resolved(path, tmp_path):
    config = load_config(DistillationConfig, path)
    (tmp_path / "resolved.yaml").write_text(to_yaml(config))
    assert load_config(DistillationConfig, tmp_path / "resolved.yaml") == config


@pytest.fixture(scope="module")
def start(tmp_path_factory):
    """A run of a few updates to begin with."""
    base = tiny()
    terrain = base.terrain.model_copy(update={"arenas": 6})
    config = base.model_copy(update={"terrain": terrain})
    path = tmp_path_factory.mktemp("start") / "run"
    # Brax's own code relies on rank promotion.
    with (
        jax.numpy_rank_promotion("allow"),
        RunFolder.create(path, to_yaml(config), ["train.py"]) as run,
    ):
        train(config, run)
    return path


@pytest.mark.slow
def test_what_was_learned_is_read_and_carried_over(start):
    config, learned = read_run(start)
    policy = read_policy(start / "policy.npz")
    shapes = [layer["kernel"].shape for _, layer in sorted(learned.params.policy["params"].items())]
    assert shapes == [kernel.shape for kernel, _ in layers_of(policy.params)]
    practice = practice_config(DistillationConfig(), config)
    assert practice.network == config.network
    assert practice.env.reward.failure == config.env.reward.final_failure
    assert practice.ppo.steps == DistillationConfig().practice.steps


def test_labels_and_practice_may_walk_on_another_terrain(start, tmp_path):
    own, _ = read_run(start)
    kept = Workplace(DistillationConfig(), DistillationFolder(tmp_path), start, 1)
    assert kept.run_config.terrain == own.terrain
    detours = {"arenas": 6, "shares": {"detour": 1.0}, "generator": {"detour_probability": 1.0}}
    config = DistillationConfig.model_validate({"practice": {"terrain": detours}})
    place = Workplace(config, DistillationFolder(tmp_path), start, 1)
    practice = practice_config(config, place.run_config)
    assert practice.terrain == config.practice.terrain != own.terrain
    terrain = practice.terrain
    arenas = [generate_arena(terrain.generator, terrain.first_seed + k) for k in range(6)]
    assert {link.kind for arena in arenas for link in arena.links} >= {"detour"}
    for scene, arena in zip(place.ground.scenes, arenas, strict=True):
        assert scene.surfaces.keys() == arena.scene.surfaces.keys()
        np.testing.assert_array_equal(
            np.concatenate(list(scene.surfaces.values())),
            np.concatenate(list(arena.scene.surfaces.values())),
        )
    world = training_world(practice, Steering(practice.env, practice.terrain))
    assert place.ground.world.map_index.tolist() == world.map_index.tolist()


def test_practice_may_ask_for_another_speed_and_reward(start):
    config, _ = read_run(start)
    changes = {"desired_speed": 0.12, "reward": {"direction": 12.0, "failure": 20.0}}
    practice = practice_config(
        DistillationConfig.model_validate({"practice": changes}), config, steps=4096
    )
    assert practice.env.desired_speed == 0.12
    assert practice.ppo.steps == 4096
    # Failing is as dear at the end as at the beginning.
    assert practice.env.reward.failure == practice.env.reward.final_failure == 20.0
    failing = {"failure": 20.0, "final_failure": 20.0}
    kept = config.env.reward.model_dump() | {"direction": 12.0, **failing}
    assert practice.env.reward.model_dump() == kept


@pytest.mark.slow
@pytest.mark.usefixtures("brax_ranks")
@pytest.mark.parametrize("path", RUN, ids=lambda path: path.stem)
def test_shipped_configurations_run_when_made_small(path, start, tmp_path):
    """Every planner goes through a round: labels, fit, practice (before it, too) and judgement."""
    config = load_config(DistillationConfig, path)
    small = {
        "rounds": 1,
        "collect": {"guides": 240, "steps": 60, "disturbances": [0.9]},
        "fit": {"epochs": 1, "code": 8, "hidden": 4, "held_out": 0.35},
        "judge": {"suites": ["hole"], "starts": 2},
    }
    if config.planner != "sampling":  # these two fail only where the root hardly can be followed
        small["collect"] |= {"disturbances": [3.0], "guides": 700}
    before = min(640, config.practice.steps_before)
    practice = config.practice.model_dump() | {"steps": 640, "steps_before": before}
    parameters = config.parameters | ({"samples": 500} if config.planner == "sampling" else {})
    shrunk = DistillationConfig.model_validate(
        config.model_dump() | small | {"practice": practice, "parameters": parameters}
    )
    (tmp_path / "small.yaml").write_text(to_yaml(shrunk))
    out = DistillationFolder(tmp_path / "out")
    command = ["distill", str(tmp_path / "small.yaml"), "--out", str(out.path)]
    cli.run([*command, "--start", str(start), "--processes", "1"])
    observed = config.practice.observation or "thesis144"
    assert read_policy(out.policy).config.observation == observed
    if config.mode == "surrogate":
        identity = read_surrogate(out.surrogate).identity
        assert (identity.planner, identity.observation) == (config.planner, observed)
    assert [each["round"] for each in read_json(out.table)["rounds"]] == [0, 1]


@pytest.mark.slow
@pytest.mark.usefixtures("brax_ranks")
def test_it_goes_through_all_stages_and_goes_on_where_it_was_stopped(start, tmp_path, capsys):
    (tmp_path / "c.yaml").write_text(YAML)
    out = tmp_path / "out"
    command = ["distill", str(tmp_path / "c.yaml"), "--out", str(out), "--start", str(start)]
    command += ["--processes", "1"]
    cli.run(command)
    folder = DistillationFolder(out)
    rounds = read_json(folder.table)["rounds"]
    assert [each["round"] for each in rounds] == [0, 1]
    assert rounds[1]["labels"] == 480
    assert read_surrogate(folder.surrogate).identity.parameters["samples"] == 2000
    before = read_policy(start / "policy.npz")
    after = read_policy(folder.policy)
    first = [layers_of(policy.params)[0][0] for policy in (before, after)]
    assert not np.array_equal(*first)

    # All is done: nothing is done again, and the time that it took is not forgotten.
    kept = folder.table.read_bytes()
    cli.run(command)
    assert folder.table.read_bytes() == kept

    # As if killed after the labels of round 1, with one verdict file still missing.
    first = folder.round(1)
    kept = first.surrogate.read_bytes()
    for file in (first.surrogate, first.labelled, first.judged, folder.table):
        file.unlink()
    verdicts = sorted(first.labels.rglob("verdicts_*.json"))
    untouched = verdicts[0].stat().st_mtime_ns
    verdicts[-1].unlink()
    capsys.readouterr()
    cli.run(command)
    assert verdicts[-1].is_file()
    assert verdicts[0].stat().st_mtime_ns == untouched
    assert read_json(first.labelled)["judged"] < 480
    assert first.surrogate.read_bytes() == kept
    assert "mean" in capsys.readouterr().out


def test_a_folder_is_begun_once_and_gone_on_with_as_it_was(start, tmp_path):
    folder = DistillationFolder(tmp_path / "out")
    config = DistillationConfig()
    assert open_folder(folder, config, start) == config
    assert open_folder(folder, config, start) == config
    with pytest.raises(InputError, match="another configuration"):
        open_folder(folder, DistillationConfig(rounds=9), start)
    with pytest.raises(InputError, match="was begun with"):
        open_folder(folder, config, None)


@pytest.mark.parametrize(
    ("yaml", "sentence"),
    [
        ("planner: sampling\nparameters: {sample: 3}\n", "sampling has no setting sample"),
        ("planner: sampling\nparameters: {samples: 0}\n", "--samples 0"),
        ("planner: magic\n", "planner"),
        ("practice: {threshold: 1.0}\n", "threshold"),
        ("judge: {suites: [transition]}\n", "judge.suites .* no suite is called 'transition'"),
        ("judge: {suites: [hole, thesis]}\n", "hole at 0 deg is in hole and in thesis"),
        ("judge: {suites: [hole, hole]}\n", "hole at 0 deg is in hole and in hole"),
        ("collect: {parameters: {max_try: 1}}\n", "sampling has no setting max_try"),
        ("mode: faithful\ncollect: {parameters: {max_tries: 1}}\n", "nothing is labelled"),
        ("practice: {reward: {distance: 1.0}}\n", "distance"),
        ("practice: {observation: thesis143}\n", "observation"),
        ("planner: sl1m\nparameters: {weights: learned}\n", "--weights learned"),
    ],
)
def test_what_cannot_be_is_refused_and_nothing_is_left(tmp_path, yaml, sentence):
    (tmp_path / "c.yaml").write_text(yaml)
    with pytest.raises(InputError, match=sentence):
        cli.run(["distill", str(tmp_path / "c.yaml"), "--out", str(tmp_path / "out")])
    assert not (tmp_path / "out").exists()


def test_devices_that_there_are_not_are_refused(start, tmp_path):
    (tmp_path / "c.yaml").write_text("planner: sampling\n")
    command = ["distill", str(tmp_path / "c.yaml"), "--out", str(tmp_path / "o")]
    command += ["--start", str(start), "--devices"]
    for count, sentence in (
        ("0", "--devices is 0; give 1 or more"),
        ("99", "--devices 99: JAX finds"),
    ):
        with pytest.raises(InputError, match=sentence):
            cli.run([*command, count])
    assert not (tmp_path / "o").exists()


def test_a_folder_of_something_else_is_refused(tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.tex").write_text("precious")
    (tmp_path / "c.yaml").write_text("planner: sampling\n")
    with pytest.raises(InputError, match="is no distillation"):
        cli.run(["distill", str(tmp_path / "c.yaml"), "--out", str(tmp_path / "mine")])
    with pytest.raises(InputError, match="does not exist"):
        cli.run(
            ["distill", str(tmp_path / "c.yaml"), "--out", str(tmp_path / "o"), "--start", "no"]
        )
    assert not (tmp_path / "o").exists()


def test_a_run_on_files_and_under_own_code_is_distilled_on_arenas_under_the_standard_conditions(
    start, tmp_path, caplog
):
    run = tmp_path / "run"
    shutil.copytree(start, run)
    write_height_map(tmp_path / "yard.npz", flat_map(resolution=0.04))
    stated = yaml.safe_load((run / "config.yaml").read_text())
    stated["terrain"] |= {"files": [str(tmp_path / "yard.npz")], "files_share": 0.5}
    stated["env"]["conditions"] = ["collision", "nowhere:Own"]
    (run / "config.yaml").write_text(yaml.safe_dump(stated))
    with caplog.at_level("WARNING"):
        place = Workplace(DistillationConfig(), DistillationFolder(tmp_path), str(run), 1)
    assert "give way to R* and C" in caplog.text
    assert place.env.config.conditions == STANDARD
    # Planners are asked about surfaces, which files do not have; practice walks on files, too.
    assert place.ground.world.own is None
    assert len(place.ground.scenes) == len(place.ground.world.atlas) == 6
    assert practice_config(place.config, place.run_config).terrain.files_share == 0.5
