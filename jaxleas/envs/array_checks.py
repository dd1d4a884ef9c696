"""Checks of arrays that a user's own code gave: their place in a tree, shape and type.

Arrays may be abstract (`jax.eval_shape`): nothing is computed.
"""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxleas.types import InputError

KINDS = {
    "numbers": (jnp.floating, jnp.integer),
    "truth values": (np.bool_,),
    "whole numbers": (jnp.integer,),
    "values": (jnp.floating, jnp.integer, np.bool_),
}
"""Types that an array may have, by the name of the kind."""


def require_array(what: str, leaf: Any, shape: tuple[int, ...] | None, kind: str) -> None:
    """Refuse an array of another shape or type.

    Args:
        what: name of the array, with which the message begins.
        leaf: the array.
        shape: shape that it must have; None: any.
        kind: kind of its values, a key of `KINDS`.

    Raises:
        InputError: one sentence says what was given, and what would do.
    """
    found, dtype = _array(what, leaf)
    if not any(jnp.issubdtype(dtype, each) for each in KINDS[kind]):
        raise InputError(f"{what} is of type {dtype}; give {kind}")
    if shape is not None and found != shape:
        raise InputError(f"{what} is of shape {found}; here {shape} would do, robots first")


def require_rows(what: str, tree: Any, leading: tuple[int, ...], axes: str) -> None:
    """Refuse a pytree of which an array lacks the leading axes.

    Args:
        what: name of the pytree, with which the message begins.
        tree: pytree of arrays.
        leading: lengths of the leading axes.
        axes: names of these axes, for the message.

    Raises:
        InputError: a leaf is no array, or of another shape.
    """
    leaves = jax.tree_util.tree_flatten_with_path(tree)[0]
    if not leaves:
        raise InputError(f"{what} is {kind_of(tree)}, which holds no arrays")
    for path, leaf in leaves:
        name = what + jax.tree_util.keystr(path)
        shape, _ = _array(name, leaf)
        if shape[: len(leading)] != leading:
            here = ", ".join(map(str, leading))
            raise InputError(f"{name} is of shape {shape}; give [{axes}, ...], here [{here}, ...]")


def require_same(what: str, answer: Any, like: Any) -> None:
    """Refuse a state that is not of the structure, shapes and types of the first state.

    Args:
        what: name of the method that gave it, with which the message begins.
        answer: the state.
        like: the state of which `draw_starts` gave candidates.

    Raises:
        InputError: they differ: no scan could go on, and no checkpoint could be resumed.
    """
    got, wanted = _by_name(answer), _by_name(like)
    for name in [*wanted, *(got.keys() - wanted.keys())]:
        if name not in got or name not in wanted:
            verb = "lacks" if name in wanted else "adds"
            raise InputError(f"{what}: the state {verb} {name}; give what draw_starts begins with")
        if got[name] != wanted[name]:
            raise InputError(
                f"{what}: state{name} is {got[name]}, but draw_starts begins with {wanted[name]}:"
                " give the same type and shape"
            )


def require_arrays(what: str, tree: Any) -> None:
    """Refuse a pytree of which a leaf is no array; it may hold nothing at all.

    Args:
        what: name of the pytree, with which the message begins.
        tree: pytree of arrays.

    Raises:
        InputError: a leaf is no array.
    """
    for path, leaf in jax.tree_util.tree_flatten_with_path(tree)[0]:
        _array(what + jax.tree_util.keystr(path), leaf)


def kind_of(value: Any) -> str:
    """Return what a value is, for a message."""
    if hasattr(value, "shape") and hasattr(value, "dtype"):
        return "an array"
    return "None" if value is None else f"a {type(value).__name__}"


def _by_name(tree: Any) -> dict[str, str]:
    """Return type and shape of each leaf, by its place in the tree."""
    found = {}
    for path, leaf in jax.tree_util.tree_flatten_with_path(tree)[0]:
        shape, dtype = _array("the state", leaf)
        found[jax.tree_util.keystr(path)] = f"{dtype}{list(shape)}"
    return found


def _array(what: str, leaf: Any) -> tuple[tuple[int, ...], Any]:
    """Return shape and type of an array, abstract or not, or of what NumPy can make one of."""
    if hasattr(leaf, "shape") and hasattr(leaf, "dtype"):
        return tuple(leaf.shape), leaf.dtype
    try:
        array = np.asarray(leaf)
    except ValueError as error:
        raise InputError(f"{what} is {kind_of(leaf)}; give an array") from error
    if array.dtype.kind not in "biuf":
        raise InputError(f"{what} is {kind_of(leaf)}; give an array")
    return array.shape, array.dtype
