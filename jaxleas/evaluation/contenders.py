"""The methods of a side-by-side comparison: built-in ones, further policies, and one's own."""

import difflib
import hashlib
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from jaxleas.configuration import is_own
from jaxleas.evaluation.contender import Contender, contender
from jaxleas.evaluation.examination import Candidate
from jaxleas.evaluation.roadmap_contender import roadmap_contender
from jaxleas.evaluation.terms import Terms
from jaxleas.files import policy_path
from jaxleas.guide import (
    METHODS,
    compared,
    find_method,
    import_ompl,
    leas,
    policy_file,
    read_steering_policy,
)
from jaxleas.types import InputError


@dataclass(frozen=True)
class Contenders:
    """The methods of a comparison.

    Attributes:
        methods: methods by the name that results carry, baselines first.
        fingerprints: SHA-256 of the files of further policies and of methods of one's own, by
            name.
    """

    methods: Mapping[str, Contender]
    fingerprints: Mapping[str, str]


def make_contenders(
    candidate: Candidate,
    policies: Mapping[str, Path] | None = None,
    wanted: Sequence[str] | None = None,
) -> Contenders:
    """Return the methods of a comparison.

    Args:
        candidate: policy to judge, with its baselines.
        policies: paths of further policies, by the name that results will carry.
        wanted: names of the methods that walk, each as on a command line or as in result files,
            or MODULE:CLASS of one's own; by default the methods usually compared, and the further
            policies.

    Raises:
        InputError: a name is unknown or taken, or a policy cannot be used.
    """
    policies = {} if policies is None else policies
    usual = compared()
    for name in policies:
        if name in usual:
            raise InputError(f"the method {name!r} is there already; give the policy another name")
    names = [*usual, *policies]
    chosen = names if wanted is None else [_known(name, policies) for name in wanted]
    methods: dict[str, Contender] = {}
    fingerprints: dict[str, str] = {}
    for name in sorted(dict.fromkeys(chosen), key=lambda each: (*names, each).index(each)):
        if name in policies:
            methods[name] = _policy_contender(policies[name], candidate.terms)
            fingerprints[name] = fingerprint_of(policies[name])
        elif is_own(name):
            methods[name] = _own_contender(candidate, name)
            fingerprints |= _fingerprint_of_code(name)
        elif name in candidate.methods:
            methods[name] = contender(candidate.env, candidate.methods[name])
        else:
            import_ompl()
            method = next(each for each in METHODS if each.roadmap_key == name)
            methods[name] = roadmap_contender(
                candidate.env, candidate.methods[method.key], method.edges
            )
    return Contenders(methods, fingerprints)


def _known(name: str, policies: Mapping[str, Path]) -> str:
    """Return the name in result files of a method that a person asked for.

    Raises:
        InputError: there is no such method.
    """
    if name in policies or is_own(name):
        return name
    keys = {each.name: each.key for each in METHODS} | {
        key: key for each in METHODS for key in (each.key, each.roadmap_key)
    }
    if name in keys:
        return keys[name]
    names = [*compared(), *policies]
    close = difflib.get_close_matches(name, names, n=1)
    hint = f"did you mean {close[0]!r}? There are" if close else "there are"
    raise InputError(
        f"no method is called {name!r}; {hint} {', '.join(names)}, or MODULE:CLASS of your own"
    )


def parse_policies(given: Sequence[str]) -> dict[str, Path]:
    """Return the policies given as `name=path` texts.

    Raises:
        InputError: a text does not have that form, or a name is given twice.
    """
    policies: dict[str, Path] = {}
    for text in given:
        name, found, path = text.partition("=")
        if not (name.isidentifier() and found and path):
            raise InputError(f"{text!r} is no policy: write name=path, e.g. leas_p2_mip=runs/p2")
        if name in policies:
            raise InputError(f"two policies are called {name!r}: give each its own name")
        policies[name] = policy_path(path)
    return policies


def fingerprint_of(path: Path) -> str:
    """Return the SHA-256 of a policy's file."""
    file = policy_file(path) if path.is_dir() else path
    return hashlib.sha256(file.read_bytes()).hexdigest()


def _own_contender(candidate: Candidate, name: str) -> Contender:
    method = find_method(name)
    policy = read_steering_policy(candidate.path) if method.needs_policy else None
    return contender(candidate.env, method.make(candidate.env, policy))


def _fingerprint_of_code(name: str) -> dict[str, str]:
    """Return the SHA-256 of the module of one's own method, so that changed code walks again."""
    file = getattr(sys.modules[name.partition(":")[0]], "__file__", None)
    return {} if file is None else {name: hashlib.sha256(Path(file).read_bytes()).hexdigest()}


def _policy_contender(path: Path, terms: Terms) -> Contender:
    policy = read_steering_policy(path)
    env = terms.env(policy.config)
    return contender(env, leas(env, policy))
