import hashlib
import json
from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import onnx
import pytest

from jaxleas.envs.steering import Steering
from jaxleas.envs.steering.layout import layout_named
from jaxleas.export import (
    ExportError,
    build_onnx,
    export_policy,
    largest_difference,
    read_stablehlo,
    record_observations,
    to_stablehlo,
    write,
)
from jaxleas.export.parity import TOLERANCE
from jaxleas.export.recording import LEAST_OBSERVATIONS, edge_cases
from jaxleas.export.write import described
from jaxleas.guide import read_onnx_policy
from jaxleas.guide.onnx_policy import onnx_policy_from_bytes
from jaxleas.training.networks.mlp import layers_of, params_of
from jaxleas.types import InputError, JaxleasError
from tests.envs.worlds import bumpy, height_map, world_of
from tests.guide.walkers import random_policy

ARTIFACTS = ("policy.onnx", "policy.stablehlo", "export.json")


def observations_of(policy, count=LEAST_OBSERVATIONS, seed=0):
    """Anything an observation may hold, and what it never should."""
    rng = np.random.default_rng(seed)
    mean, deviation = np.asarray(policy.mean), np.asarray(policy.deviation)
    drawn = rng.choice([0.3, 1.0], size=(count, 1)) * rng.normal(size=(count, len(mean)))
    drawn[rng.uniform(size=drawn.shape) < 0.01] *= 1e3
    drawn = mean + deviation * drawn
    return np.concatenate([drawn, edge_cases(policy)]).astype(np.float32)


@pytest.mark.parametrize("activation", ["relu", "tanh", "swish", "elu"])
@pytest.mark.parametrize("observation", ["thesis144", "icra81"])
def test_onnx_and_stablehlo_compute_what_the_policy_computes(activation, observation):
    policy = random_policy(1, activation, (32, 16, 8), observation=observation)
    observations = observations_of(policy)
    onnx_file = build_onnx(policy, described(policy.config))
    differences = largest_difference(policy, onnx_file, to_stablehlo(policy), observations)
    assert set(differences) == {"onnxruntime", "stablehlo"}
    assert all(gap < 1e-6 for gap in differences.values())
    assert np.ptp(np.asarray(jax.jit(policy.__call__)(observations)), axis=0).min() > 1e-3


def test_commands_obey_the_limits_whatever_is_seen():
    policy = random_policy(2)
    command = onnx_policy_from_bytes(build_onnx(policy, described(policy.config)), "it")(
        1e3 * observations_of(policy, 1000)
    )
    limits = policy.config.limits
    length = np.linalg.norm(command[:, :3], axis=1)
    assert length.max() <= limits.max_acceleration * (1 + 1e-6)
    assert length.max() > 0.99 * limits.max_acceleration
    assert np.abs(command[:, 3]).max() <= limits.max_turn_rate * (1 + 1e-6)


def test_a_policy_without_hidden_layers_is_exported_too():
    policy = random_policy(3, hidden=())
    differences = largest_difference(
        policy,
        build_onnx(policy, described(policy.config)),
        to_stablehlo(policy),
        observations_of(policy),
    )
    assert max(differences.values()) < TOLERANCE


def test_an_activation_without_counterpart_is_refused():
    policy = random_policy(activation="gelu")
    with pytest.raises(InputError, match="'gelu' cannot be exported"):
        build_onnx(policy, {})


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    policy = random_policy(5)
    folder = tmp_path_factory.mktemp("run") / "artifacts"
    table = [{"name": "rubble", "reached": 1.0}]
    record = export_policy(policy, folder, observations_of(policy), "seed: 3\n", table)
    return policy, folder, record


def test_the_record_vouches_for_the_files(exported):
    _, folder, record = exported
    assert json.loads((folder / "export.json").read_text()) == record
    assert sorted(each.name for each in folder.iterdir()) == sorted(ARTIFACTS)
    for name in ("policy.onnx", "policy.stablehlo"):
        content = (folder / name).read_bytes()
        assert record[name]["bytes"] == len(content)
        assert record[name]["sha256"] == hashlib.sha256(content).hexdigest()
    assert record["parity"]["observations"] >= LEAST_OBSERVATIONS
    assert record["parity"]["onnxruntime"] <= TOLERANCE


def test_the_onnx_file_says_all_a_driver_needs(exported):
    policy, folder, record = exported
    model = onnx.load_model(folder / "policy.onnx")
    onnx.checker.check_model(model, full_check=True)
    told = {each.key: json.loads(each.value) for each in model.metadata_props}
    layout = layout_named("thesis144")
    assert told["observation"]["rows"] == list(layout.rows)
    assert told["observation"]["columns"] == list(layout.columns)
    assert told["observation"]["height_clip"] == [-1.4, -0.2]
    assert told["command"]["max_acceleration"] == policy.config.limits.max_acceleration
    assert told["command"]["time_step"] == policy.config.limits.time_step
    assert told["robot"] == "talos"
    assert told["training_config"] == "seed: 3\n"
    assert told["success"] == [{"name": "rubble", "reached": 1.0}]
    assert told["parity"] == record["parity"]
    assert "jaxleas" in told
    assert model.graph.input[0].type.tensor_type.shape.dim[0].dim_param == "batch"


def test_what_was_written_is_read_back_as_the_same_policy(exported):
    policy, folder, _ = exported
    observation = observations_of(policy, 37, seed=9)
    expected = np.asarray(jax.jit(policy.__call__)(observation))
    onnx_policy, stablehlo = (
        read_onnx_policy(folder / "policy.onnx"),
        read_stablehlo(folder / "policy.stablehlo"),
    )
    assert onnx_policy.config == policy.config
    np.testing.assert_allclose(onnx_policy(observation), expected, atol=1e-6)
    np.testing.assert_allclose(stablehlo(jnp.asarray(observation)), expected, atol=1e-6)
    np.testing.assert_allclose(stablehlo(jnp.asarray(observation[:1])), expected[:1], atol=1e-6)


@pytest.mark.parametrize("artifact", ["build_onnx", "to_stablehlo"])
def test_a_sabotaged_artifact_is_refused_and_nothing_is_written(tmp_path, monkeypatch, artifact):
    policy = random_policy(6)
    honest = getattr(write, artifact)
    *inner, (kernel, bias) = layers_of(policy.params)
    bias = bias.at[0].add(2e-3)  # about 1e-4 m/s^2
    perturbed = replace(policy, params=params_of([*inner, (kernel, bias)]))
    monkeypatch.setattr(write, artifact, lambda policy, *rest: honest(perturbed, *rest))
    with pytest.raises(ExportError, match="nothing was written"):
        export_policy(policy, tmp_path / "out", observations_of(policy))
    assert not (tmp_path / "out").exists()


def test_a_policy_of_nan_is_refused(tmp_path):
    policy = random_policy(6)
    with jax.debug_nans(False):
        broken = replace(policy, mean=policy.mean.at[0].set(jnp.nan))
    with jax.debug_nans(False), pytest.raises(ExportError, match="differ"):
        export_policy(broken, tmp_path / "out", observations_of(policy))
    assert not (tmp_path / "out").exists()


def test_too_few_observations_are_refused(tmp_path):
    policy = random_policy(6)
    with pytest.raises(ExportError, match="at least 10000"):
        export_policy(policy, tmp_path / "out", observations_of(policy)[:9999])
    assert not (tmp_path / "out").exists()


def test_an_export_error_is_one_the_command_line_prints():
    assert issubclass(ExportError, JaxleasError)


def test_an_unwritable_folder_is_refused(tmp_path):
    policy = random_policy(6)
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(InputError, match="cannot write"):
        export_policy(policy, tmp_path / "file" / "out", observations_of(policy))


@pytest.mark.parametrize("content", [None, b"", b"not StableHLO", b"\x00" * 4096])
def test_what_is_no_stablehlo_is_refused(tmp_path, content):
    file = tmp_path / "policy.stablehlo"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(InputError, match=r"policy\.stablehlo"):
        read_stablehlo(file)


@pytest.mark.slow
def test_recorded_observations_are_what_a_walking_robot_sees():
    policy = random_policy(4)
    task = Steering(policy.config)
    world = world_of(height_map(bumpy, half_size=3.0))
    key = jax.random.key(0)
    recorded = record_observations(policy, task, world, key, robots=64, steps=100)
    walked = recorded[: -len(edge_cases(policy))]
    assert len(walked) >= LEAST_OBSERVATIONS
    assert np.isfinite(recorded).all()
    speed = np.linalg.norm(walked[:, :3], axis=1)
    assert speed.max() <= policy.config.limits.max_speed + 1e-6
    assert speed.max() > 0.05
    assert np.abs(walked[:, 3]).max() <= np.pi + 1e-6
    assert walked[:, 4:].min() >= -1.4
    assert walked[:, 4:].max() <= -0.2
    assert np.unique(walked.round(4), axis=0).shape[0] >= LEAST_OBSERVATIONS  # distinct ones
    again = record_observations(policy, task, world, key, robots=64, steps=100)
    np.testing.assert_array_equal(recorded, again)
