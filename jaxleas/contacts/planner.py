"""The interface of an exact contact planner: it plans one problem and judges many guides."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from jaxleas.configuration import Strict
from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.settings import PlannerSettings
from jaxleas.terrain import Scene
from jaxleas.types import GuidePath, InputError, Verdict

Measure = Literal["robustness", "undecided", "combinations"]


class PlannerError(RuntimeError):
    """A bug of ours: a plan that fails its certificate, or a solver that gave no answer."""


@dataclass(frozen=True)
class Grain:
    """The amount of work at a time that suits a planner.

    Attributes:
        task: guide paths per task of a worker: enough to walk together, few enough to repeat when a
            worker dies.
        shard: guide paths per verdict file, lost when labelling is interrupted.
        abreast: whether the planner walks guide paths together, and so gains from few large tasks.
    """

    task: int = 8
    shard: int = 16
    abreast: bool = False


@dataclass(frozen=True, eq=False)
class AskedGuide:
    """A guide path along which contacts are to be planned.

    Attributes:
        robot: name of the robot.
        guide: guide path to follow.
        scene: scene to walk on.
    """

    robot: str
    guide: GuidePath
    scene: Scene


@dataclass(frozen=True, eq=False)
class AskedGuides:
    """Guide paths to judge, each over one of several scenes.

    Attributes:
        robot: name of the robot.
        scenes: scenes to walk on.
        paths: guide paths to judge.
        scene_index: index of each path's scene.
        first: number of the first path, for the verdicts.
    """

    robot: str
    scenes: Sequence[Scene]
    paths: Sequence[GuidePath]
    scene_index: Sequence[int]
    first: int = 0

    def __iter__(self) -> Iterator[tuple[int, Scene, GuidePath]]:
        """Yield number, scene and guide path."""
        for number, (path, index) in enumerate(zip(self.paths, self.scene_index, strict=True)):
            yield self.first + number, self.scenes[index], path


class Planner(ABC):
    """An exact contact planner; `contacts.registry` gives each its name.

    Attributes:
        title: title in tables and pictures; the name where empty.
        settings: class of the settings for judging guide paths; its `keep_every` says which
            configurations count.
        plan_settings: class of the settings of a single plan.
        needs: whether it plans for a contact problem, or for a guide path over a scene.
        grain: amount of work at a time that suits it.
        measures: measures that its verdicts report besides success and steps.
        in_thesis: whether it judges by default where the thesis's suite is walked.
        name: name in the registry, or MODULE:CLASS.
    """

    title: ClassVar[str] = ""
    settings: type[PlannerSettings]
    plan_settings: type[Strict] = Strict
    needs: ClassVar[Literal["problem", "guide"]] = "guide"
    grain: ClassVar[Grain] = Grain()
    measures: ClassVar[frozenset[Measure]] = frozenset()
    in_thesis: ClassVar[bool] = True

    def __init__(self, name: str) -> None:
        self.name = name

    @property
    def source(self) -> type:
        """The class whose source file defines the planner's behaviour."""
        return type(self)

    @abstractmethod
    def judge(self, asked: AskedGuides, settings: Any) -> list[Verdict]:
        """Judge guide paths.

        Args:
            asked: guide paths, each over its scene.
            settings: instance of `settings`.

        Returns:
            Verdicts in the order of the paths, each with its number.
        """

    def plan(
        self,
        asked: Any,
        settings: Any,
        *,
        time_limit: float,
        diagnose: bool = True,
    ) -> ContactPlan:
        """Plan contacts once, and certify them.

        Args:
            asked: `ContactProblem` or `AskedGuide`, according to `needs`.
            settings: instance of `plan_settings`.
            time_limit: time after which the status is "time_limit" [s].
            diagnose: whether to find out what stops a plan that does not exist.

        Raises:
            InputError: the planner judges only.
        """
        raise InputError(
            f"the planner {self.name} judges guide paths and writes no plans: use jaxleas label"
        )


def require_time_limit(time_limit: float) -> None:
    """Refuse a time limit that is not a positive number of seconds."""
    if not time_limit > 0.0:
        raise InputError(f"time limit {time_limit} must be a positive number of seconds")


def mean_step(path: GuidePath, last_index: int, steps: int) -> float | None:
    """Return the root's path length per step, up to a configuration [m]; None without a step."""
    if steps < 1:
        return None
    return path[: last_index + 1].length / steps
