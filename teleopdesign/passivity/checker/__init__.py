"""Check certificates of passivity: `python checker FILE ...`, Python's library alone.

Prints the statement that a certificate proves, made from its contents, or one line why it proves
nothing; status 1 if any is refused. Texts are read by a small parser (`algebra.py`) and never run;
all numbers are fractions; the effort is bounded (`effort.py`). This folder imports nothing but
Python's standard library: copied elsewhere it checks without the package. Each kind has its
theorem and proof in its file: `storage.py`, `positive_real.py`, `absolute_stability.py`, and for
all values within intervals `over_a_box.py`.
"""

from .check import KINDS, check, load, main, read
from .effort import Refused

__all__ = ["KINDS", "Refused", "check", "load", "main", "read"]
