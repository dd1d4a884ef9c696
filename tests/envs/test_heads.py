"""Laws of heads: densities sum to one, the mirror is its own inverse, NumPy agrees."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.envs.heads import Ball, Cases, Categorical, Interval, Normal
from jaxleas.envs.mirror import Mirror
from jaxleas.envs.part import Part
from jaxleas.envs.signature import Signature
from jaxleas.types import InputError

NORMAL = Normal("move", (Ball(2.0, 2), Interval(1.0, 5.0)), Mirror((0, 1, 2), (1.0, -1.0, 1.0)))
CHOICE = Categorical("foot", 5, (1, 0, 3, 2, 4))
CASES = Cases("step", CHOICE, NORMAL)
HEADS = pytest.mark.parametrize("head", [NORMAL, CHOICE, CASES], ids=lambda head: head.name)
FLAT = Signature((Part("all", (3,), mirror=Mirror.of_signs([1.0, -1.0, 1.0])),), (NORMAL, CHOICE))


def logits_of(head, seed=0, count=64):
    parts = jax.random.split(jax.random.key(seed), len(head.logits))
    return [jax.random.normal(key, (count, n)) for key, n in zip(parts, head.logits, strict=True)]


def test_a_gain_narrows_what_an_untrained_network_does():
    narrow = Normal("move", NORMAL.scales, gain=0.2)
    wide, few = (head.distribution(*logits_of(NORMAL)) for head in (NORMAL, narrow))
    np.testing.assert_allclose(few.location, 0.2 * wide.location, rtol=1e-6)
    np.testing.assert_allclose(few.deviation, 0.2 * wide.deviation + 0.8e-3, rtol=1e-5)
    np.testing.assert_allclose(narrow.mode(*logits_of(NORMAL)), np.tanh(few.location), rtol=1e-6)
    with pytest.raises(InputError, match=r"the gain 0\.0"):
        Normal("move", NORMAL.scales, gain=0.0)


def test_a_choice_is_drawn_as_often_as_its_probability():
    logits = jnp.array([[0.0, 1.0, 2.0, -1.0, 0.5]])
    distribution = CHOICE.distribution(jnp.broadcast_to(logits, (40_000, 5)))
    noise = CHOICE.draw_noise(jax.random.key(0), (40_000,))
    drawn = np.bincount(np.asarray(CHOICE.action(CHOICE.sample(distribution, noise))), minlength=5)
    expected = np.exp(np.asarray(logits[0]))
    np.testing.assert_allclose(drawn / 40_000, expected / expected.sum(), atol=0.01)


def test_a_normal_head_is_drawn_as_its_distribution_says():
    logits = [jnp.broadcast_to(each, (40_000, 3)) for each in (jnp.arange(3.0), jnp.zeros(3))]
    distribution = NORMAL.distribution(*logits)
    raw = NORMAL.sample(distribution, NORMAL.draw_noise(jax.random.key(1), (40_000,)))
    deviation = np.log(2.0) + 1e-3  # softplus(0)
    np.testing.assert_allclose(raw.mean(axis=0), [0, 1, 2], atol=0.02)
    np.testing.assert_allclose(raw.std(axis=0), deviation, atol=0.02)


def test_log_densities_are_those_of_numpy():
    location, spread = (np.asarray(each, np.float64) for each in logits_of(NORMAL))
    distribution = NORMAL.distribution(jnp.asarray(location), jnp.asarray(spread))
    raw = np.random.default_rng(0).normal(size=location.shape)
    deviation = np.log1p(np.exp(spread)) + 1e-3
    expected = np.log(
        np.exp(-0.5 * ((raw - location) / deviation) ** 2) / (deviation * np.sqrt(2 * np.pi))
    ).sum(axis=-1)
    np.testing.assert_allclose(NORMAL.log_density(raw, distribution), expected, atol=1e-4)
    (logits,) = logits_of(CHOICE)
    choice = np.arange(64)[:, None] % 5
    exact = np.exp(np.asarray(logits, np.float64))
    exact = np.log(exact / exact.sum(axis=1, keepdims=True))[np.arange(64), choice[:, 0]]
    found = CHOICE.log_density(jnp.asarray(choice, jnp.float32), CHOICE.distribution(logits))
    np.testing.assert_allclose(found, exact, atol=1e-5)


def test_numbers_of_a_case_are_drawn_from_its_own_distribution():
    locations, spreads, scores = (each[:1] for each in logits_of(CASES, count=1))
    many = [jnp.broadcast_to(each, (60_000, each.shape[-1])) for each in (locations, spreads)]
    distribution = CASES.distribution(*many, jnp.broadcast_to(scores, (60_000, 5)))
    raw = np.asarray(CASES.sample(distribution, CASES.draw_noise(jax.random.key(2), (60_000,))))
    for case in range(5):
        mine = raw[raw[:, -1] == case, :-1]
        place = np.asarray(locations[0]).reshape(5, 3)[case]
        deviation = np.log1p(np.exp(np.asarray(spreads[0]).reshape(5, 3)[case])) + 1e-3
        few = 5.0 / np.sqrt(len(mine))
        np.testing.assert_array_less(np.abs(mine.mean(axis=0) - place), few * deviation)
        np.testing.assert_allclose(mine.std(axis=0), deviation, rtol=few)
    # The density of a sample is that of its case times that of its numbers in it.
    probability = np.exp(scores[0]) / np.exp(scores[0]).sum()
    case = raw[:100, -1].astype(int)
    place = np.asarray(locations[0], np.float64).reshape(5, 3)[case]
    deviation = np.log1p(np.exp(np.asarray(spreads[0], np.float64).reshape(5, 3)[case])) + 1e-3
    normal = np.exp(-0.5 * ((raw[:100, :-1] - place) / deviation) ** 2)
    expected = np.log(probability[case]) + np.log(normal / (deviation * np.sqrt(2 * np.pi))).sum(
        axis=1
    )
    first = jax.tree.map(lambda leaf: leaf[:100], distribution)
    np.testing.assert_allclose(CASES.log_density(raw[:100], first), expected, atol=1e-4)
    # By samples, the entropy of the raw action; the head adds the slope of the tanh.
    slope = 2.0 * (np.log(2.0) - raw[:, :-1] - np.logaddexp(0.0, -2.0 * raw[:, :-1]))
    sampled = -np.asarray(CASES.log_density(raw, distribution)) + slope.sum(axis=1)
    noise = jax.random.normal(jax.random.key(4), (60_000, 3))
    estimate = np.asarray(CASES.entropy(distribution, noise))
    assert estimate.mean() == pytest.approx(sampled.mean(), abs=0.06)


def test_the_mode_of_cases_is_the_likeliest_case_and_its_own_numbers():
    locations, spreads, scores = logits_of(CASES)
    mode = np.asarray(CASES.mode(locations, spreads, scores))
    likeliest = np.argmax(np.asarray(scores), axis=1)
    np.testing.assert_array_equal(mode[:, -1], likeliest)
    own = np.asarray(locations).reshape(64, 5, 3)[np.arange(64), likeliest]
    np.testing.assert_allclose(mode[:, :-1], np.tanh(own), atol=1e-6)
    command = np.asarray(CASES.command(jnp.asarray(mode)))
    np.testing.assert_allclose(command[:, :-1], NORMAL.command(mode[:, :-1]), atol=1e-6)


@HEADS
def test_the_divergence_is_zero_from_itself_and_positive_from_others(head):
    one, other = (head.distribution(*logits_of(head, seed)) for seed in (0, 1))
    np.testing.assert_allclose(head.divergence(one, one), 0.0, atol=1e-6)
    assert np.all(np.asarray(head.divergence(one, other)) > 0.0)


def test_entropy_is_minus_the_mean_log_density():
    distribution = CHOICE.distribution(*logits_of(CHOICE))
    each = [
        np.exp(density) * density
        for choice in range(5)
        for density in [np.asarray(CHOICE.log_density(jnp.full((64, 1), choice), distribution))]
    ]
    np.testing.assert_allclose(
        CHOICE.entropy(distribution, jnp.zeros((64, 0))), -sum(each), atol=1e-5
    )


@HEADS
def test_mirrored_twice_is_none_and_densities_do_not_change(head):
    distribution = head.distribution(*logits_of(head))
    raw = head.sample(distribution, head.draw_noise(jax.random.key(3), (64,)))
    image, raw_image = head.mirrored(distribution), head.mirrored_raw(raw)
    np.testing.assert_allclose(
        head.log_density(raw_image, image), head.log_density(raw, distribution), atol=1e-5
    )
    np.testing.assert_array_equal(head.mirrored_raw(raw_image), raw)
    jax.tree.map(np.testing.assert_array_equal, head.mirrored(image), distribution)


def test_commands_keep_their_bounds():
    action = jax.random.uniform(jax.random.key(0), (1000, 3), minval=-3.0, maxval=3.0)
    command = np.asarray(NORMAL.command(action))
    length = np.linalg.norm(command[:, :2], axis=1)
    assert length.max() <= 2.0 * (1 + 1e-6)
    assert command[:, 2].min() == 1.0
    assert command[:, 2].max() == 5.0


def test_actions_of_several_heads_go_by_name():
    logits = jax.random.normal(jax.random.key(0), (7, FLAT.logits))
    distributions = FLAT.distributions(logits)
    raw = FLAT.sample(distributions, FLAT.draw_noise(jax.random.key(1), (7,)))
    assert raw.shape == (7, FLAT.action_size)
    action = FLAT.action(raw)
    assert action["move"].shape == (7, 3)
    assert action["foot"].shape == (7,)
    assert action["foot"].dtype == jnp.int32
    assert FLAT.command(FLAT.mode(logits)).keys() == {"move", "foot"}


def test_a_mirror_order_that_is_not_its_own_inverse_is_refused():
    with pytest.raises(InputError, match="its own inverse"):
        Categorical("foot", 3, (1, 2, 0))


def mirrored(mirror):
    return Normal("move", (Interval(-1.0, 1.0, 2),), mirror)


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (
            lambda: Cases("step", Categorical("foot", 5), NORMAL),
            "'step' has a mirror for its choice or for its numbers alone: give both, or none",
        ),
        (lambda: Categorical("foot", 1), "'foot' has 1 choices; .* two at least"),
        (lambda: Categorical("foot", 2.0), "'foot' has 2.0 choices"),
        (lambda: Categorical("foot", 3, (0, 1)), r"mirror_order = \(0, 1\)"),
        (lambda: Interval(1.0, -1.0), "is not an interval: give finite numbers, low below high"),
        (lambda: Interval(0.0, np.inf), "is not an interval"),
        (lambda: Interval(0.0, 1.0, 0), "scales 0 values"),
        (lambda: Ball(-1.0), "is not a ball: give a finite radius above 0"),
        (lambda: Ball(1.0, 2.5), "scales 2.5 values"),
        (lambda: Normal("move", Ball(1.0)), r"give a tuple of scales"),
        (lambda: Normal("move", ()), r"'move' has the scales \(\)"),
        (
            lambda: mirrored(Mirror.of_signs([1])),
            "'move' has 2 values, but its mirror is one of 1",
        ),
        (lambda: mirrored((1, -1)), r"the mirror \(1, -1\); give a Mirror"),
        (lambda: Mirror((0, 0), (1, 1)), "names each value once"),
        (lambda: Mirror((0, 1), (1,)), "a sign for each"),
        (lambda: Mirror((1, 2, 0), (1, 1, 1)), "not its own inverse"),
        (lambda: Mirror((1, 0), (1, -1)), "not its own inverse"),
        (lambda: Mirror((0,), (2,)), "signs are 1 or -1"),
        (lambda: Part("map", 9), r"'map' has the shape 9; give \(n,\)"),
        (lambda: Part("map", (1, 2, 3)), r"shape \(1, 2, 3\)"),
        (lambda: Part("map", (0,)), r"shape \(0,\)"),
        (lambda: Part("map", (2, 2), mean=(0.0, 1.0)), "has 4 values, but its mean is"),
        (lambda: Part("map", (2,), deviation=np.nan), "one finite number, or a tuple of 2"),
        (lambda: Part("map", (2,), deviation=(1.0, 0.0)), "must be above 0"),
        (lambda: Part("map", (3, 3), mirror=Mirror.of_map(3, 4)), "9 values, .* one of 12"),
        (lambda: Signature(Part("map", (1,)), (CHOICE,)), r"parts are a Part; .* as in \(part,\)"),
        (lambda: Signature((Part("map", (1,)),), ()), r"heads are a tuple; .* as in \(head,\)"),
    ],
)
def test_what_no_policy_could_have_is_refused_by_one_sentence(make, sentence):
    with pytest.raises(InputError, match=sentence) as refusal:
        make()
    assert "\n" not in str(refusal.value)


def test_an_observation_that_lacks_a_part_is_refused():
    signature = Signature((Part("map", (2, 2)), Part("speed", (1,))), (CHOICE,))
    for lacking in ({"map": np.zeros((3, 2, 2))}, np.zeros((3, 5))):
        with pytest.raises(InputError, match="lacks the part speed; give arrays of map, speed"):
            signature.pack(lacking)


def test_parts_are_packed_in_order_and_the_critics_own_are_kept_from_the_actor():
    signature = Signature(
        (
            Part("map", (2, 3), mirror=Mirror.of_map(2, 3)),
            Part("secret", (2,), critic_only=True, mirror=Mirror.of_signs([1.0, 1.0])),
            Part("speed", (1,), mean=1.0, deviation=2.0, mirror=Mirror.of_signs([-1.0])),
        ),
        (CHOICE,),
    )
    shown = {
        "map": np.arange(6.0).reshape(1, 2, 3),
        "secret": np.array([[7.0, 8.0]]),
        "speed": np.array([[9.0]]),
    }
    packed = signature.pack(shown)
    np.testing.assert_array_equal(packed, [[0, 1, 2, 3, 4, 5, 7, 8, 9]])
    np.testing.assert_array_equal(signature.for_actor(packed), [[0, 1, 2, 3, 4, 5, 9]])
    np.testing.assert_array_equal(signature.scaling[1], [1] * 8 + [2])
    image = signature.mirror(jnp.asarray(packed))
    np.testing.assert_array_equal(image, [[2, 1, 0, 5, 4, 3, 7, 8, -9]])
    assert signature.symmetric


def test_names_are_needed_once_each():
    part = Part("twice", (1,))
    with pytest.raises(InputError, match="each one once"):
        Signature((part, part), (CHOICE,))
    with pytest.raises(InputError, match="critic_only"):
        Signature((Part("all", (1,), critic_only=True),), (CHOICE,))
