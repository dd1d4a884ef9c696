"""Actor and critic of a task: two distinct networks."""

from dataclasses import dataclass
from typing import Any

from jax import Array
from jaxtyping import Float, Key

from jaxleas.envs import Signature
from jaxleas.training.brax_blocks import PPONetworkParams
from jaxleas.training.config import NetworkConfig
from jaxleas.training.networks.making import make_network
from jaxleas.training.networks.network import Network


@dataclass(frozen=True)
class ActorCritic:
    """The networks of a policy and of its value.

    Attributes:
        signature: observation that they see, and meaning of the actor's answer.
        actor: network that sees what a policy is shown.
        critic: network that sees every part of the observation, also those for the critic alone.
        numbers: number type in which training computes products.
    """

    signature: Signature
    actor: Network
    critic: Network
    numbers: str

    def init(self, policy_key: Key[Array, ""], value_key: Key[Array, ""]) -> Any:
        """Return untrained parameters of both."""
        return PPONetworkParams(
            policy=self.actor.init(policy_key), value=self.critic.init(value_key)
        )

    def answer(
        self,
        policy: Any,
        seen: Float[Array, "*batch size"],
    ) -> Float[Array, "*batch logits"]:
        """Return the actor's answer.

        Args:
            policy: parameters of the actor.
            seen: normalised observations.
        """
        return self.actor.answer(policy, self.signature.for_actor(seen), self.numbers)

    def values(
        self,
        value: Any,
        seen: Float[Array, "*batch size"],
    ) -> Float[Array, "*batch"]:
        """Return the critic's answer; the arguments are those of `answer`."""
        return self.critic.answer(value, seen, self.numbers)[..., 0]

    def plain(self, policy: Any, seen: Float[Array, "*batch size"]) -> Array:
        """Return the actor's answer as it is judged and exported."""
        return self.actor.plain(policy, self.signature.for_actor(seen))


def make_networks(config: NetworkConfig, signature: Signature) -> ActorCritic:
    """Return actor and critic of a task."""
    return ActorCritic(
        signature,
        actor=make_network(config, signature.seen, signature.logits),
        critic=make_network(config, signature.parts, 1),
        numbers=config.product_type,
    )
