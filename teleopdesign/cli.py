"""The command `teleopdesign`; each of its commands is a file of the folder `commands`.

Ctrl-C at any moment ends the command in one line and with status 130; it is handled once, and never
lost. Only the standard library is imported here: what takes time is imported within `main`, where
Ctrl-C is handled.
"""

from __future__ import annotations

import _thread
import atexit
import gc
import os
import signal
import sys
import threading
from contextlib import suppress
from importlib.machinery import ExtensionFileLoader
from typing import TYPE_CHECKING, Any

from .commands import STOPPED

if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence
    from types import FrameType

#: new objects after which Python's garbage collector looks for unused cycles. The objects of a
#: command live to its end, and with Python's 700 the collector took 3 % of the time of a diagnosis
CIRCLES_SOUGHT = 10_000
#: such collections after which older objects are looked through too: not within a short command. A
#: diagnosis keeps what it makes, 600 000 objects, and finds no memory to free among them
COLLECTIONS_OF_NEW = 100


def hear_ctrl_c(request: threading.Event) -> bool:
    """Let Ctrl-C raise KeyboardInterrupt at any moment; returns whether Ctrl-C is handled here.

    Python only prints an exception that nothing can catch (in a `__del__`, in a call from C). Such
    an interrupt is raised again. Code in C may ignore an exception, or abort, while its module is
    imported: Ctrl-C waits until the import is complete.

    request: set by Ctrl-C, since a library may convert the exception into another one
    """
    loader = ExtensionFileLoader
    in_c = {loader.create_module.__code__, loader.exec_module.__code__}

    def interrupt(_: int, frame: FrameType | None) -> None:
        while frame is not None and frame.f_code not in in_c:
            frame = frame.f_back
        if frame is not None:
            interrupt_later(0.01)
            return
        request.set()
        raise KeyboardInterrupt

    def interrupt_later(seconds: float) -> None:
        again = threading.Timer(seconds, _interrupt_main)
        again.daemon = True
        again.start()

    def lost(unraisable: Any) -> None:
        if issubclass(unraisable.exc_type, KeyboardInterrupt):
            # s: once this call is over, and this hook, in which an interrupt would be lost. Both
            # take 0.1 ms, but with 1 ms a busy machine once stayed here for longer than that
            interrupt_later(0.05)
        else:
            sys.__unraisablehook__(unraisable)

    if threading.current_thread() is not threading.main_thread():
        return False
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:  # who asked decides
        return False
    signal.signal(signal.SIGINT, interrupt)
    sys.unraisablehook = lost
    # Python takes its handlers away before it ends; registered first, this is done last
    atexit.register(signal.signal, signal.SIGINT, signal.SIG_IGN)
    return True


def _interrupt_main() -> None:
    """Send the signal of Ctrl-C to the main thread, which also ends a wait of this thread."""
    main = threading.main_thread().ident
    if hasattr(signal, "pthread_kill") and main is not None:
        signal.pthread_kill(main, signal.SIGINT)
    else:  # Windows
        _thread.interrupt_main()


def end_at_once(status: int) -> None:
    """From now on Ctrl-C ends the process without a message: all work is done or reported."""
    leave = os._exit  # names of modules may be gone at the end
    signal.signal(signal.SIGINT, lambda *_: leave(status))


def tell_of_stop() -> None:
    """Print one line that the command was stopped on standard error, if it is still open."""
    with suppress(OSError, ValueError, AttributeError):  # its reader is stopped too, or closed
        print("teleopdesign: stopped", file=sys.stderr)
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
    except (OSError, ValueError):
        from .commands._command_line import close_output

        close_output()


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
