"""python -m benchmarks.kills.distilling: see tests/robustness/kills/distilling.py."""

import sys

from tests.robustness.kills.distilling import main

if __name__ == "__main__":
    sys.exit(main())
