"""Train a policy: `jaxleas train` for a checkout whose command is not on the path."""

import sys
from collections.abc import Sequence

from jaxleas.cli import run
from jaxleas.cli_guard import run_guarded


def main(arguments: Sequence[str]) -> None:
    """Run `jaxleas train` with the arguments of the command line."""
    run(["train", *arguments])


if __name__ == "__main__":
    sys.exit(run_guarded(lambda: main(sys.argv[1:])))
