"""The report of a fit: tables of the thesis with our numbers, every model, and its rivals."""

from collections import Counter
from collections.abc import Iterable

from jaxleas.footsteps.fit_tables import TABLES, Table, score_for
from jaxleas.footsteps.fitting import Fitted
from jaxleas.footsteps.judging import ALL
from jaxleas.footsteps.records import FootstepRecords
from jaxleas.footsteps.scores import Score

NOTHING = "-"


def report_fit(fitted: Fitted, records: FootstepRecords) -> str:
    """Return the report as Markdown.

    Args:
        fitted: motion models and their scores.
        records: footsteps that they were fitted to.
    """
    controller = records.controller
    sections = [
        f"# Motion models of {controller.name} on {controller.robot}",
        _data(records),
        "R2 is a share of the variance [%]; errors are mean absolute errors, of lengths in mm, of"
        " yaws in mrad. Unless said otherwise runs are held out. The thesis held out a fifth of"
        " its footsteps, of another robot and controller: compare the kind of the numbers.",
        *(_thesis_table(table, fitted.scores, controller.pair_names[0]) for table in TABLES),
        "## Every model\n\n" + _every_model(fitted.scores),
        "## By movement\n\n" + _by_movement(fitted),
        "## Landings\n\n" + _landings(fitted),
    ]
    return "\n\n".join(sections) + "\n"


def _data(records: FootstepRecords) -> str:
    steps, controller = records.footsteps, records.controller
    counts = Counter(zip(steps.pair.tolist(), steps.movement.tolist(), strict=True))
    rows = [
        [name, *(str(counts[pair, movement]) for pair in range(len(controller.pairs)))]
        for name in dict.fromkeys(sorted(steps.movement.tolist()))
        for movement in [name]
    ]
    lines = [_table(["footsteps", *controller.pair_names], rows)]
    if records.rejected:
        reasons = ", ".join(f"{count} {reason}" for reason, count in records.rejected.items())
        lines.append(f"Not kept: {reasons}.")
    return "\n\n".join(lines)


def _thesis_table(table: Table, scores: Iterable[Score], pair: str) -> str:
    """Return one table: for each of its two models, the thesis's numbers and ours."""
    what = f"foot {pair.split('/')[0]}" if table.is_foot else f"centre of mass, {pair} swings"
    heads = [f"{column.title}, {whose}" for column in table.columns for whose in ("thesis", "ours")]
    rows = [
        [row]
        + [
            text
            for column in table.columns
            for text in (
                "{} / {}".format(*column.printed[index]),
                _numbers(score_for(scores, table, column, row, pair)),
            )
        ]
        for index, row in enumerate(table.rows)
    ]
    return f"## Table {table.number}: {what}\n\n" + _table(["R2 / error", *heads], rows)


def _every_model(scores: Iterable[Score]) -> str:
    """Return all models: linear C1 to C4, C4 on random footsteps, the table, the network."""
    shown = {
        "C1": ("linear", "C1", "run"),
        "C2": ("linear", "C2", "run"),
        "C3": ("linear", "C3", "run"),
        "C4": ("linear", "C4", "run"),
        "C4, random": ("linear", "C4", "random"),
        "table of means": ("table", "C1", "run"),
        "network": ("network", "C4", "run"),
    }
    found = {
        (each.pair, each.target, each.feet, each.model, each.predictors, each.split): each
        for each in scores
        if each.movement == ALL
    }
    targets = dict.fromkeys(key[:3] for key in found)
    rows = [
        [pair, f"{target} {feet}".strip()]
        + [_numbers(found.get((pair, target, feet, *column))) for column in shown.values()]
        for pair, target, feet in targets
    ]
    return _table(["pair", "R2 / error of", *shown], rows)


def _by_movement(fitted: Fitted) -> str:
    chosen = [
        each
        for each in fitted.scores
        if (each.model, each.predictors, each.split) == ("linear", fitted.model.predictors, "run")
        and each.feet in ("", fitted.model.feet)
    ]
    movements = [name for name in dict.fromkeys(each.movement for each in chosen) if name != ALL]
    found = {(each.pair, each.target, each.movement): each for each in chosen}
    rows = [
        [pair, target, *(_numbers(found.get((pair, target, each))) for each in movements)]
        for pair, target in dict.fromkeys(key[:2] for key in found)
    ]
    return _table(["pair", "R2 / error of", *movements], rows)


def _landings(fitted: Fitted) -> str:
    model = fitted.model
    means = ", ".join(f"{mode} {1000 * each:.2f} mm" for mode, each in fitted.landing.items())
    quantiles = ", ".join(
        f"{float(q):.0%}: {1000 * e:.1f} mm" for q, e in model.errors.landing.items()
    )
    return (
        f"Mean distance of landings from their prediction, put together with the predicted pose:"
        f" {means}. Kept: {model.feet}. Its quantiles: {quantiles}. The second is what"
        " the buffer of a foot cost map adds to 1.5 cm, within which a landing is unsafe."
    )


def _numbers(score: Score | None) -> str:
    if score is None:
        return NOTHING
    r2 = NOTHING if score.r2 is None else f"{score.r2:.2f}"
    return f"{r2} / {score.error:.2f}"


def _table(heads: list[str], rows: list[list[str]]) -> str:
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
