"""All footsteps from states: one prediction for all commands, then what the map refuses."""

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.footsteps.cost_map import FAR_ENOUGH, FootCostMap
from jaxleas.footsteps.framed_map import FramedMap
from jaxleas.footsteps.limits import Limits
from jaxleas.footsteps.model import MotionModel
from jaxleas.footsteps.plan import REFUSALS, Miss, Refusal
from jaxleas.footsteps.prediction import Prediction
from jaxleas.footsteps.search_states import Children, Node
from jaxleas.types import InputError


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
        self.model, self.controller = model, model.controller
        commands = model.commands()
        self._largest = np.maximum(model.controller.max_speeds, 1e-9)
        shares = np.abs(commands / self._largest).max(axis=1)
        kept = shares <= limits.fastest + 1e-9
        self.commands = commands[kept]
        if not len(self.commands):
            raise InputError(
                f"no command is as slow as {limits.fastest:g} of the largest speed; the slowest is"
                f" {shares.min(initial=1.0):g} of it"
            )
        self._largest_shares = shares[kept]
        self.refused: dict[Refusal, int] = {}
        self.miss: Miss | None = None
        self._map = FramedMap(costs, model.controller.foot_radius)
        self._limits, self._share = limits, 1.0
        self._shares = self.commands / self._largest
        self._prediction = Prediction(model, self.commands)
        self.forget()

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
        found = self._prediction.of(parents)
        lift_offs = np.stack([node.feet for node in parents])[:, swinging]

        is_usual = found.is_known & self._steady(parents)
        kept = self._allowed("unknown motion", np.arange(len(command)), is_usual)
        kept = self._allowed("map", kept, self._map.inside(found.com[kept]))
        distance, height = self._map.at(found.places[kept])
        buffer = self._share * self._map.buffer + self._limits.doubt * parents[0].depth
        short = buffer - distance
        safe = np.all(short < 0, axis=1)
        self._note_miss(short[~safe], found.places[kept[~safe]], swinging)
        kept, near = self._allowed("landing", kept, safe), FAR_ENOUGH - distance[safe]
        height = height[safe]
        rise = np.abs(height - lift_offs[parent[kept], :, 2]).max(axis=1, initial=0.0)
        low = rise <= self.controller.swing_height
        kept, near, height = self._allowed("step height", kept, low), near[low], height[low]
        speed = np.hypot(*found.velocity[kept, :2].T)
        share = self._largest_shares[command[kept]]
        slow = self._limits.slow_enough(rise[low], share, speed, self.controller.max_speeds[0])
        kept, near, height = self._allowed("climbing", kept, slow), near[slow], height[slow]
        landings = np.concatenate([found.places[kept], height[..., None]], axis=-1)
        return Children(
            *(parents, parent[kept], command[kept]),
            *(found.com[kept], found.yaw[kept], found.velocity[kept]),
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

    def _steady(self, parents: list[Node]) -> Bool[np.ndarray, " K"]:
        """Return whether each command from each state goes on from those before steadily enough."""
        before = np.stack([node.command for node in parents]) / self._largest
        earlier = np.stack([node.earlier for node in parents]) / self._largest
        return self._limits.steady(self._shares, before, earlier).ravel()

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
