"""A pytree as named plain arrays and back, exactly: typed random keys, Python numbers, bfloat16."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxleas.types import InputError

KEYS = ("threefry2x32", "rbg", "unsafe_rbg")
"""JAX's kinds of random keys."""
_ANEW = (
    "; another version or configuration wrote it, and this one cannot resume it: begin a new run"
    " with its config.yaml (its policy can still be used)"
)


def pack(state: Any) -> tuple[list[dict[str, Any]], dict[str, np.ndarray]]:
    """Return the description of each leaf, and copies of the leaves that are arrays.

    Args:
        state: pytree of arrays, typed random keys and Python numbers.

    Returns:
        One plain JSON entry per leaf; and the arrays by name.

    Raises:
        TypeError: a leaf is something else.
    """
    entries, arrays = [], {}
    for name, leaf in _named_leaves(state):
        entry: dict[str, Any] = {"name": name, "type": _type_of(leaf)}
        if isinstance(leaf, bool | int | float):
            entry["value"] = leaf  # JSON keeps Python's numbers exactly
        elif _is_key(leaf):
            entry["random_key"] = str(jax.random.key_impl(leaf))
            arrays[name] = np.array(jax.random.key_data(leaf))
        elif isinstance(leaf, jax.Array | np.ndarray | np.generic):
            arrays[name] = np.array(leaf)  # on a CPU `asarray` would show JAX's own memory
        else:
            raise TypeError(f"{name} is a {type(leaf).__name__}, which no checkpoint can hold")
        entries.append(entry)
    return entries, arrays


def unpack(
    like: Any, entries: list[Any], arrays: dict[str, np.ndarray], source: str, partial: bool
) -> Any:
    """Return the pytree that was given to `pack`, in the structure of `like`.

    Args:
        like: pytree of the same names, shapes and types (of arrays, or from `jax.eval_shape`).
        entries: entries that `pack` returned.
        arrays: arrays that `pack` returned.
        source: name of their source, for error messages.
        partial: whether to take only the leaves that `like` names; otherwise all must match.

    Raises:
        InputError: names, shapes or types differ from those of `like`.
    """
    held = {entry["name"]: entry for entry in entries}
    wanted = _named_leaves(like)
    unknown = [] if partial else sorted(held.keys() - {name for name, _ in wanted})
    if unknown:
        raise InputError(f"{source} is of another state: it also holds {unknown[0]}{_ANEW}")
    leaves = []
    for name, leaf in wanted:
        found = held[name]["type"] if name in held else "missing"
        if found != _type_of(leaf):
            raise InputError(
                f"{source} is of another state: {name} is {found} there and {_type_of(leaf)} here"
                f"{_ANEW}"
            )
        if not _is_restorable(leaf, held[name], arrays):
            raise InputError(f"{source} is damaged: {name} does not hold what it says it does")
        leaves.append(_restore(leaf, held[name], arrays))
    return jax.tree.unflatten(jax.tree.structure(like), leaves)


def _is_restorable(leaf: Any, entry: dict[str, Any], arrays: dict[str, np.ndarray]) -> bool:
    """Return whether the stored value has the type and shape of `leaf`, whatever its entry says."""
    if isinstance(leaf, bool | int | float):
        return type(entry.get("value")) is type(leaf)
    array = arrays.get(entry["name"])
    if "value" in entry or array is None:
        return False
    if jnp.issubdtype(leaf.dtype, jax.dtypes.prng_key):
        data = jax.eval_shape(jax.random.key_data, leaf)
        if array.dtype != data.dtype or array.shape != data.shape:
            return False
        impl = entry.get("random_key")
        return impl in KEYS and _key_type(data, impl) == leaf.dtype
    plain = array.dtype == leaf.dtype or (array.dtype.str, leaf.dtype.itemsize) == ("|V2", 2)
    return "random_key" not in entry and plain and array.shape == np.shape(leaf)


def _key_type(data: Any, impl: str) -> Any:
    return jax.eval_shape(lambda words: jax.random.wrap_key_data(words, impl=impl), data).dtype


def _restore(leaf: Any, entry: dict[str, Any], arrays: dict[str, np.ndarray]) -> Any:
    if "value" in entry:
        return type(leaf)(entry["value"])
    array = arrays[entry["name"]]
    if "random_key" in entry:
        return jax.random.wrap_key_data(jnp.array(array), impl=entry["random_key"])
    array = array.view(leaf.dtype)  # .npz stores bfloat16 as two plain bytes
    # A copy, so that JAX owns the memory and may donate it.
    return array if isinstance(leaf, np.ndarray | np.generic) else jnp.array(array)


def _named_leaves(tree: Any) -> list[tuple[str, Any]]:
    pairs = jax.tree_util.tree_flatten_with_path(tree)[0]
    return [
        ("state/" + jax.tree_util.keystr(path, simple=True, separator="/"), leaf)
        for path, leaf in pairs
    ]


def _type_of(leaf: Any) -> str:
    if isinstance(leaf, bool | int | float):
        return type(leaf).__name__
    shape = ",".join(map(str, getattr(leaf, "shape", ())))
    return f"{getattr(leaf, 'dtype', type(leaf).__name__)}[{shape}]"


def _is_key(leaf: Any) -> bool:
    return isinstance(leaf, jax.Array) and jnp.issubdtype(leaf.dtype, jax.dtypes.prng_key)
