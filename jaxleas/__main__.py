"""`python -m jaxleas`: the command, where its script is not on the path."""

import sys

from jaxleas.cli import main

if __name__ == "__main__":
    sys.argv[0] = "jaxleas"
    main()
