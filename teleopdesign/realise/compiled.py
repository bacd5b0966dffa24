"""Generated source -> compiled function, kept in a cache folder so that it compiles once a machine.

The file name is a hash of the content; numba keeps its machine code beside it.
"""

from __future__ import annotations

import hashlib
import importlib
import os
import sys
import tempfile
from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path
from threading import Lock
from typing import Any


def cache_folder() -> Path:
    """Where generated kernels are kept: TELEOPDESIGN_CACHE, or the platform's cache folder."""
    if path := os.environ.get("TELEOPDESIGN_CACHE"):
        folder = Path(path)
    else:
        import pooch

        folder = Path(pooch.os_cache("teleopdesign"))
    folder = folder / "kernels"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        folder = Path(tempfile.gettempdir()) / "teleopdesign-kernels"
        folder.mkdir(parents=True, exist_ok=True)
    return folder


_IMPORTING = Lock()


def compiled(source: str, function: str) -> Callable[..., Any]:
    """The function of that name in the source (a module that uses numba), from the cache folder."""
    kernel: Callable[..., Any] = compiled_module(source, function)[function]
    return kernel


@lru_cache(maxsize=256)
def compiled_module(source: str, function: str) -> Mapping[str, Any]:
    """Names of that source, a module that uses numba;  function: main one, in the file's name."""
    digest = hashlib.sha256(source.encode()).hexdigest()[:20]
    folder = cache_folder()
    path = folder / f"teleopdesign_{function}_{digest}.py"
    if not path.is_file():
        # written aside and renamed: two processes may want the same kernel at once
        with tempfile.NamedTemporaryFile(
            "w", dir=path.parent, suffix=".tmp", delete=False, encoding="utf-8"
        ) as file:
            file.write(source)
        Path(file.name).replace(path)
    with _IMPORTING:  # candidates are fitted in threads, and the import system's caches are shared
        if str(folder) not in sys.path:
            sys.path.append(str(folder))  # numba's cache finds the module again by its name
        importlib.invalidate_caches()
        module = importlib.import_module(path.stem)
    return vars(module)
