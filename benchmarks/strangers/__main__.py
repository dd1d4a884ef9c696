"""python -m benchmarks.strangers: see tests/robustness/hostile_files."""

import sys

from tests.robustness.hostile_files.__main__ import main

if __name__ == "__main__":
    sys.exit(main())
