"""Strict JAX for every test: no silent broadcasting between ranks, no NaN passes unseen.

One run of the tests compiles a program once, whichever test or process asks for it: the cache is
new in every run and goes with it. Most programs are compiled to run for seconds, so they
are not optimised, in a sixth of the time: envs/test_optimisation.py compares with what is shipped.
"""

import atexit
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

if "JAX_COMPILATION_CACHE_DIR" not in os.environ:  # the workers of pytest-xdist inherit ours
    _CACHE = tempfile.mkdtemp(prefix="jaxleas-tests-")
    atexit.register(shutil.rmtree, _CACHE, ignore_errors=True)
    os.environ["JAX_COMPILATION_CACHE_DIR"] = _CACHE
    os.environ.setdefault("JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS", "0.2")

if "xla_backend_optimization_level" not in os.environ.get("XLA_FLAGS", ""):
    _UNOPTIMISED = "--xla_backend_optimization_level=0 --xla_cpu_use_fusion_emitters=false"
    os.environ["XLA_FLAGS"] = f"{os.environ.get('XLA_FLAGS', '')} {_UNOPTIMISED}".strip()

import hypothesis
import jax  # after its environment variables

# A first example compiles: how long it takes says nothing about the law that is tested.
hypothesis.settings.register_profile("jaxleas", deadline=None)
hypothesis.settings.load_profile("jaxleas")
jax.config.update("jax_numpy_rank_promotion", "raise")
jax.config.update("jax_debug_nans", True)

SHARED = Path(__file__).resolve().parents[2] / "shared"


@pytest.fixture(autouse=True, scope="module")
def _comes_back() -> Iterator[None]:
    """A file of tests that moves to another folder, and stays there, breaks those after it."""
    before = Path.cwd()
    yield
    after = Path.cwd()
    os.chdir(before)
    assert after == before, f"this file's tests end in {after}"


@pytest.fixture
def shared() -> Path:
    """The folder of reference data beside the repository; tests skip where it is missing."""
    if not SHARED.is_dir():
        pytest.skip("the reference data (../shared) is not here")
    return SHARED


@pytest.fixture
def brax_ranks():
    """Allow rank promotion around Brax's own code, which relies on it."""
    with jax.numpy_rank_promotion("allow"):
        yield
