"""Ctrl-C at any moment of a command: handled once, never lost, and reported in one line.

Only the standard library is imported here; Ctrl-C is not handled before this module is imported.
"""

from __future__ import annotations

import _thread
import atexit
import os
import signal
import sys
import threading
from contextlib import suppress
from importlib.machinery import ExtensionFileLoader
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from types import FrameType


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
        from ._command_line import close_output

        close_output()
