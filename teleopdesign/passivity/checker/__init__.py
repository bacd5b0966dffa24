"""A small program that checks certificates of passivity: `python checker FILE ...`.

For each file the program prints the statement that the certificate proves, or one line that says
why it proves nothing. The statement is made from the contents of the certificate alone. The exit
status is 1 if any certificate is refused. A small parser (`algebra.py`) reads the texts of a
certificate and never runs them. All numbers are fractions. The effort is bounded (`effort.py`). The
folder imports nothing but Python's standard library: a copy checks without the package.

Each kind of certificate has its theorem and its proof in its file: `storage.py`, `matrices.py`, and
`over_a_box.py` for all values within intervals.
"""

from .check import KINDS, check, load, main
from .effort import Refused

__all__ = ["KINDS", "Refused", "check", "load", "main"]
