"""The function behind `jaxleas gait distill`."""

import sys
from dataclasses import asdict
from pathlib import Path

from jaxleas.configuration import Allow
from jaxleas.controllers import DEFAULT_CONTROLLER, TICK, ControllerName, find_controller
from jaxleas.crossing.distill_rounds import DistillSettings
from jaxleas.crossing.distilling import Distillation, with_provenance
from jaxleas.crossing.lesson_walk import School
from jaxleas.crossing.walk_planner import model_of
from jaxleas.crossing.walk_settings import WalkSettings
from jaxleas.files import FolderLock, write_bytes
from jaxleas.footsteps import build_proposal_onnx, write_proposal
from jaxleas.physics import DEFAULT_BODY, load_body
from jaxleas.runs import Progress, collect_provenance
from jaxleas.types import InputError

PROPOSAL, GRAPH = "proposal.npz", "proposal.onnx"


def distill(
    *,
    out: Path,
    controller: ControllerName = DEFAULT_CONTROLLER,
    robot: str = DEFAULT_BODY,
    models: Path | None = None,
    settings: DistillSettings = DistillSettings(),  # noqa: B008  # its fields are options
    allow: Allow = (),
) -> None:
    """Teach a network which command the footstep planner would choose.

    At first the planner walks, and its choices on drawn stairs, gaps and blocks are learned. Then
    the proposal walks, the planner says what it would have chosen, and that is learned, too. The
    same command continues where it was interrupted.

    Args:
        out: folder of the proposal (proposal.npz, and proposal.onnx for other programs).
        controller: controller that walks.
        robot: robot that walks, or its MJCF file (.xml).
        models: motion models of the controller; by default those of the package.
        settings: how much is asked, and how it is learned.
        allow: controller of your own that may be run.
    """
    body = load_body(robot)
    walker = find_controller(controller, body, (controller, *allow))
    model = model_of(models, walker)
    walk = WalkSettings(seconds=settings.seconds)
    school = School(body, walker, model, walk, settings.robots, settings.share)
    ticks = round(walk.seconds / TICK)
    total = settings.lessons + settings.rounds * settings.more
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot make the folder {out}: {error.strerror or error}") from error
    with (
        FolderLock(out, "the folder of the proposal", "give another --out"),
        Progress(total * ticks) as progress,
    ):
        shown = _Shown(progress, ticks)
        proposal, rounds = Distillation(out, school, settings, shown, progress.say).run()
        origin = {
            "settings": asdict(settings),
            "walk": asdict(walk),
            **collect_provenance(sys.argv)[0],
        }
        proposal = with_provenance(proposal, rounds, origin)
        write_proposal(out / PROPOSAL, proposal)
        write_bytes(out / GRAPH, build_proposal_onnx(proposal))
    print(f"written to {out / PROPOSAL}, and for other programs to {out / GRAPH}")


class _Shown:
    """Shows how far lessons have come."""

    def __init__(self, progress: Progress, ticks: int) -> None:
        self._progress, self._ticks = progress, ticks
        self._lesson, self._tick = -1, 0

    def __call__(self, lesson: int) -> None:
        if lesson != self._lesson:
            self._lesson, self._tick = lesson, 0
        self._tick += 1
        if self._tick % _EVERY == 0:
            done = lesson * self._ticks + self._tick
            self._progress.update(done, {"lesson": str(lesson + 1)})


_EVERY = 125
"""Ticks between two updates of the progress."""
