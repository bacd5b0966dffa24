"""python-control enters the package by one file, so that another version of it changes one file."""

import re
from pathlib import Path

import teleopdesign as td

PACKAGE = Path(td.__file__).parent
#: at the beginning of a line or within a function; imports for types alone stand under an `if`
IMPORT = re.compile(r"^(\s*)(?:import control\b|from control[. ])", re.MULTILINE)
FOR_TYPES = re.compile(r"^if TYPE_CHECKING:\n(?:(?:[ \t].*)?\n)+", re.MULTILINE)


def test_one_file_imports_python_control():
    importers = {
        path.relative_to(PACKAGE).as_posix()
        for path in PACKAGE.rglob("*.py")
        if IMPORT.search(FOR_TYPES.sub("", path.read_text(encoding="utf-8")))
    }
    assert importers == {"base/python_control.py"}
