"""The minibatches of an optimisation: which robots learn together, mirrored or as they walked."""

from dataclasses import replace

import jax
import jax.numpy as jnp
from flax import struct
from jax import Array
from jaxtyping import Bool, Float, Int

from jaxleas.envs import Head, Signature
from jaxleas.training.config import PpoConfig
from jaxleas.training.loss import Experience
from jaxleas.xla import compute_once, take_inside


@struct.dataclass
class Draws:
    """All chance of an optimisation, one row per minibatch.

    Attributes:
        order: place of each robot in its group.
        flip: whether the robot is mirrored.
        noise: standard normal numbers for each head.
    """

    order: Int[Array, "steps some"]
    flip: Bool[Array, "steps some"]
    noise: tuple[Float[Array, "steps time some entropy_noise"], ...]


def draw_minibatches(ppo: PpoConfig, heads: tuple[Head, ...], mirror: bool, key: Array) -> Draws:
    """Draw which robots make up each minibatch, which of them are mirrored, and normal noise.

    A minibatch has one robot of each group of `ppo.minibatches` neighbours, so that devices which
    hold whole groups have their share of each. Robots are drawn, not samples: sorting and
    gathering whole batches is slow.

    Args:
        ppo: configuration of PPO: numbers of robots, minibatches and epochs.
        heads: heads of the action, whose entropies are estimated.
        mirror: whether half of the robots are mirrored.
        key: randomness for all of it, consumed here.
    """
    groups = ppo.environments // ppo.minibatches
    order_key, flip_key, noise_key = jax.random.split(key, 3)
    tickets = jax.random.uniform(order_key, (ppo.epochs, ppo.minibatches, groups))
    order = jnp.argsort(tickets, axis=1).reshape(-1, groups)
    flip = jax.random.bernoulli(flip_key, 0.5 if mirror else 0.0, order.shape)
    keys = [noise_key] if len(heads) == 1 else jax.random.split(noise_key, len(heads))
    noise = tuple(
        jax.random.normal(each, (len(order), ppo.unroll, groups, head.entropy_noise))
        for head, each in zip(heads, keys, strict=True)
    )
    return Draws(order, flip, noise)


def mirror_images(
    signature: Signature,
    batch: Experience,
    last_observation: Float[Array, "robots size"],
    mirror: bool = True,
) -> tuple[Experience, Float[Array, "1 images robots size"]]:
    """Return the experience and its mirror image, left and right swapped.

    The task is symmetric, so a mirrored step is as good as one that was walked; its probability
    under the old policy is taken to be the original's, which is exact once the policy is symmetric.
    Mirroring is done once per update: a minibatch then takes whole rows.

    Args:
        signature: parts and heads, with their mirrors.
        batch: experience of all robots.
        last_observation: observation of all robots after the last step.
        mirror: whether to add the mirror image.

    Returns:
        The batch [time, images, robots, ...], as walked and then mirrored, and the last
        observation, also with a time axis (of length one).
    """
    if not mirror:
        return jax.tree.map(lambda leaf: leaf[:, None], (batch, last_observation[None]))

    def both(walked, image):
        return jax.tree.map(lambda *each: jnp.stack(each, axis=1), walked, image)

    def seen(whole: Array) -> Array:
        return both(whole, signature.mirror(whole))

    heads = signature.heads
    raw = [
        head.mirrored_raw(each)
        for head, each in zip(heads, signature.raw(batch.raw_action), strict=True)
    ]
    distributions = tuple(
        head.mirrored(each) for head, each in zip(heads, batch.distributions, strict=True)
    )
    images = Experience(
        observation=seen(batch.observation),
        raw_action=both(
            batch.raw_action, raw[0] if len(raw) == 1 else jnp.concatenate(raw, axis=-1)
        ),
        distributions=both(batch.distributions, distributions),
        reward=both(batch.reward, batch.reward),
        terminated=both(batch.terminated, batch.terminated),
        truncated=both(batch.truncated, batch.truncated),
    )
    return images, seen(last_observation[None])


def take_robots(
    images: Experience,
    last_observation: Float[Array, "1 images robots size"],
    chosen: Int[Array, " some"],
    flip: Bool[Array, " some"],
) -> tuple[Experience, Float[Array, "1 some size"]]:
    """Return some of the robots, mirrored or as they walked.

    Args:
        images: experience of all robots, as walked and mirrored.
        last_observation: observation of all robots after the last step, likewise.
        chosen: indices of the robots to take.
        flip: whether each of them is mirrored.
    """
    rows = flip.astype(jnp.int32) * images.reward.shape[2] + chosen

    def take(leaf: Array) -> Array:
        # Row by row: all steps of a robot at once would come out with the robots first.
        time, count, robots, *rest = leaf.shape
        flat = leaf.reshape(time * count * robots, *rest)
        begin = jnp.arange(time, dtype=jnp.int32)[:, None] * (count * robots)
        return take_inside(flat, begin + rows)

    # Observations separately: the first layers' products need them both as they are and transposed.
    seen = compute_once(take, images.observation)
    rest = replace(images, observation=images.reward)
    return replace(jax.tree.map(take, rest), observation=seen), take(last_observation)
