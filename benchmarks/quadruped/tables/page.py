"""The page of the tables: this project's numbers next to those that the thesis prints."""

from collections.abc import Iterable, Sequence
from typing import Any

from benchmarks.quadruped.tables.printed import SCENARIOS, Runs, Scenario

Measured = dict[str, Any]
"""What was measured of all courses, as `benchmarks/results/quadruped_tables.json` holds it."""
NOTHING = "-"
GROUPS = (("1", "Stairs"), ("2", "Gaps"), ("3", "Waypoints"))
TABLES = {
    "times": {"1": "5.9", "2": "5.14", "3": "5.18"},
    "com": {"1": "5.10", "2": "5.15", "3": "5.19"},
    "feet": {"1": "5.11", "2": "5.16", "3": "5.20"},
    "unsafe": {"1": "5.12", "2": "5.17", "3": "5.21"},
}
"""Numbers of the thesis's tables, by what they show and by group of scenarios."""
FIGURES = {"1": ("5.3", "stairs_3"), "2": ("5.5", "gaps_2"), "3": ("5.7", "waypoints")}
"""The figure of each group, and the course that it shows."""


def page_of(measured: Measured) -> str:
    """Return the page as Markdown.

    Args:
        measured: what was measured of all courses of the thesis.
    """
    sections = [_introduction(measured)]
    for group, title in GROUPS:
        scenarios = [each for each in SCENARIOS if each.number.startswith(group)]
        found = [(each, measured["courses"][each.course]) for each in scenarios]
        number, course = FIGURES[group]
        sections += [
            f"## {title}",
            f"### Table {TABLES['times'][group]}: times of plans\n\n{_times(found)}",
            f"### Table {TABLES['com'][group]}: errors of the centre of mass\n\n{_com(found)}",
            f"### Table {TABLES['feet'][group]}: errors of landings\n\n{_feet(found)}",
            f"### Table {TABLES['unsafe'][group]}: unsafe landings\n\n{_unsafe(found)}",
            f"### Figure {number}: `{course}`\n\n![{_caption(course)}](images/{picture_of(course)})"
            f"\n\n{_caption(course)}.",
        ]
    return "\n\n".join(sections) + "\n"


def picture_of(course: str) -> str:
    """Return the name of the picture of a course."""
    return f"quadruped_{course}.png"


def _caption(course: str) -> str:
    return (
        f"The first judged robot on {course}: predicted (green) and walked (blue) way of the centre"
        " of mass and landings; red is nearer than 1.5 cm to an edge"
    )


def _introduction(measured: Measured) -> str:
    loads = [each["load"] for each in measured["courses"].values()]
    return f"""# The thesis's tables, with this robot

Tables 5.9 to 5.21 and figures 5.3, 5.5 and 5.7 of Ilyass Taouil's thesis (2022), next to what
ANYmal B and the controller `trot` do here ([quadruped.md](quadruped.md)). Robot, controller and
simulator are others, so compare the kind of the numbers. `python -m benchmarks.quadruped.tables`
writes `benchmarks/results/quadruped_tables.json`, this page and its pictures.

The thesis shows three runs from one start. Here {_starts(measured)} robots cross each course, from
starts drawn within 10 cm along, 5 cm across and 5 degrees; errors are means over all of a robot's
footsteps, given as the mean of the robots and, in brackets, the least and the most of them. Blind
means the controller alone, straight ahead, at a share of its largest speed, from the same starts.
Of gaps the thesis gives widths, not places, and of its waypoint course a picture alone: ours are
like them.

Headings are predicted worse here: on level ground already this robot's models are 4 to 5 mrad off,
where the thesis's are 2 off. Landings and the centre of mass are nearer to their predictions.

Left out are the thesis's copy errors: the planner's rows of scenario 2.2 in table 5.17 repeat
scenario 1.2 of table 5.12, and the planner's distances in table 5.21 repeat scenario 2.1 of table
5.17. (Of table 5.8 the columns are exchanged: risers are 4.2, 4.2 and 5 cm high, treads 33.3, 25
and 20 cm deep.)

Machine: {measured["machine"]}; load average after each course {min(loads):g} to {max(loads):g}.
Times are processor times of plans two footsteps ahead, as in the thesis, of all that was asked on
the way; robots here plan eight footsteps ahead. Other programs slowed them down by their use of the
caches: on a machine with nothing else running 99 % of such plans take at most 3.4 ms
([quadruped.md](quadruped.md#walking-to-a-goal))."""


def _starts(measured: Measured) -> int:
    return next(iter(measured["courses"].values()))["starts"]


Found = Sequence[tuple[Scenario, Measured]]


def _times(found: Found) -> str:
    heads = ["", "thesis: mean", "thesis: longest", "here: mean", "here: longest", "plans"]
    rows = []
    for scenario, here in found:
        times = here["times"]
        rows.append(
            [
                *(_name(scenario), _printed(scenario.time_mean, " ms")),
                *(_printed(scenario.time_most, " ms"), f"{times['mean']:.2f} ms"),
                *(f"{times['most']:.2f} ms", str(times["plans"])),
            ]
        )
    return _table(heads, rows)


def _com(found: Found) -> str:
    heads = ["", "thesis: x", "y", "heading", "here: x", "y", "heading"]
    rows = []
    for scenario, here in found:
        rows.append(
            [
                *(_name(scenario), _printed(scenario.com_x, " cm")),
                *(_printed(scenario.com_y, " cm"), _printed(_milli(scenario.yaw), " mrad")),
                *(_ours(here, "com", 0, " cm"), _ours(here, "com", 1, " cm")),
                _ours(here, "com", 2, " mrad", 1000.0),
            ]
        )
    return _table(heads, rows)


def _feet(found: Found) -> str:
    heads = ["", "thesis: x", "y", "here: x", "y"]
    rows = []
    for scenario, here in found:
        rows.append(
            [
                *(_name(scenario), _printed(scenario.foot_x, " cm")),
                _printed(scenario.foot_y, " cm"),
                *(_ours(here, "landing", 0, " cm"), _ours(here, "landing", 1, " cm")),
            ]
        )
    return _table(heads, rows)


def _unsafe(found: Found) -> str:
    """Return the table of unsafe landings: planned, then blind at each speed."""
    heads = [
        *("", "thesis: worst foot", "nearest to an edge"),
        *("here: LF", "RF", "LH", "RH", "nearest to an edge", "at the goal"),
    ]
    rows = []
    for scenario, here in found:
        thesis = [
            f"{bad}/{count}" for bad, count in zip(scenario.unsafe, scenario.landings, strict=False)
        ]
        nearest = _printed(scenario.nearest, " cm")
        name = f"{_name(scenario)}, planned"
        rows.append([name, ", ".join(thesis) or NOTHING, nearest, *_counted(here["planned"])])
        for speed, runs in here["blind"].items():
            printed = scenario.blind[speed]
            star = "" if printed.crossed else " (fails)"
            worst = f"{max(printed.unsafe)}/{printed.landings}{star}"
            rows.append([f"blind at {speed}", worst, NOTHING, *_counted(runs)])
    return _table(heads, rows)


def _counted(runs: Sequence[Measured]) -> list[str]:
    unsafe, landings = (
        [sum(column) for column in zip(*(run[key] for run in runs), strict=True)]
        for key in ("unsafe", "landings")
    )
    nearest = [run["nearest"] for run in runs if run["nearest"] is not None]
    reached = sum(run["outcome"] == "reached" for run in runs)
    return [
        *(f"{bad}/{count}" for bad, count in zip(unsafe, landings, strict=True)),
        f"{min(nearest):.2f} cm" if nearest else NOTHING,
        f"{reached} of {len(runs)}",
    ]


def _ours(here: Measured, key: str, column: int, unit: str, scale: float = 1.0) -> str:
    values = [scale * run[key][column] for run in here["planned"] if run[key] is not None]
    if not values:
        return NOTHING
    mean = sum(values) / len(values)
    return f"{mean:.2f}{unit} ({min(values):.2f} to {max(values):.2f})"


def _printed(runs: Runs, unit: str) -> str:
    return f"{', '.join(f'{each:.2f}' for each in runs)}{unit}" if runs else NOTHING


def _milli(values: Iterable[float]) -> Runs:
    return tuple(1000.0 * each for each in values)


def _name(scenario: Scenario) -> str:
    return f"{scenario.number}, `{scenario.course}`"


def _table(heads: list[str], rows: list[list[str]]) -> str:
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
