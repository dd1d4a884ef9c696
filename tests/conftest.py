"""Strict JAX for every test: no silent broadcasting between ranks, no NaN passes unseen."""

import os
from pathlib import Path

import jax
import pytest

jax.config.update("jax_numpy_rank_promotion", "raise")
jax.config.update("jax_debug_nans", True)
os.environ.setdefault("JAX_COMPILATION_CACHE_DIR", "")  # tests measure nothing cached

SHARED = Path(__file__).resolve().parents[2] / "shared"


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
