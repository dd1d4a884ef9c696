"""Surrogate files and label folders: exact there and back, refused when something does not fit."""

import json
import shutil
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas import cli
from jaxleas.contacts.planner_settings import settings_from
from jaxleas.envs.steering import SteeringConfig
from jaxleas.files import read_json, read_npz, write_json, write_npz
from jaxleas.guide.files import write_guide_paths
from jaxleas.labels import Here, Oracle, label_shards, make_shards
from jaxleas.robots import robot_digest
from jaxleas.surrogates import (
    Surrogate,
    read_labels,
    read_surrogate,
    require_fit,
    write_surrogate,
)
from jaxleas.surrogates.features import MOTION_FEATURES
from jaxleas.surrogates.network import initial_weights
from jaxleas.terrain.scene import Scene
from jaxleas.terrain.scene_file import write_scene
from jaxleas.types import InputError

from .walkers import KEEP_EVERY, identity, wander


@pytest.fixture
def surrogate():
    size = len(identity().near) + MOTION_FEATURES
    weights = initial_weights(jax.random.key(0), size, 8, 6)
    return Surrogate(weights, jnp.float32(1.5), jnp.float32(-0.5), identity(), {"guides": 3})


def test_a_surrogate_comes_back_exactly(surrogate, tmp_path):
    write_surrogate(tmp_path / "s.npz", surrogate)
    back = read_surrogate(tmp_path / "s.npz")
    assert back.identity == surrogate.identity
    assert back.report == surrogate.report
    for mine, its in zip(jax.tree.leaves(surrogate), jax.tree.leaves(back), strict=True):
        np.testing.assert_array_equal(mine, its)


def break_metadata(change):
    def change_file(arrays):
        metadata = json.loads(str(arrays["metadata"]))
        change(metadata)
        arrays["metadata"] = np.array(json.dumps(metadata))

    return change_file


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (break_metadata(lambda m: m.update(format=9)), "format 9; this version reads 2"),
        (break_metadata(lambda m: m.pop("identity")), "is not a surrogate's"),
        (break_metadata(lambda m: m["identity"].update(colour=1)), "identity.colour"),
        (break_metadata(lambda m: m["identity"]["parameters"].clear()), "keep_every"),
        (lambda a: a.update(encoder=a["encoder"][1:]), "encoder of shape"),
        (lambda a: a.update(head=a["head"] * np.nan), "head holds values that are not finite"),
        (lambda a: a.pop("gates"), "gates"),
    ],
)
def test_a_broken_file_is_refused_with_a_sentence(surrogate, tmp_path, change, sentence):
    path = tmp_path / "s.npz"
    write_surrogate(path, surrogate)
    arrays = read_npz(path, ())
    change(arrays)
    write_npz(path, **arrays)
    with pytest.raises(InputError, match=sentence):
        read_surrogate(path)


def test_a_surrogate_of_something_else_is_refused(surrogate):
    config, parameters = SteeringConfig(), {"keep_every": KEEP_EVERY, "seed": 0}
    require_fit(surrogate, config, "sampling", parameters)
    with pytest.raises(InputError, match="planner = sampling, not mip"):
        require_fit(surrogate, config, "mip")
    with pytest.raises(InputError, match="with seed = 0, not with seed = 7"):
        require_fit(surrogate, config, "sampling", parameters | {"seed": 7})
    with pytest.raises(InputError, match="observation = thesis144, not icra81"):
        require_fit(surrogate, SteeringConfig(observation="icra81"))


@pytest.fixture(scope="module")
def labelled(tmp_path_factory):
    """Eight guide paths over two flat scenes, judged by the real planner with few samples."""
    folder = tmp_path_factory.mktemp("labels")
    generator = np.random.default_rng(0)
    for number in range(2):
        floor = np.array([[-3, -3, 0], [3, -3, 0], [3, 3, 0], [-3 - number, 3, 0]], float)
        write_scene(folder / f"scene_{number}.json", Scene({"floor": floor}))
        paths = [wander(generator, 4) for _ in range(4)]
        write_guide_paths(folder / f"guides_{number}.npz", paths, ["stopped"] * 4)
        shards = make_shards(
            [folder / f"guides_{number}.npz"],
            folder / f"scene_{number}.json",
            Oracle("sampling", settings_from("sampling", samples=500), robot="talos"),
            folder / "verdicts",
        )
        label_shards(shards, Here(), lambda count: None)
    return folder


def test_label_folders_are_read_with_paths_and_terrain(labelled):
    labels = read_labels([labelled / "verdicts"], [], 0.1)
    assert labels.planner == "sampling"
    assert labels.parameters["samples"] == 500
    assert len(labels.paths) == 8
    assert len(labels.atlas) == 2
    np.testing.assert_array_equal(np.sort(labels.paths.map_index), [0] * 4 + [1] * 4)
    verdicts = read_json(labelled / "verdicts" / "guides_0" / "verdicts_000000.json")["verdicts"]
    reached = [each["last_index"] // KEEP_EVERY + 1 for each in verdicts]
    expected = [-1 if each == 4 else each for each in reached]
    np.testing.assert_array_equal(labels.paths.failed_at[:4], expected)


def test_a_scene_that_changed_or_is_missing_is_refused(labelled, tmp_path):
    shutil.copytree(labelled / "verdicts", tmp_path / "v")
    with pytest.raises(InputError, match=r"scene_0\.json, which was judged, is nowhere"):
        read_labels([tmp_path / "v"], [], 0.1)
    scene = read_json(labelled / "scene_0.json")
    scene["surfaces"]["floor"][0][0] -= 0.5
    write_json(tmp_path / "scene_0.json", scene)
    with pytest.raises(InputError, match="its content has changed"):
        read_labels([tmp_path / "v"], [], 0.1)
    assert len(read_labels([tmp_path / "v"], [labelled], 0.1).paths) == 8


def test_verdicts_of_two_planners_do_not_mix(labelled, tmp_path):
    file = labelled / "verdicts" / "guides_0" / "verdicts_000000.json"
    content = read_json(file)
    content["provenance"]["parameters"]["samples"] = 501
    write_json(tmp_path / "verdicts_other.json", content)
    with pytest.raises(InputError, match="another planner or other parameters"):
        read_labels([labelled / "verdicts", tmp_path], [labelled], 0.1)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["nowhere"], "there are no verdicts under nowhere"),
        (["LABELS", "--planner", "mip"], "verdicts of the sampling planner, not of mip"),
        (["LABELS"], "come from 2 terrains"),
        (["LABELS", "--epochs", "0"], "--epochs 0"),
    ],
)
def test_fit_refuses_with_one_sentence(labelled, tmp_path, arguments, sentence):
    given = [str(labelled / "verdicts") if each == "LABELS" else each for each in arguments]
    with pytest.raises(InputError, match=sentence):
        cli.run(["fit", *given, "--out", str(tmp_path / "s.npz")])
    assert not (tmp_path / "s.npz").exists()


def changed(labelled, tmp_path, change):
    """A copy of the labels, one file of them changed."""
    shutil.copytree(labelled / "verdicts", tmp_path / "verdicts")
    for file in sorted((tmp_path / "verdicts").rglob("verdicts_*.json")):
        content = read_json(file)
        change(content)
        write_json(file, content)
        return tmp_path / "verdicts"


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda c: c["provenance"].update(robot="atlas"), "or on another robot, than"),
        (lambda c: c.update(version=1), "is of version 1; this jaxleas reads version 2"),
        (lambda c: c["verdicts"][0].pop("last_index"), "is not a verdict file"),
    ],
)
def test_labels_of_another_robot_or_version_are_refused(labelled, tmp_path, change, sentence):
    with pytest.raises(InputError, match=sentence):
        read_labels([changed(labelled, tmp_path, change)], [labelled], 0.1)


def test_old_labels_that_name_no_robot_are_of_talos_and_go_with_new_ones(labelled, tmp_path):
    folder = changed(labelled, tmp_path, lambda content: content["provenance"].pop("robot"))
    labels = read_labels([folder], [labelled], 0.1)
    assert labels.robot == "talos"
    assert labels.robot_digest == robot_digest("talos")
    assert len(labels.paths) == 8


def fit_to(labelled, tmp_path, *options, **robot):
    """The command, on labels whose robot is changed."""
    shutil.copytree(labelled / "verdicts", tmp_path / "verdicts")
    for file in (tmp_path / "verdicts").rglob("verdicts_*.json"):
        content = read_json(file)
        content["provenance"]["robot"] |= robot
        write_json(file, content)
    verdicts, where = str(tmp_path / "verdicts"), str(labelled)
    cli.run(["fit", verdicts, "--where", where, "--out", str(tmp_path / "s.npz"), *options])


def test_labels_are_of_the_policys_own_robot(labelled, tmp_path):
    policy = Path(__file__).parents[2] / "pretrained" / "leas_p1.npz"
    with pytest.raises(InputError, match="verdicts on atlas, but the policy is for talos"):
        fit_to(labelled, tmp_path, "--policy", str(policy), name="atlas")
    assert not (tmp_path / "s.npz").exists()


def test_without_a_policy_the_labels_name_the_robot(labelled, tmp_path):
    with pytest.raises(InputError, match="verdicts on atlas: there is no robot 'atlas'"):
        fit_to(labelled, tmp_path, name="atlas")
    shutil.rmtree(tmp_path / "verdicts")
    with pytest.raises(InputError, match="the labels come from 2 terrains"):
        fit_to(labelled, tmp_path, name="g1", sha256=robot_digest("g1"))


def test_labels_are_of_the_robot_as_it_is_now(labelled, tmp_path):
    with pytest.raises(InputError, match="verdicts on talos as it was before its file changed"):
        fit_to(labelled, tmp_path, sha256="0" * 64)


def test_labels_of_the_policys_robot_go_on_to_the_fit(labelled, tmp_path):
    with pytest.raises(InputError, match="the labels come from 2 terrains"):
        fit_to(labelled, tmp_path)
