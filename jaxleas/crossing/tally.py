"""What is counted of a crossing: landings near edges, wrong predictions, time."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from jaxleas.crossing.outcomes import Crossing
from jaxleas.footsteps import UNSAFE, wrapped
from jaxleas.terrain import SceneEdges
from jaxleas.types import ControllerIdentity


@dataclass(frozen=True, eq=False)
class Tally:
    """Counts of one crossing, or of several together.

    Attributes:
        feet: names of the feet.
        landings: number of landings of each foot.
        unsafe: number of those nearer than `UNSAFE` to an edge of the true scene.
        nearest: least distance of each foot's landings from an edge [m].
        footsteps: number of footsteps.
        wrong_pairs: number in which another pair swung than was expected.
        unclear: number in which not just one pair swung.
        landing_errors: distances of landings from where they were planned, along x and y [m].
        pose_errors: those of the centre of mass, x and y [m], and of the heading [rad].
        seconds: times of decisions [s].
    """

    feet: tuple[str, ...]
    landings: Int[np.ndarray, " E"]
    unsafe: Int[np.ndarray, " E"]
    nearest: Float[np.ndarray, " E"]
    footsteps: int
    wrong_pairs: int
    unclear: int
    landing_errors: Float[np.ndarray, "L 2"]
    pose_errors: Float[np.ndarray, "P 3"]
    seconds: Float[np.ndarray, " D"]

    @property
    def unsafe_share(self) -> Float[np.ndarray, " E"]:
        """Unsafe landings of each foot, of all of its landings [%]."""
        return 100.0 * self.unsafe / np.maximum(self.landings, 1)

    @property
    def wrong_share(self) -> float:
        """Footsteps in which another pair swung than was expected [%]."""
        return 100.0 * self.wrong_pairs / max(self.footsteps, 1)

    @property
    def errors(self) -> Float[np.ndarray, " L"]:
        """Distances of landings from where they were planned [m]."""
        return np.hypot(*self.landing_errors.T)

    def in_words(self) -> str:
        """Return the counts as lines of text."""
        unsafe = ", ".join(
            f"{name} {bad} of {count}"
            for name, bad, count in zip(self.feet, self.unsafe, self.landings, strict=True)
        )
        lines = [
            f"{self.footsteps} footsteps; landings less than {100 * UNSAFE:g} cm from an edge:"
            f" {unsafe}",
            f"wrong pair expected: {self.wrong_share:.1f} %; not one pair alone swung:"
            f" {self.unclear} times",
        ]
        if len(self.errors):
            median, most = 100.0 * np.quantile(self.errors, (0.5, 0.95))
            lines.append(
                f"landings from their plan: median {median:.1f} cm, 95 % within {most:.1f} cm"
            )
            lines.append(self._means())
        if len(self.seconds):
            median, most = 1000.0 * np.quantile(self.seconds, (0.5, 0.99))
            lines.append(
                f"{len(self.seconds)} decisions: median {median:.1f} ms, 99 % within {most:.1f} ms"
            )
        return "\n".join(lines)

    def _means(self) -> str:
        """Return the mean absolute errors, as tables 5.10 and 5.11 of Taouil's thesis have them."""
        x, y, yaw = self.pose_errors.mean(axis=0)
        foot_x, foot_y = 100.0 * self.landing_errors.mean(axis=0)
        return (
            f"mean errors: centre of mass {100 * x:.2f} cm in x, {100 * y:.2f} cm in y, heading"
            f" {1000 * yaw:.1f} mrad; landings {foot_x:.2f} cm in x, {foot_y:.2f} cm in y"
        )


def tally(crossing: Crossing, edges: SceneEdges, controller: ControllerIdentity) -> Tally:
    """Return what is counted of a crossing.

    Where not one pair alone swung, the landings are those of the pair that was expected.

    Args:
        crossing: footsteps, and how it ended.
        edges: edges of the true scene.
        controller: identity of the controller that walked.
    """
    feet = len(controller.feet)
    landings, unsafe = np.zeros(feet, dtype=np.int64), np.zeros(feet, dtype=np.int64)
    nearest = np.full(feet, np.inf)
    landing_errors, pose_errors = [np.empty((0, 2))], [np.empty((0, 3))]
    for each in crossing.footsteps:
        swung = list(controller.pairs[each.expected if each.pair is None else each.pair])
        away = edges.distance(each.feet[swung, :2])
        landings[swung] += 1
        unsafe[swung] += away < UNSAFE
        nearest[swung] = np.minimum(nearest[swung], away)
        if each.planned is not None and each.planned.pair == each.pair:
            landing_errors.append(np.abs(each.planned.feet - each.feet)[swung, :2])
            moved = each.planned.com - each.com[:2]
            turned = float(wrapped(np.asarray(each.planned.yaw - each.yaw)))
            pose_errors.append(np.abs([[*moved, turned]]))
    pairs = [(each.pair, each.expected) for each in crossing.footsteps]
    return Tally(
        *(controller.feet, landings, unsafe, nearest, len(pairs)),
        wrong_pairs=sum(pair not in (None, expected) for pair, expected in pairs),
        unclear=sum(pair is None for pair, _ in pairs),
        landing_errors=np.concatenate(landing_errors),
        pose_errors=np.concatenate(pose_errors),
        seconds=np.array(crossing.seconds),
    )


def together(tallies: list[Tally]) -> Tally:
    """Return the counts of several crossings of one controller as those of one."""
    return Tally(
        feet=tallies[0].feet,
        landings=np.sum([each.landings for each in tallies], axis=0),
        unsafe=np.sum([each.unsafe for each in tallies], axis=0),
        nearest=np.min([each.nearest for each in tallies], axis=0),
        footsteps=sum(each.footsteps for each in tallies),
        wrong_pairs=sum(each.wrong_pairs for each in tallies),
        unclear=sum(each.unclear for each in tallies),
        landing_errors=np.concatenate([each.landing_errors for each in tallies]),
        pose_errors=np.concatenate([each.pose_errors for each in tallies]),
        seconds=np.concatenate([each.seconds for each in tallies]),
    )
