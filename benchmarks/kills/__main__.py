"""python -m benchmarks.kills: see tests/robustness/kills."""

import sys

from tests.robustness.kills.__main__ import main

if __name__ == "__main__":
    sys.exit(main())
