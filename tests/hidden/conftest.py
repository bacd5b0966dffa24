"""Lets the tests here import the simulator and the case maker as the command line does."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
