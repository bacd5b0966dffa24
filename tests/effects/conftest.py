"""Lets the tests here import the truth simulator as its own command line does."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "hidden"))
