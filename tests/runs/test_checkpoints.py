import json
import logging
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import optax
import pytest
from flax import struct

from jaxleas.runs.checkpoints import Checkpoints
from jaxleas.types.errors import InputError


@struct.dataclass
class State:
    params: dict[str, jax.Array]
    optimiser: optax.OptState
    key: jax.Array
    keys: jax.Array
    done: jax.Array
    small: jax.Array
    counts: np.ndarray
    updates: int
    rate: float
    strange: np.ndarray


def make_state(seed: int) -> State:
    key = jax.random.key(seed)
    params = {"w": jax.random.normal(key, (5, 3)), "b": jnp.array([-0.0, 1e-40, 3e38])}
    optimiser = optax.adam(1e-3)
    updates, moments = optimiser.update(params, optimiser.init(params))
    return State(
        params=updates,
        optimiser=moments,
        key=key,
        keys=jax.random.split(jax.random.key(seed, impl="rbg"), 4),
        done=jnp.array([True, False]),
        small=jnp.arange(3, dtype=jnp.bfloat16),
        counts=np.array([2**40 + seed]),
        updates=seed,
        rate=0.1 + 1e-17 * seed,
        strange=np.array([np.nan, -np.inf, -0.0]),
    )


def bits(state) -> list[tuple]:
    """Return type and exact bits of every leaf."""

    def of(leaf) -> tuple:
        if isinstance(leaf, jax.Array) and jnp.issubdtype(leaf.dtype, jax.dtypes.prng_key):
            return str(leaf.dtype), np.asarray(jax.random.key_data(leaf)).tobytes()
        if isinstance(leaf, jax.Array | np.ndarray):
            return type(leaf), leaf.dtype, leaf.shape, np.asarray(leaf).tobytes()
        return type(leaf), leaf

    return [of(leaf) for leaf in jax.tree.leaves(state)]


@pytest.fixture
def checkpoints(tmp_path: Path) -> Checkpoints:
    return Checkpoints(tmp_path / "checkpoints", keep_last=2)


def test_everything_comes_back_to_the_bit(checkpoints: Checkpoints) -> None:
    state, note = make_state(7), {"best": [0.1, None], "held out": 1e-300}
    checkpoints.save(12, state, note)
    for like in (make_state(1), jax.tree.map(lambda leaf: leaf, make_state(2))):
        step, restored, read_note = checkpoints.latest(like)
        assert (step, read_note) == (12, note)
        assert jax.tree.structure(restored) == jax.tree.structure(state)
        assert bits(restored) == bits(state)
    drawn = [jax.random.normal(each.keys[1], (2,)).tolist() for each in (state, restored)]
    assert drawn[0] == drawn[1]


def test_shapes_alone_are_enough_to_read_by(checkpoints: Checkpoints) -> None:
    state = make_state(3).replace(counts=jnp.arange(2), updates=jnp.int32(1), rate=jnp.zeros(()))
    state = state.replace(strange=jnp.ones(2))
    checkpoints.save(0, state, {})
    assert bits(checkpoints.latest(jax.eval_shape(lambda: state))[1]) == bits(state)


def test_a_part_can_be_read_alone(checkpoints: Checkpoints) -> None:
    state = make_state(3)
    checkpoints.save(0, state, {})
    part = checkpoints.latest({"params": make_state(1).params}, partial=True)[1]
    assert bits(part["params"]) == bits(state.params)
    with pytest.raises(InputError, match="also holds state/"):
        checkpoints.latest({"params": state.params})


def test_keeps_the_last_and_the_best(checkpoints: Checkpoints) -> None:
    scores = [0.1, 0.9, None, 0.9, float("nan"), 0.3]
    for step, score in enumerate(scores):
        checkpoints.save(step, {"x": jnp.array(step)}, {}, score)
    assert checkpoints.steps() == [3, 4, 5]
    assert checkpoints.best({"x": jnp.array(0)})[0] == 3
    assert checkpoints.latest({"x": jnp.array(0)})[0] == 5


def test_without_a_score_there_is_no_best(checkpoints: Checkpoints) -> None:
    checkpoints.save(0, {}, {})
    with pytest.raises(InputError, match=r"no checkpoint .* has a score"):
        checkpoints.best({})


def test_going_on_from_an_earlier_step_forgets_the_abandoned_future(checkpoints) -> None:
    for step in (10, 20, 30):
        checkpoints.save(step, {"x": jnp.array(step)}, {}, step)
    checkpoints.save(20, {"x": jnp.array(-20)}, {}, 1.0)
    assert checkpoints.steps() == [20]
    assert checkpoints.best({"x": jnp.array(0)})[1]["x"] == -20


@pytest.mark.parametrize(
    ("like", "expected"),
    [
        ({"w": jnp.zeros((2, 4))}, "state/w is float32.2,3. there and float32.2,4. here"),
        ({"w": jnp.zeros((2, 3), int)}, "float32.2,3. there and int32.2,3. here"),
        ({"v": jnp.zeros((2, 3))}, "also holds state/w"),
        ({"w": jnp.zeros((2, 3)), "v": 1}, "state/v is missing there and int here"),
    ],
)
def test_another_state_is_refused(checkpoints: Checkpoints, like, expected: str) -> None:
    checkpoints.save(0, {"w": jnp.zeros((2, 3))}, {})
    with pytest.raises(InputError, match=expected):
        checkpoints.latest(like)


def test_an_empty_folder_is_refused(checkpoints: Checkpoints) -> None:
    for read in (checkpoints.latest, checkpoints.best):
        with pytest.raises(InputError, match=r"no usable checkpoint .* there is none"):
            read({})


def test_a_damaged_file_is_never_used_and_what_is_lost_is_said(checkpoints, caplog) -> None:
    """Truncated anywhere or with any bit flipped, it is refused or it is still right."""
    old, new = make_state(1), make_state(2)
    checkpoints.save(10, old, {"n": 1}, 0.5)
    checkpoints.save(20, new, {"n": 2}, 0.6)
    path = checkpoints.folder / "step_000000000020.npz"
    whole = path.read_bytes()
    draw = random.Random(0)
    refused = 0
    for trial in range(200):
        at = draw.randrange(len(whole))
        if trial % 4:
            damaged = bytearray(whole)
            damaged[at] ^= 1 << draw.randrange(8)
        else:
            damaged = whole[:at]
        path.write_bytes(damaged)
        caplog.clear()
        with caplog.at_level(logging.WARNING):
            step, state, note = checkpoints.latest(old)
        if step == 10:
            refused += 1
            assert bits(state) == bits(old)
            assert note == {"n": 1}
            assert "step_000000000020.npz is damaged" in caplog.text
            assert "the checkpoint of step 10 is used" in caplog.text
        else:  # the bit was one that means nothing, such as a date in the archive's directory
            assert bits(state) == bits(new)
            assert note == {"n": 2}
    assert refused > 150


def test_when_all_are_damaged_each_is_named(checkpoints: Checkpoints) -> None:
    for step in (1, 2):
        checkpoints.save(step, {"x": 1}, {})
        (checkpoints.folder / f"step_{step:012d}.npz").write_bytes(b"PK")
    with pytest.raises(InputError, match=r"0002\.npz is damaged .*0001\.npz is damaged"):
        checkpoints.latest({"x": 1})


def test_another_format_is_refused(checkpoints: Checkpoints) -> None:
    checkpoints.folder.mkdir()
    text = json.dumps({"format": 99, "leaves": []}).encode()
    path = checkpoints.folder / "step_000000000001.npz"
    np.savez(path, manifest=np.frombuffer(text, np.uint8))
    with pytest.raises(InputError, match="is in format 99; this version reads 1"):
        checkpoints.latest({})


@pytest.mark.parametrize("missing", ["leaves", "score", "note"])
def test_a_manifest_without_one_of_its_parts_is_damaged(checkpoints, missing) -> None:
    manifest = {"format": 1, "step": 7, "score": 0.5, "note": {}, "leaves": []}
    del manifest[missing]
    checkpoints.folder.mkdir(exist_ok=True)
    for step in (7, 8):  # the best is looked for among all
        path = checkpoints.folder / f"step_{step:012d}.npz"
        np.savez(path, manifest=np.frombuffer(json.dumps(manifest).encode(), np.uint8))
    for read in (checkpoints.latest, checkpoints.best):
        with pytest.raises(InputError):
            read({})


def test_python_objects_in_a_file_are_never_unpickled(checkpoints: Checkpoints) -> None:
    checkpoints.folder.mkdir()
    path = checkpoints.folder / "step_000000000001.npz"
    np.savez(path, manifest=np.array([print], dtype=object), allow_pickle=True)
    with pytest.raises(InputError, match="damaged"):
        checkpoints.latest({})


def test_a_full_disk_is_one_sentence_and_keeps_what_was(checkpoints, monkeypatch) -> None:
    checkpoints.save(1, {"x": jnp.array(1)}, {})

    def no_space(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", no_space)
    with pytest.raises(InputError, match=r"cannot write .*0002.npz: No space left on device"):
        checkpoints.save(2, {"x": jnp.array(2)}, {})
    assert checkpoints.latest({"x": jnp.array(0)})[0] == 1
    assert [path.name for path in checkpoints.folder.iterdir()] == ["step_000000000001.npz"]


def test_what_cannot_be_kept_is_refused_when_saved(checkpoints: Checkpoints) -> None:
    with pytest.raises(TypeError, match="state/f is a function"):
        checkpoints.save(0, {"f": lambda: None}, {})


SAVER = """
import sys
from jaxleas.runs.checkpoints import Checkpoints
import numpy as np
checkpoints = Checkpoints(sys.argv[1], keep_last=2)
step = int(sys.argv[2])
print("ready", flush=True)
while True:
    step += 1
    state = {"x": np.full(500_000, step), "y": np.full((40, 40), step)}
    checkpoints.save(step, state, {"step": step}, best_score=step % 7)
    print(step, flush=True)
"""


@pytest.mark.parametrize("kills", [3, pytest.param(10, marks=pytest.mark.slow)])
def test_killed_at_any_moment_the_newest_can_be_restored(checkpoints, kills: int) -> None:
    """SIGKILL in the middle of saves; what was reported as saved is there, whole, every time."""
    like = {"x": np.zeros(500_000, int), "y": np.zeros((40, 40), int)}
    draw, step = random.Random(kills), 0
    for _ in range(kills):
        process = subprocess.Popen(
            [sys.executable, "-c", SAVER, str(checkpoints.folder), str(step)],
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "JAX_PLATFORMS": "cpu"},
        )
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        time.sleep(draw.uniform(0.0, 0.15))
        process.send_signal(signal.SIGKILL)
        reported = [int(line) for line in process.communicate()[0].splitlines()]
        if not checkpoints.steps():
            assert not reported
            continue
        step, state, note = checkpoints.latest(like)
        assert step >= max(reported, default=0)
        assert note == {"step": step}
        assert (state["x"] == step).all()
        assert (state["y"] == step).all()
        best = checkpoints.best(like)
        assert (best[1]["x"] == best[0]).all()
    assert step > 0
    checkpoints.save(step + 1, like, {})
    assert not list(checkpoints.folder.glob(".*")), "a killed save's leftovers are swept up"
