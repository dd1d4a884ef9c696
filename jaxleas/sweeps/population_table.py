"""A population's results for a terminal: one row per member, the best first."""

from collections.abc import Sequence

from jaxleas.sweeps.population_config import Members
from jaxleas.sweeps.population_loop import MemberResult
from jaxleas.sweeps.results import shown_param


def population_table(members: Members, results: Sequence[MemberResult]) -> str:
    """Return the table of members: seed, held-out success, and the values at the end."""
    names = list(members.space)
    lines = [["member", "seed", "held out", *names, "run"]]
    order = sorted(range(len(results)), key=lambda i: (bool(results[i].failure), -results[i].best))
    for number in order:
        result = results[number]
        success = result.failure or f"{100 * result.best:.1f} %"
        values = [shown_param(result.values[name]) for name in names]
        seed = str(members.configs[number].seed)
        lines.append([str(number), seed, success, *values, str(result.run)])
    widths = [max(len(line[column]) for line in lines) for column in range(len(lines[0]))]
    return "\n".join(
        "  ".join(text.rjust(width) for text, width in zip(line, widths, strict=True))
        for line in lines
    )
