"""Learned proposals: what they see, how they score, and what is done when they are wrong."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from jaxleas.footsteps import (
    Choices,
    FitSettings,
    FootCostMap,
    FootstepPlanner,
    Goal,
    Proposal,
    ProposalFit,
    ProposalInputs,
    ProposalSession,
    ProposalSight,
    ProposedPlanner,
    SearchSettings,
    agreement,
    fit_motion_models,
    fit_proposal,
    motion_digest,
    node_after,
    read_proposal,
    shipped_model,
    shipped_proposal,
    start_node,
    write_proposal,
)
from jaxleas.footsteps.expansion import Expander
from jaxleas.footsteps.proposal_inputs import AHEAD, CLEAR
from jaxleas.terrain import HeightMap
from jaxleas.types import InputError
from tests.footsteps.made import walked
from tests.footsteps.test_search import CELL, GOAL, costs_of, ground, shaken, standing


@pytest.fixture(scope="module")
def model():
    return fit_motion_models(walked(20, 60, noise=0.001), FitSettings(network=False)).model


def drawn(sizes=(100, 99), layers=(12, 5), seed=0, **known):
    """Return a proposal of drawn weights."""
    rng = np.random.default_rng(seed)
    shapes = {"of_command": (sizes[0], layers[0]), "of_state": (sizes[1], layers[0])}
    shapes |= {"bias": layers[:1], "hidden": layers, "hidden_bias": layers[1:], "last": layers[1:]}
    weights: dict[str, Any] = {
        name: rng.normal(size=shape, scale=0.3).astype(np.float32) for name, shape in shapes.items()
    }
    return Proposal(**known, **weights)


class Favourite:
    """Scores one command above all others."""

    def __init__(self, index):
        self.index, self.seen = index, []

    def scores(self, inputs):
        self.seen.append(inputs)
        return 100.0 * np.eye(len(inputs.commands))[self.index]


def sees(model, costs, state, goal):
    sight = ProposalSight(model, costs, model.commands())
    return sight.of(start_node(state, costs), goal)


def test_onnxruntime_scores_as_numpy_does(model):
    state, costs = shaken(2)
    inputs = sees(model, costs, state, GOAL)
    sizes = inputs.commands.shape[1], len(inputs.state)
    proposal = drawn(sizes, controller=model.controller, motion="")
    one_by_one = []
    for row in inputs.commands:  # the formula, without matrices
        first = [
            max(0.0, float(row @ a + inputs.state @ b + c))
            for a, b, c in zip(
                proposal.of_command.T, proposal.of_state.T, proposal.bias, strict=True
            )
        ]
        second = [
            max(0.0, float(np.dot(first, column) + bias))
            for column, bias in zip(proposal.hidden.T, proposal.hidden_bias, strict=True)
        ]
        one_by_one.append(float(np.dot(second, proposal.last)))
    np.testing.assert_allclose(proposal.scores(inputs), one_by_one, rtol=1e-4, atol=1e-4)
    np.testing.assert_allclose(
        ProposalSession(proposal).scores(inputs), one_by_one, rtol=1e-4, atol=1e-4
    )


@pytest.mark.parametrize("yaw", [0.9, -2.5])
def test_the_world_may_be_turned(model, yaw):
    """On level ground far from borders only the goal's place in the robot's frame matters."""
    costs = costs_of(HeightMap(np.zeros((400, 400), np.float32), CELL, (-4.0, -4.0)))
    cos, sin = np.cos(yaw), np.sin(yaw)
    goal = Goal(0.7 * cos - 0.2 * sin, 0.7 * sin + 0.2 * cos, yaw + 0.3)
    turned = sees(model, costs, standing(yaw=yaw), goal)
    ahead = sees(model, costs, standing(), Goal(0.7, 0.2, 0.3))
    np.testing.assert_allclose(turned.commands, ahead.commands, atol=2e-4)
    np.testing.assert_allclose(turned.state, ahead.state, atol=2e-4)


def test_left_and_right_may_be_exchanged(model):
    """With the other pair swinging in a mirrored world, the same is seen of mirrored commands."""
    heights = np.zeros((201, 401), np.float32)
    heights[130:, 220:] = 0.04
    here, there = (
        costs_of(HeightMap(each, CELL, (-4.0, -2.0))) for each in (heights, heights[::-1].copy())
    )
    commands = model.commands()
    mirrored = commands * (1.0, -1.0, -1.0)
    match = np.abs(commands[:, None] - mirrored[None]).sum(axis=2).argmin(axis=1)
    first = sees(model, here, standing(y=0.003, pair=0), Goal(0.9, 0.2, 0.4))
    second = sees(model, there, standing(y=-0.003, pair=1), Goal(0.9, -0.2, -0.4))
    # The two pairs' models are fitted apart, and a foot may be seen in the next cell.
    apart = np.abs(first.commands - second.commands[match])
    assert np.quantile(apart, 0.95) < 0.05
    assert np.quantile(np.abs(first.state - second.state), 0.95) < 0.05


def test_where_commands_lead_is_seen_as_the_search_has_it(model):
    state, costs = shaken(2)
    node = start_node(state, costs)
    inputs = sees(model, costs, state, GOAL)
    children = Expander(model, costs).children([node])
    under = int(np.flatnonzero(np.abs(AHEAD) < 1e-9)[0])
    looks = inputs.commands[children.command, -76:].reshape(-1, 2, 2, 19)  # the last columns
    height_map = costs.height_map
    cells = np.floor((children.landings[..., :2] - height_map.origin) / CELL + 0.5).astype(int)
    distance = np.minimum(costs.distance[cells[..., 1], cells[..., 0]], CLEAR) / CLEAR
    assert len(distance) > 10
    np.testing.assert_allclose(looks[:, :, 0, under], distance, atol=1e-6)


def test_a_safe_proposal_is_taken(model):
    costs, state = costs_of(ground()), standing()
    commands = model.commands()
    slow = int(np.abs(commands - (0.08, 0.0, 0.0)).sum(axis=1).argmin())
    planner = ProposedPlanner(Favourite(slow), model, costs)
    plan = planner.plan(state, GOAL)
    assert len(plan.footsteps) == 1
    np.testing.assert_array_equal(plan.command, commands[slow])
    assert (planner.asked, planner.searched) == (1, 0)
    node = start_node(state, costs)
    after = node_after(model, node, plan.footsteps[0])
    expected = Expander(model, costs)
    children = expected.children([node])
    row = int(np.flatnonzero(children.command == slow)[0])
    np.testing.assert_allclose(after.velocity, children.velocity[row])
    assert after.pair == 1


def test_the_planner_is_asked_where_the_proposal_is_not_safe(model):
    """The ground ends before the front feet: whatever leads ahead is refused."""
    costs, state = costs_of(ground(gaps=[(0.42, 3.0)])), standing()
    commands = model.commands()
    fast = int(commands[:, 0].argmax())
    planner = ProposedPlanner(Favourite(fast), model, costs, SearchSettings(1))
    plan = planner.plan(state, GOAL)
    assert (planner.asked, planner.searched) == (1, 1)
    assert "searched for 1 (100.0 %): 0 unsure, 1 not safe" in planner.in_words()
    searched = FootstepPlanner(model, costs, SearchSettings(1)).plan(state, GOAL)
    np.testing.assert_array_equal(plan.command, searched.command)
    bare = ProposedPlanner(Favourite(fast), model, costs, sure=None)
    np.testing.assert_array_equal(bare.plan(state, GOAL).command, commands[fast])


def test_the_planner_is_asked_where_the_proposal_leads_nowhere(model):
    """The first landing at full speed is on the ground, the next ones are all beyond its end."""
    fast = np.array([0.8, 0.0, 0.0])
    state = replace(standing(), command=fast, com_velocity=fast)
    chosen = int(model.commands()[:, 0].argmax())
    for end, searched in ((0.8, 1), (2.5, 0)):
        costs, settings = costs_of(ground(gaps=[(end, 3.0)])), SearchSettings(1, jump=0.2)
        assert chosen in Expander(model, costs).children([start_node(state, costs)]).command
        planner = ProposedPlanner(Favourite(chosen), model, costs, settings)
        planner.plan(state, GOAL)
        assert (planner.unsure, planner.searched) == (0, searched)


def test_the_planner_is_asked_where_the_proposal_is_unsure(model):
    """Two commands of equal score have a probability of a half each."""

    class Torn(Favourite):
        def scores(self, inputs):
            scores = super().scores(inputs)
            scores[self.index - 1] = scores[self.index]
            return scores

    costs, settings = costs_of(ground()), SearchSettings(1)
    slow = int(np.abs(model.commands() - (0.16, 0.0, 0.0)).sum(axis=1).argmin())
    for sure, unsure in ((0.49, 0), (0.51, 1)):
        planner = ProposedPlanner(Torn(slow), model, costs, settings, sure)
        planner.plan(standing(), GOAL)
        assert (planner.unsure, planner.searched) == (unsure, unsure)


def test_at_the_goal_nothing_is_proposed(model):
    scorer = Favourite(0)
    planner = ProposedPlanner(scorer, model, costs_of(ground()))
    plan = planner.plan(standing(), Goal(0.01, 0.0))
    assert (plan.status, plan.footsteps, scorer.seen) == ("reached", (), [])
    with pytest.raises(InputError, match="outside the map"):
        planner.plan(standing(), Goal(50.0, 0.0))


def test_a_rule_is_learned(model):
    """The command whose first column, less its third, is the largest is always chosen."""
    rng = np.random.default_rng(0)
    seen = rng.normal(size=(900, 7, 4)).astype(np.float16)
    state = np.column_stack([rng.normal(size=900), np.ones(900)]).astype(np.float32)
    chosen = (seen[..., 0] - seen[..., 2]).argmax(axis=1)
    kept, others = Choices(seen[:600], state[:600], chosen[:600]), slice(600, None)
    losses = []
    settings = ProposalFit(epochs=15, batch=50, rate=1e-2, hidden=(16, 8))
    proposal = fit_proposal(kept, model, settings, lambda _, loss: losses.append(loss))
    assert len(losses) == 15
    assert losses[-1] < 0.3 * losses[0]
    assert agreement(proposal, Choices(seen[others], state[others], chosen[others])) > 0.9
    row = ProposalInputs(seen[-1].astype(np.float32), state[-1])
    assert int(proposal.scores(row).argmax()) == chosen[-1]


def test_a_file_holds_a_proposal(model, tmp_path):
    file = tmp_path / "proposal.npz"
    motion = motion_digest(model)
    made = drawn(controller=model.controller, motion=motion, provenance={"rounds": []})
    write_proposal(file, made)
    found = read_proposal(file)
    np.testing.assert_array_equal(found.hidden, made.hidden)
    assert found.controller == model.controller
    found.require_fits(model, str(file))
    quick = replace(model, controller=replace(model.controller, name="other"))
    with pytest.raises(InputError, match=r"another controller than the walk: name: made up"):
        found.require_fits(quick, str(file))
    others = replace(model, weights=tuple(1.01 * each for each in model.weights))
    with pytest.raises(InputError, match="other motion models of made up"):
        found.require_fits(others, str(file))


def test_a_damaged_proposal_is_refused(model, tmp_path):
    file = tmp_path / "proposal.npz"
    made = drawn(controller=model.controller, motion="")
    write_proposal(file, made)
    with np.load(file) as arrays:
        known = dict(arrays)
    known["last"] = known["last"][:-1]
    np.savez(file, **known)
    with pytest.raises(InputError, match=r"proposal\.npz: a proposal's last has shape"):
        read_proposal(file)
    known["last"] = known["last"][:, None]
    np.savez(file, **known)
    with pytest.raises(InputError, match="last must hold floats in 1 dimensions"):
        read_proposal(file)


def test_the_shipped_proposal_is_of_the_shipped_models():
    from jaxleas.controllers import find_controller
    from jaxleas.physics import load_body

    model = shipped_model(find_controller("trot", load_body("anymal_b")).identity)
    proposal = shipped_proposal(model.controller)
    proposal.require_fits(model, "the package's proposal")
    costs = FootCostMap.of(ground(), 0.03)
    inputs = sees(model, costs, standing(), GOAL)
    assert np.isfinite(proposal.scores(inputs)).all()


def test_no_proposal_is_shipped_for_others(model):
    with pytest.raises(InputError, match="no proposal for controller made up"):
        shipped_proposal(model.controller)


def test_a_gait_of_different_numbers_of_feet_is_refused(model):
    crawl = replace(model.controller, pairs=((0,), (3,), (1, 2)))
    weights = tuple(np.zeros((19, 7 + 2 * len(pair))) for pair in crawl.pairs)
    crawling = replace(model, controller=crawl, weights=weights)
    with pytest.raises(InputError, match=r"different numbers of feet in turn \(LF, RH, RF/LH\)"):
        ProposalSight(crawling, costs_of(ground()), model.commands())
