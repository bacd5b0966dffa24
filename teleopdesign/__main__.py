"""`python -m teleopdesign` is the command `teleopdesign`."""

import sys

from .cli import main

if __name__ == "__main__":
    sys.exit(main())
