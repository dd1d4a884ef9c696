"""The methods of a side-by-side comparison: baselines, the policy judged, further policies."""

import difflib
import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from jaxleas.evaluation.exact import Walker, walker
from jaxleas.evaluation.examination import POLICY, Candidate
from jaxleas.evaluation.refusal import Refusal, env_of
from jaxleas.evaluation.roadmap_walker import roadmap_walker
from jaxleas.guide.leas import leas
from jaxleas.guide.loading import load_policy, policy_file
from jaxleas.guide.registry import BASELINES
from jaxleas.guide.roadmaps.search import import_ompl
from jaxleas.types.errors import InputError

ROADMAP = "rb_kino_rrt"


@dataclass(frozen=True)
class Contenders:
    """The methods of a comparison.

    Attributes:
        walkers: walkers by the name that results carry, baselines first.
        fingerprints: SHA-256 of the further policies' files, by name.
    """

    walkers: Mapping[str, Walker]
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
        wanted: names of the methods that walk; all by default.

    Raises:
        InputError: a name is unknown or taken, or a policy cannot be used.
    """
    policies = {} if policies is None else policies
    names = [*BASELINES, ROADMAP, POLICY, *policies]
    for name in policies:
        if names.count(name) > 1:
            raise InputError(f"the method {name!r} is there already; give the policy another name")
    for name in wanted or ():
        if name not in names:
            close = difflib.get_close_matches(name, names, n=1)
            hint = f"did you mean {close[0]!r}? There are" if close else "there are"
            raise InputError(f"no method is called {name!r}; {hint} {', '.join(names)}")
    chosen = [name for name in names if wanted is None or name in wanted]
    walkers, fingerprints = {}, {}
    for name in chosen:
        if name in policies:
            walkers[name] = _policy_walker(policies[name], candidate.refusal)
            fingerprints[name] = fingerprint_of(policies[name])
        elif name == ROADMAP:
            import_ompl()
            walkers[name] = roadmap_walker(candidate.env, candidate.methods["rb_kino"], "kino")
        else:
            walkers[name] = walker(candidate.env, candidate.methods[name])
    return Contenders(walkers, fingerprints)


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
        policies[name] = Path(path)
    return policies


def fingerprint_of(path: Path) -> str:
    """Return the SHA-256 of a policy's file."""
    file = policy_file(path) if path.is_dir() else path
    return hashlib.sha256(file.read_bytes()).hexdigest()


def _policy_walker(path: Path, refusal: Refusal | None) -> Walker:
    policy = load_policy(path)
    env = env_of(policy.config, refusal)
    return walker(env, leas(env, policy))
