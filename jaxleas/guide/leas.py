"""LEAS: a trained policy as a steering method (T sec. 3.2)."""

from typing import ClassVar

from flax import struct
from jax import Array
from jaxtyping import Float

from jaxleas.envs.steering import SteeringEnv, integrate
from jaxleas.guide.onnx_policy import OnnxLeas, OnnxPolicy
from jaxleas.guide.steering_method import SteeringMethod
from jaxleas.training import Policy
from jaxleas.types import InputError, RootMotion


@struct.dataclass
class Leas:
    """Observe, ask the policy, integrate (T eq. 3.1-3.3).

    Attributes:
        policy: trained policy; its arrays may change without a new compilation.
        env: environment that computes the observation.
        guarded: whether a roll-out lets the environment's guard watch over it.
    """

    policy: Policy
    env: SteeringEnv = struct.field(pytree_node=False)
    guarded: ClassVar[bool] = True

    def __call__(
        self,
        heights_in_root: Float[Array, "*batch points"],
        motion: RootMotion,
        goal: Float[Array, "*batch 3"],
    ) -> RootMotion:
        """Return the root motion one time step later; the goal's height is ignored."""
        observation = self.env.observe(heights_in_root, motion, goal[..., :2])
        return integrate(motion, self.policy(observation), self.env.config.limits)


def leas(env: SteeringEnv, policy: Policy | OnnxPolicy) -> SteeringMethod:
    """Return a policy as a steering method.

    Args:
        env: environment that computes the policy's observation.
        policy: trained policy from a run folder, a `policy.npz` or an ONNX file.

    Raises:
        InputError: the environment's observation, motion or guard differs from the policy's.
    """
    for field in ("observation", "height_low", "height_high", "limits", "guard"):
        here, there = getattr(env.config, field), getattr(policy.config, field)
        if here != there:
            raise InputError(
                f"the environment's {field} is {here}, but the policy was trained with {there}:"
                " build the environment from the policy's own config"
            )
    return OnnxLeas(env, policy) if isinstance(policy, OnnxPolicy) else Leas(policy, env)
