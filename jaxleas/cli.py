"""The `jaxleas` command: finds a room's function, and makes its options from its signature.

A room is imported only when one of its commands is called: `jaxleas --help` loads no JAX. argparse
rather than tyro, which would have to import every room to show that help.
"""

import argparse
import difflib
import re
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any, NoReturn

from jaxleas.cli_guard import UsageError, run_guarded
from jaxleas.cli_options import add_options, arguments_of, takes_further
from jaxleas.runs import interrupts_deferred

# Command -> (the room's module, its function, its purpose).
COMMANDS = {
    "train": ("jaxleas.train_command", "train", "train, judge, export and document a policy"),
    "terrain show": ("jaxleas.terrain.commands", "show", "draw a terrain as a picture"),
    "terrain convert": (
        "jaxleas.terrain.commands",
        "convert",
        "write a terrain as another kind of file",
    ),
    "terrain surfaces": (
        "jaxleas.terrain.commands",
        "surfaces",
        "find the planar surfaces of a height map",
    ),
    "terrain generate": ("jaxleas.terrain.commands", "generate", "write a random arena"),
    "terrain scenario": ("jaxleas.terrain.commands", "scenario", "write a named scenario"),
    "robot make": ("jaxleas.modelling.commands", "make", "make a robot's file from its URDF"),
    "evaluate": ("jaxleas.reports.commands", "evaluate", "judge a policy on terrain it never saw"),
    "rollout": ("jaxleas.guide.commands", "rollout", "walk a policy on any terrain"),
    "navigate": (
        "jaxleas.guide.navigation_command",
        "navigate",
        "find a guide path through waypoints",
    ),
    "export": (
        "jaxleas.export.commands",
        "export",
        "export a policy as ONNX and StableHLO",
    ),
    "plan": ("jaxleas.contacts.commands", "plan", "plan the contacts of a problem file"),
    "check": ("jaxleas.contacts.check_command", "check", "certify a contact plan, in metres"),
    "contacts": ("jaxleas.contacts.commands", "contacts", "plan contacts along a guide path"),
    "contacts export": (
        "jaxleas.contacts.sequence.commands",
        "export",
        "write a contact plan for other programs",
    ),
    "transition check": (
        "jaxleas.dynamics.croc.commands",
        "check",
        "say whether a robot can cross from one support to the next",
    ),
    "label": ("jaxleas.labels.commands", "label", "judge guide paths by an exact planner"),
    "fit": ("jaxleas.surrogates.commands", "fit", "fit a surrogate of a planner to its labels"),
    "distill": (
        "jaxleas.distillation.commands",
        "distill",
        "train a policy that knows its planner",
    ),
    "gait collect": (
        "jaxleas.footsteps.collect_command",
        "collect",
        "walk a controller in physics, and collect its footsteps",
    ),
    "gait fit": (
        "jaxleas.footsteps.fit_command",
        "fit",
        "fit motion models to a controller's footsteps",
    ),
    "gait footsteps": (
        "jaxleas.footsteps.plan_command",
        "plan",
        "plan the next footsteps of a controller",
    ),
    "gait imitate": (
        "jaxleas.gaits.imitate_command",
        "imitate",
        "teach a gait policy what the search does, to begin a training with",
    ),
    "gait plan": (
        "jaxleas.gaits.plan_command",
        "plan",
        "plan a quadruped's support phases to a goal",
    ),
    "gait track": (
        "jaxleas.crossing.track_command",
        "track",
        "follow a gait plan in physics",
    ),
    "gait distill": (
        "jaxleas.crossing.distill_command",
        "distill",
        "teach a network what the footstep planner would choose",
    ),
    "gait walk": (
        "jaxleas.crossing.walk_command",
        "walk",
        "walk a quadruped to a goal, planned at each contact",
    ),
    "gait course": (
        "jaxleas.crossing.course_command",
        "course",
        "write a course for quadrupeds",
    ),
    "sweep": ("jaxleas.sweeps.commands", "sweep", "search a space of configurations"),
    "population": (
        "jaxleas.sweeps.commands",
        "population",
        "train several policies in one program",
    ),
    "view": (
        "jaxleas.viewer.commands",
        "view",
        "drive policies and play back paths in the browser",
    ),
    "figures": (
        "jaxleas.evaluation.figures_command",
        "figures",
        "measure what the thesis's figures show",
    ),
    "runs": ("jaxleas.records.commands", "runs", "list runs: state, success, configuration"),
    "compare": ("jaxleas.records.commands", "compare", "put runs side by side"),
    "report": ("jaxleas.distillation.commands", "report", "write a run's report as one HTML file"),
}
OTHER_NAMES = {"terrain import": "terrain convert", "terrain export": "terrain convert"}
"""Former names of commands, and names that people look for."""


class _Parser(argparse.ArgumentParser):
    """A parser that reports a mistake in one sentence, and reads `--from -1,2` as one place."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self._negative_number_matcher = re.compile(r"^-\.?\d[\d.,eE+-]*$")

    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{message}; see {self.prog} --help")


def main() -> None:
    """Run the `jaxleas` command."""
    sys.exit(run_guarded(lambda: run(sys.argv[1:])))


def run(arguments: Sequence[str]) -> None:
    """Find the command that `arguments` begin with and call its function.

    Raises:
        UsageError: there is no such command or option, or one that is needed is missing.
        JaxleasError: from the command.
    """
    words = [] if not arguments or arguments[0].startswith("-") else list(arguments[:2])
    name = next(filter(None, (_command(" ".join(words[:n])) for n in (2, 1))), None)
    if name is not None:
        _call(name, arguments[len(name.split()) :])
    elif "--version" in arguments:
        from importlib.metadata import version  # a sixth of the time that --help may take

        print(f"jaxleas {version('jaxleas')}")
    elif not words or _is_group_alone(arguments):
        print(_overview())
    else:
        raise UsageError(_unknown(words))


def _command(words: str) -> str | None:
    """Return the command that words name, if there is one."""
    name = OTHER_NAMES.get(words, words)
    return name if name in COMMANDS else None


def _call(name: str, arguments: Sequence[str]) -> None:
    module, function_name, _ = COMMANDS[name]
    with interrupts_deferred():
        function = getattr(import_module(module), function_name)
    further = takes_further(function)
    parser = _Parser(
        prog=f"jaxleas {name}",
        allow_abbrev=False,  # an abbreviation may mean something else next year
        formatter_class=argparse.RawDescriptionHelpFormatter,
        add_help=not further,
    )
    add_options(parser, function)
    given, unknown = parser.parse_known_args(arguments)
    if further:
        _call_with_further(parser, function, given, unknown)
        return
    if unknown:
        options = [text for action in parser._actions for text in action.option_strings]
        left = [each for each in options if each not in arguments]
        raise UsageError(f"jaxleas {name} {_no(unknown[0], left)}; see jaxleas {name} --help")
    function(**arguments_of(function, given))


def _call_with_further(
    parser: _Parser, function: Callable[..., Any], given: argparse.Namespace, further: list[str]
) -> None:
    """Call a function whose first argument says which further options there are, and their help."""
    (_, first), *others = arguments_of(function, given).items()
    if first is None and {"-h", "--help"} & {*further}:
        parser.print_help()
        return
    function(first, *further, **dict(others))


def _is_group_alone(arguments: Sequence[str]) -> bool:
    group = any(name.startswith(f"{arguments[0]} ") for name in COMMANDS)
    return group and all(word in ("-h", "--help") for word in arguments[1:])


def _overview() -> str:
    lines = [f"  {name:18}{purpose}" for name, (_, _, purpose) in COMMANDS.items()]
    return "\n".join(
        [
            "usage: jaxleas COMMAND ...   (options: jaxleas COMMAND --help)",
            "",
            *lines,
            "",
            "Begin with  jaxleas train leas_p1",
        ]
    )


def _unknown(words: list[str]) -> str:
    """Return a sentence about a command that does not exist, with the nearest that does."""
    groups = {name.split()[0] for name in COMMANDS}
    typed = " ".join(words if words[0] in groups else words[:1])
    close = difflib.get_close_matches(" ".join(words), COMMANDS, n=1) or difflib.get_close_matches(
        words[0], sorted(COMMANDS.keys() | groups), n=1
    )
    meant = f"perhaps you meant '{close[0]}'" if close else f"there are {', '.join(COMMANDS)}"
    return f"there is no command '{typed}'; {meant}"


def _no(word: str, options: list[str]) -> str:
    """Return what is wrong with a word that no option takes, with what was perhaps meant.

    Args:
        word: word of the command line.
        options: options of the command that were not given.
    """
    if not word.startswith("-"):
        meant = f": perhaps you meant --out {word}" if "--out" in options else ""
        return f"takes no further argument '{word}'{meant}"
    close = difflib.get_close_matches(word.partition("=")[0], options, n=1)
    return f"has no {word}" + (f", perhaps you meant {close[0]}" if close else "")


if __name__ == "__main__":
    main()
