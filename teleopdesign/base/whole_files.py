"""A user's file, read completely but with limits on waiting time and size.

A pipe that nobody writes into would stop a reader for ever, and a device such as /dev/zero would
fill the memory. A pipe from a shell, `<(command)`, is read like a file.
"""

from __future__ import annotations

import errno
import os
import select
from pathlib import Path

#: most bytes of a file: an answer with all arrays has some MiB, and reading a larger one as JSON
#: would take gigabytes of memory
LARGEST = 1 << 28
#: s without a byte from a pipe that someone holds open
_PATIENCE = 10.0
_BLOCK = 1 << 20


def read_whole(path: str | Path, *, largest: int = LARGEST) -> bytes:
    """The bytes of a file.

    largest: limit on the number of bytes
    raises OSError: as `open` does; more bytes than `largest`; a pipe from which nothing comes
    """
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    blocks, size = list[bytes](), 0
    with open(os.open(path, flags), "rb", buffering=0) as file:
        while (block := _next_block(file.fileno())) and size <= largest:
            blocks.append(block)
            size += len(block)
    if size > largest:
        raise OSError(errno.EFBIG, f"more than {largest >> 20} MiB")
    return b"".join(blocks)


def follow_links(path: Path) -> Path:
    """The path without symbolic links; a link in a ring stays, and is not a file then.

    `Path.resolve` raises RuntimeError there, and OSError from Python 3.13 on.
    """
    return Path(os.path.realpath(path))


def _next_block(file: int) -> bytes:
    while True:
        try:
            return os.read(file, _BLOCK)
        except BlockingIOError:
            if not select.select([file], [], [], _PATIENCE)[0]:
                raise OSError(errno.ETIMEDOUT, f"nothing came for {_PATIENCE:g} s") from None
