"""All footsteps from states: one prediction for all commands, then what the map refuses."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.footsteps.cost_map import FAR_ENOUGH, FootCostMap
from jaxleas.footsteps.features import turned
from jaxleas.footsteps.framed_map import FramedMap
from jaxleas.footsteps.model import MOTION, MotionModel
from jaxleas.footsteps.plan import REFUSALS, Miss, Refusal
from jaxleas.footsteps.search_states import Children, Node
from jaxleas.types import InputError

CLIMBS = 0.02
"""Rise or drop of a footstep from which on it climbs [m]."""
STEEP, STEEPER = 0.065, 0.6
"""Rise or drop from which on a footstep is slower still [m], and its speed over that of others."""
SWAYS = 0.5
"""Share of the largest forward speed up to which a robot does not sway, however it changes."""


@dataclass(frozen=True)
class Limits:
    """What footsteps are kept within.

    Attributes:
        fastest: largest speed that is tried, over the controller's largest.
        climbing: largest speed, commanded and afterwards, where a foot steps up or down, over the
            controller's largest.
        doubt: what each footstep before adds to the buffer of a landing [m].
        jump: largest change of the command from one footstep to the next: sum over its parts, each
            over the controller's largest.
        sway: largest difference of two changes of the forward speed in turn, over the controller's
            largest; where it is nowhere above `SWAYS`, any.
    """

    fastest: float = 1.0
    climbing: float = 1.0
    doubt: float = 0.0
    jump: float = np.inf
    sway: float = np.inf


class Expander:
    """Predicts and checks the footsteps of all commands from states, many at a time.

    Args:
        model: motion models.
        costs: foot cost map.
        limits: largest speeds, and how the buffer grows.

    Raises:
        InputError: no command is as slow as that.
    """

    def __init__(
        self,
        model: MotionModel,
        costs: FootCostMap,
        limits: Limits | None = None,
    ) -> None:
        limits = Limits() if limits is None else limits
        fastest, climbing = limits.fastest, limits.climbing
        self.model, self.controller = model, model.controller
        commands = model.commands()
        self._largest = np.maximum(model.controller.max_speeds, 1e-9)
        shares = np.abs(commands / self._largest).max(axis=1)
        kept = shares <= fastest + 1e-9
        self.commands = commands[kept]
        if not len(self.commands):
            raise InputError(
                f"no command is as slow as {fastest:g} of the largest speed; the slowest is"
                f" {shares.min(initial=1.0):g} of it"
            )
        self._largest_shares = shares[kept]
        self._climbing = climbing * model.controller.max_speeds[0] if climbing < 1.0 else np.inf
        self.refused: dict[Refusal, int] = {}
        self.miss: Miss | None = None
        self._map = FramedMap(costs, model.controller.foot_radius)
        self._limits, self._share = limits, 1.0
        self._shares = self.commands / self._largest
        self.forget()
        # The command's share of a prediction is the same in every state.
        self._of_command = [self.commands @ weights[:3] for weights in model.weights]
        self._of_state = [weights[3:] for weights in model.weights]

    def forget(self, share: float = 1.0) -> None:
        """Begin to count refusals anew.

        Args:
            share: share of the buffer that landings keep from now on.
        """
        self._share = share
        self.refused = dict.fromkeys(REFUSALS, 0)
        self.miss = None

    def children(self, parents: list[Node]) -> Children:
        """Return the footsteps that the map allows from states with one pair swinging."""
        swinging = list(self.controller.pairs[parents[0].pair])
        count = len(self.commands)
        parent = np.repeat(np.arange(len(parents)), count)
        command = np.tile(np.arange(count), len(parents))
        com, yaw, velocity, places, is_known = self._predicted(parents, swinging)
        lift_offs = np.stack([node.feet for node in parents])[:, swinging]

        is_known &= self._steady(parents)
        kept = self._allowed("unknown motion", np.arange(len(command)), is_known)
        kept = self._allowed("map", kept, self._map.inside(com[kept]))
        distance, height = self._map.at(places[kept])
        buffer = self._share * self._map.buffer + self._limits.doubt * parents[0].depth
        short = buffer - distance
        safe = np.all(short < 0, axis=1)
        self._note_miss(short[~safe], places[kept[~safe]], swinging)
        kept, near = self._allowed("landing", kept, safe), FAR_ENOUGH - distance[safe]
        height = height[safe]
        rise = np.abs(height - lift_offs[parent[kept], :, 2]).max(axis=1, initial=0.0)
        low = rise <= self.controller.swing_height
        kept, near, height = self._allowed("step height", kept, low), near[low], height[low]
        speed = np.hypot(velocity[kept, 0], velocity[kept, 1])
        slower = np.where((rise[low] > STEEP) & (self._limits.climbing < 1.0), STEEPER, 1.0)
        slow = self._largest_shares[command[kept]] <= slower * self._limits.climbing + 1e-9
        slow &= speed <= slower * self._climbing
        slow |= rise[low] <= CLIMBS
        kept, near, height = self._allowed("climbing", kept, slow), near[slow], height[slow]
        landings = np.concatenate([places[kept], height[..., None]], axis=-1)
        return Children(
            *(parents, parent[kept], command[kept], com[kept], yaw[kept], velocity[kept]),
            *(landings, np.maximum(near, 0.0).sum(axis=1)),
        )

    def swings_clear(
        self, children: Children, rows: Int[np.ndarray, " K"]
    ) -> Bool[np.ndarray, " K"]:
        """Return whether feet pass over the ground in some of the footsteps, not yet asked of them.

        It costs more than all the rest, so that the search asks it of promising footsteps alone.
        """
        swinging = list(self.controller.pairs[children.parents[0].pair])
        feet = [children.parents[parent].feet for parent in children.parent[rows].tolist()]
        lift_offs = np.stack(feet)[:, swinging]
        apex = self.controller.swing_height
        clear = self._map.swings_clear(lift_offs, children.landings[rows], apex)
        self.refused["swing"] += int(len(clear) - clear.sum())
        return clear

    def child(self, children: Children, index: int, spent: float) -> Node:
        """Return one of the children as a state."""
        parent = children.parents[children.parent[index]]
        feet = parent.feet.copy()
        feet[list(self.controller.pairs[parent.pair])] = children.landings[index]
        return Node(
            com=children.com[index],
            yaw=float(children.yaw[index]),
            velocity=children.velocity[index],
            feet=feet,
            pair=(parent.pair + 1) % len(self.controller.pairs),
            command=self.commands[children.command[index]],
            earlier=parent.command,
            spent=spent,
            depth=parent.depth + 1,
            parent=parent,
        )

    def _predicted(self, parents: list[Node], swinging: list[int]) -> tuple[np.ndarray, ...]:
        """Return poses, velocities, landings, and whether such motion is known from the data."""
        pair, count = parents[0].pair, len(self.commands)
        com = np.stack([node.com for node in parents])
        yaw = np.array([node.yaw for node in parents])
        feet = np.stack([node.feet for node in parents])[:, :, :2]
        state = np.column_stack(
            [
                turned(feet - com[:, None], -yaw[:, None]).reshape(len(parents), -1),
                np.stack([node.command for node in parents]),
                np.stack([node.velocity for node in parents]),
                np.ones(len(parents)),
            ]
        )
        outputs = self._of_command[pair] + (state @ self._of_state[pair])[:, None]
        outputs = outputs.reshape(len(parents) * count, -1)
        before = np.repeat(yaw, count)
        shift, turn = outputs[:, :2], outputs[:, 2]
        is_known = (shift**2).sum(axis=1) <= self.model.longest_stride**2
        is_known &= np.abs(turn) <= self.model.largest_turn
        after = np.repeat(com, count, axis=0) + turned(shift, before)
        moved = outputs[:, MOTION:].reshape(len(outputs), -1, 2)
        if self.model.feet == "absolute":
            base = np.repeat(feet[:, swinging], count, axis=0)
            places = base + turned(moved, before[:, None])
        else:
            places = after[:, None] + turned(moved, (before + turn)[:, None])
        return after, before + turn, outputs[:, 3:MOTION], places, is_known

    def _steady(self, parents: list[Node]) -> Bool[np.ndarray, " K"]:
        """Return whether each command from each state goes on from those before steadily enough."""
        before = np.stack([node.command for node in parents]) / self._largest
        earlier = np.stack([node.earlier for node in parents]) / self._largest
        change = self._shares - before[:, None]
        turn = change[..., 0] - (before - earlier)[:, None, 0]
        steady = np.abs(change).sum(axis=2) <= self._limits.jump + 1e-9
        fastest = np.maximum(self._shares[:, 0], np.maximum(before, earlier)[:, :1])
        steady &= (np.abs(turn) <= self._limits.sway + 1e-9) | (fastest <= SWAYS + 1e-9)
        return steady.ravel()

    def _allowed(
        self, reason: Refusal, rows: Int[np.ndarray, " K"], allowed: Bool[np.ndarray, " K"]
    ) -> Int[np.ndarray, " L"]:
        """Return the rows that are allowed; the others are counted."""
        kept = rows[allowed]
        self.refused[reason] += len(rows) - len(kept)
        return kept

    def _note_miss(
        self, short: Float[np.ndarray, "K S"], places: np.ndarray, swinging: list[int]
    ) -> None:
        """Keep the refused landing whose worse foot is the least short of safe."""
        if not len(short):
            return
        worst = short.max(axis=1)
        row = int(worst.argmin())
        if self.miss is None or worst[row] < self.miss.short:
            foot = int(short[row].argmax())
            x, y = places[row, foot]
            name = self.controller.feet[swinging[foot]]
            self.miss = Miss(name, (float(x), float(y)), float(worst[row]))
