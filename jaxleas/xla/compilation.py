"""Compiled programs are kept between processes, which makes later starts of a run faster."""

import os
from pathlib import Path

import jax


def keep_compiled_programs() -> None:
    """Turn on JAX's persistent compilation cache, unless the user has set or disabled one.

    The folder is JAX_COMPILATION_CACHE_DIR if set (empty: no cache), else `jaxleas/xla` in the
    user's cache folder.
    """
    if "JAX_COMPILATION_CACHE_DIR" in os.environ:
        return
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    jax.config.update("jax_compilation_cache_dir", str(base / "jaxleas" / "xla"))
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.5)
