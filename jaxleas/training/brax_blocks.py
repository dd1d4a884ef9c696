"""The parts of Brax that PPO is built from, imported without Brax's physics.

`import brax` pulls in mujoco (a second of start-up and two warnings) for its simulators, which
training without physics never touches. `brax.training` itself needs none of that. So the package
`brax` is registered first as an empty shell with the right path: its training parts load through
it, and the first touch of anything else (`brax.State`, say) runs the real package's own
initialisation.
"""

import importlib.util
import sys
from types import ModuleType
from typing import Any


class _BraxShell(ModuleType):
    """The package `brax` before its `__init__` has run."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or self.__spec__ is None or self.__spec__.loader is None:
            raise AttributeError(name)
        # From here on the package is an ordinary one.
        object.__setattr__(self, "__class__", ModuleType)
        self.__spec__.loader.exec_module(self)
        return getattr(self, name)


def _register_shell() -> None:
    spec = importlib.util.find_spec("brax")
    if spec is None or spec.submodule_search_locations is None:
        raise ModuleNotFoundError("brax is not installed: run `make train` or `make test`")
    shell = _BraxShell("brax")
    shell.__spec__ = spec
    shell.__file__ = spec.origin
    shell.__path__ = list(spec.submodule_search_locations)
    sys.modules["brax"] = shell


if "brax" not in sys.modules:
    _register_shell()

from brax.training.acme import running_statistics, specs  # noqa: E402
from brax.training.agents.ppo import losses  # noqa: E402
from brax.training.agents.ppo import networks as _networks  # noqa: E402
from brax.training.agents.ppo.losses import compute_ppo_loss  # noqa: E402
from brax.training.agents.ppo.networks import PPONetworks  # noqa: E402
from brax.training.networks import ACTIVATION, MLP  # noqa: E402
from brax.training.types import Transition as _Transition  # noqa: E402

# Any pytree may pass through these; Brax's annotations say "an array", and checkers believe them.
make_ppo_networks: Any = _networks.make_ppo_networks
PPONetworkParams: Any = losses.PPONetworkParams
Transition: Any = _Transition

__all__ = [
    "ACTIVATION",
    "MLP",
    "PPONetworkParams",
    "PPONetworks",
    "Transition",
    "compute_ppo_loss",
    "make_ppo_networks",
    "running_statistics",
    "specs",
]
