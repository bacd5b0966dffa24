"""The command `teleopdesign`; each of its commands is a file of the folder `commands`.

Ctrl-C at any moment ends the command in one line and with status 130. Modules that take time to
import are imported within `main`, where Ctrl-C is handled.
"""

from __future__ import annotations

import gc
import sys
import threading
from typing import TYPE_CHECKING

from .commands import STOPPED
from .commands._ctrl_c import end_at_once, hear_ctrl_c, tell_of_stop

if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence

#: new objects after which Python's garbage collector looks for unused cycles. The objects of a
#: command live to its end, and with Python's 700 the collector took 3 % of the time of a diagnosis
CIRCLES_SOUGHT = 10_000
#: such collections after which older objects are looked through too: not within a short command. A
#: diagnosis keeps what it makes, 600 000 objects, and finds no memory to free among them
COLLECTIONS_OF_NEW = 100


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns the exit status.

    arguments: words of the command line; None: those of the process. The process then does nothing
        more after this function: from here on Ctrl-C ends it at once, with this status

    0: done; 2: bad input, or a file that cannot be read or written (one line says which); 70: a
    mistake of the package (one line says where); 130: stopped
    """
    request = threading.Event()
    is_heard = arguments is None and hear_ctrl_c(request)
    if arguments is None:
        gc.set_threshold(CIRCLES_SOUGHT, COLLECTIONS_OF_NEW)
    status = 1  # of Python, where something is raised that is not named here
    try:
        from .commands._command_line import run

        status = run(arguments, request.is_set)
    except KeyboardInterrupt:
        status = STOPPED
        if is_heard:
            end_at_once(status)
        tell_of_stop()
    except SystemExit as end:  # help was shown, or a wrong argument refused
        status = end.code if isinstance(end.code, int) else 0
        raise
    finally:
        if is_heard:
            end_at_once(status)
    return status


def _parser() -> argparse.ArgumentParser:
    from .commands._command_line import parser

    return parser()


if __name__ == "__main__":
    sys.exit(main())
