import json

import jax
import jax.numpy as jnp
import numpy as np
import onnx
import pytest

from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.export import build_onnx
from jaxleas.export.write import described
from jaxleas.guide import Trips, leas, load_policy, read_onnx_policy, roll_out
from jaxleas.terrain.atlas import make_atlas
from jaxleas.types import InputError
from tests.guide.walkers import random_policy, small_arena, starts_on_links

POLICY = random_policy(seed=4)


@pytest.fixture(scope="module")
def content():
    return build_onnx(POLICY, described(POLICY.config))


@pytest.fixture
def file(tmp_path, content):
    path = tmp_path / "policy.onnx"
    path.write_bytes(content)
    return path


def test_driven_from_the_host_it_walks_as_on_the_device(file):
    env = SteeringEnv(POLICY.config)
    arena, terrain = small_arena()
    start, waypoints = starts_on_links(env, arena, terrain, 16, seed=5)
    index, atlas = jnp.zeros(16, jnp.int32), make_atlas([terrain])
    here, there = (
        roll_out(env, leas(env, policy), Trips(atlas, index, start, waypoints), 40)
        for policy in (read_onnx_policy(file), POLICY)
    )
    np.testing.assert_array_equal(here.end, there.end)
    np.testing.assert_array_equal(here.reached, there.reached)
    for name in ("position", "velocity", "yaw", "margin"):
        np.testing.assert_allclose(getattr(here, name), getattr(there, name), atol=1e-4)
    assert not start.position.is_deleted()
    assert len(set(np.asarray(here.end).tolist())) > 2


def test_any_batch_shape_goes_in(file):
    policy = read_onnx_policy(file)
    observation = np.random.default_rng(0).normal(size=(2, 3, 144)).astype(np.float32)
    expected = jax.vmap(POLICY)(jnp.asarray(observation))
    np.testing.assert_allclose(policy(observation), expected, atol=1e-6)
    np.testing.assert_allclose(policy(observation[0, 0]), expected[0, 0], atol=1e-6)


def test_it_brings_the_task_it_was_trained_for(file):
    assert load_policy(file).config == POLICY.config


def rewritten(content, key, change):
    """The file with one metadata text changed; None leaves it out."""
    model = onnx.load_model_from_string(content)
    metadata = {each.key: each.value for each in model.metadata_props}
    value = change(json.loads(metadata.pop(key)))
    if value is not None:
        metadata[key] = json.dumps(value)
    del model.metadata_props[:]
    onnx.helper.set_model_props(model, metadata)
    return model.SerializeToString()


@pytest.mark.parametrize(
    ("key", "change", "says"),
    [
        ("observation", lambda value: None, "not a steering policy"),
        ("steering_config", lambda value: None, "not a steering policy"),
        ("format", lambda value: 99, "format 99"),
        ("observation", lambda value: {**value, "name": "lidar12"}, "another observation layout"),
        ("observation", lambda value: {**value, "name": "icra81"}, "another observation layout"),
        ("observation", lambda value: {**value, "rows": [0.0]}, "its rows is"),
        ("observation", lambda value: {**value, "columns": value["columns"][::-1]}, "columns"),
        ("observation", lambda value: {**value, "size": 12}, "size is 12"),
        ("observation", lambda value: {**value, "height_clip": [-2, 0]}, "height_clip"),
        ("observation", lambda value: 7, "metadata"),
        ("steering_config", lambda value: {**value, "robot": 3}, "steering_config"),
    ],
)
def test_another_layout_or_format_is_refused(tmp_path, content, key, change, says):
    path = tmp_path / "other.onnx"
    path.write_bytes(rewritten(content, key, change))
    with pytest.raises(InputError, match=says) as refusal:
        read_onnx_policy(path)
    assert "\n" not in str(refusal.value)


def test_a_network_of_another_size_is_refused(tmp_path):
    other = random_policy(observation="icra81")
    path = tmp_path / "other.onnx"
    path.write_bytes(build_onnx(other, described(POLICY.config)))
    with pytest.raises(InputError, match=r"takes observation \[batch, 144\]"):
        read_onnx_policy(path)


def test_a_foreign_onnx_file_is_refused(tmp_path):
    value = onnx.helper.make_tensor_value_info
    graph = onnx.helper.make_graph(
        [onnx.helper.make_node("Relu", ["x"], ["y"])],
        "foreign",
        [value("x", onnx.TensorProto.FLOAT, ["n", 3])],
        [value("y", onnx.TensorProto.FLOAT, ["n", 3])],
    )
    model = onnx.helper.make_model(graph, opset_imports=[onnx.helper.make_opsetid("", 17)])
    path = tmp_path / "foreign.onnx"
    path.write_bytes(model.SerializeToString())
    with pytest.raises(InputError, match="not a steering policy"):
        read_onnx_policy(path)


@pytest.mark.parametrize("damage", ["empty", "text", "truncated", "flipped"])
def test_a_damaged_file_is_refused(tmp_path, content, damage):
    path = tmp_path / "damaged.onnx"
    path.write_bytes(
        {
            "empty": b"",
            "text": b"this is not an ONNX file",
            "truncated": content[: len(content) // 2],
            "flipped": b"\xff" * 64 + content[64:],
        }[damage]
    )
    with pytest.raises(InputError, match="not a usable ONNX file") as refusal:
        read_onnx_policy(path)
    assert "\n" not in str(refusal.value)


def test_a_missing_file_and_a_folder_are_refused(tmp_path):
    with pytest.raises(InputError, match="does not exist"):
        read_onnx_policy(tmp_path / "none.onnx")
    with pytest.raises(InputError, match="folder"):
        read_onnx_policy(tmp_path)


def test_a_graph_that_fails_only_when_it_is_run_is_a_sentence(tmp_path, content):
    model = onnx.load_model_from_string(content)
    # Another number of rows than went in: shapes are not known before it runs.
    graph, command = model.graph, model.graph.output[0].name
    for node in graph.node:
        node.output[:] = ["first" if each == command else each for each in node.output]
    graph.node.append(onnx.helper.make_node("Concat", ["first", "first"], [command], axis=0))
    path = tmp_path / "twice.onnx"
    path.write_bytes(model.SerializeToString())
    with pytest.raises(InputError, match=r"answers 3 rows with \(6, 4\)"):
        read_onnx_policy(path)(np.zeros((3, 144), np.float32))
    graph.node[-1].attribute[0].i = 1  # five columns and four do not add
    graph.node[-1].output[0] = "wide"
    graph.node.append(onnx.helper.make_node("Add", ["first", "wide"], [command]))
    path.write_bytes(model.SerializeToString())
    with pytest.raises(InputError) as refusal:
        read_onnx_policy(path)(np.zeros((3, 144), np.float32))
    assert "\n" not in str(refusal.value)
