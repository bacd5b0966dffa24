"""The command `python -m teleopdesign.passivity.checker FILE ...`; of a copy: `python checker`."""

import sys
from importlib import import_module
from pathlib import Path

FOLDER = Path(__file__).resolve().parent

if __name__ == "__main__":
    if not __package__:  # run by its path: Python then knows no package around this file
        sys.path[0] = str(FOLDER.parent)
    sys.exit(import_module(__package__ or FOLDER.name).main(sys.argv[1:]))
