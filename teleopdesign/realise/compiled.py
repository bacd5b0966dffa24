"""Generated source -> compiled function, kept in a cache folder so that it compiles once a machine.

The file name is a hash of the source and of the modules that it imports; numba keeps its machine
code beside it. The source in memory is executed, never the content of the file: numba's cache only
needs the file. Only the user can write to the folder. Where there is no such folder, machine code
is kept for this process, or not at all.

Every source has the same functions of exact integration steps:

    phi_1(z) = (e^z - 1)/z,   phi_2(z) = (phi_1(z) - 1)/z,   phi_3(z) = (phi_2(z) - 1/2)/z

Their derivatives need no other functions: phi_1' = phi_1 - phi_2, phi_2' = phi_2 - 2 phi_3.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import re
import shutil
import stat
import sys
import tempfile
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import lru_cache
from math import factorial
from pathlib import Path
from threading import Lock
from types import ModuleType
from typing import Any
from uuid import uuid4

from ..base.machine import hash_files, without_cache_errors

#: folder of the package, whose functions generated source may import
_PACKAGE = Path(__file__).parents[1]
#: permission bits that allow other users to write
_OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH


def cache_folder() -> Path | None:
    """The folder of generated kernels: in TELEOPDESIGN_CACHE, or the platform's cache folder.

    The folder has mode 0700. If it cannot be written, or belongs to another user or can be written
    by one, it is a temporary folder of this process; None where there is none either.
    A home that does not exist is not made: then nothing should be kept there.
    """
    if path := os.environ.get("TELEOPDESIGN_CACHE"):
        folder = Path(path)
    else:
        import pooch

        folder = Path(pooch.os_cache("teleopdesign"))
        home = Path(os.path.expanduser("~"))
        if folder.is_relative_to(home) and not home.is_dir():
            return _temporary_folder()
    folder = folder / "machine_code"
    return folder if _is_private(folder) else _temporary_folder()


def _is_private(folder: Path) -> bool:
    """Make the folder, and check that it is the user's alone, no link, and can be written."""
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if hasattr(os, "getuid"):  # other systems have lists of access in place of modes
            state = folder.lstat()
            if not stat.S_ISDIR(state.st_mode) or state.st_uid != os.getuid():
                return False
            if stat.S_IMODE(state.st_mode) & 0o077:
                if state.st_mode & _OTHERS_WRITE:
                    return False  # other users could have written the files in this folder
                folder.chmod(0o700)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except (OSError, ValueError):
        return False


@lru_cache(maxsize=1)
def _temporary_folder() -> Path | None:
    try:
        folder = Path(tempfile.mkdtemp(prefix="teleopdesign-kernels-"))  # mode 0700
    except OSError:
        return None
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


_EXECUTING = Lock()


def compile_source(source: str, function: str) -> Callable[..., Any]:
    """The function of this name in the source (a module that uses numba), from the cache folder."""
    kernel: Callable[..., Any] = compiled_module(source, function)[function]
    return kernel


@lru_cache(maxsize=256)
def compiled_module(source: str, function: str) -> Mapping[str, Any]:
    """Names in this source, a module that uses numba.

    function: name of its main function, for the name of the file
    """
    imported = re.findall(r"^from teleopdesign\.([\w.]+) import", source, re.M)
    files = [_PACKAGE.joinpath(*module.split(".")).with_suffix(".py") for module in imported]
    digest = hashlib.sha256((source + hash_files(files)).encode()).hexdigest()[:20]
    name = f"teleopdesign_{function}_{digest}"
    folder = cache_folder()
    path = None if folder is None else folder / f"{name}.py"
    if path is not None and not _holds(path, source):
        path = None
    with _EXECUTING:  # candidates are fitted in threads; numba's cache finds the module by its name
        if path is not None:
            with suppress(RuntimeError):  # numba has no folder for machine code
                return _names(source, name, str(path))
        return _names(source.replace("cache=True", "cache=False"), name, f"<{name}>")


def _names(source: str, name: str, file: str) -> dict[str, Any]:
    module = ModuleType(name)
    module.__file__ = file
    sys.modules[name] = module
    exec(compile(source, file, "exec"), vars(module))
    for value in vars(module).values():
        without_cache_errors(value)
    return vars(module)


def _holds(path: Path, source: str) -> bool:
    """Whether the file holds the source, after it was written where it did not."""
    content = source.encode()
    try:
        if path.is_file() and path.read_bytes() == content:
            return True
        # written aside and renamed: two processes may want the same kernel at once
        part = path.with_name(f".{uuid4().hex[:8]}.{path.name}")
        try:
            part.write_bytes(content)
            part.replace(path)
        finally:
            with suppress(OSError):
                part.unlink()
        return True
    except OSError:
        return False


#: terms of the series of phi_3 within abs(z) < 1: the first one left out is 2e-16 of it
_TERMS = 13


def _series() -> str:
    text = f"1 / {float(factorial(_TERMS + 2)):.1f}"
    for k in range(_TERMS - 2, -1, -1):
        text = f"1 / {float(factorial(k + 3)):.1f} + z * ({text})"
    return text


#: source of `phi`, for use after a line that defines `jitted`
PHI = f'''
@jitted
def phi_near(z):
    """exp, phi_1, phi_2, phi_3 of z by their series, within abs(z) < 1."""
    p3 = {_series()}
    p2 = z * p3 + 0.5
    p1 = z * p2 + 1.0
    return z * p1 + 1.0, p1, p2, p3


@jitted
def phi(z):
    """exp, phi_1, phi_2, phi_3 of z, accurate through zero."""
    if abs(z) < 1.0:
        return phi_near(z)
    e = exp(z)
    p1 = (e - 1.0) / z
    p2 = (p1 - 1.0) / z
    return e, p1, p2, (p2 - 0.5) / z
'''
#: source of `weights`, for use after `phi`
WEIGHTS = '''
@jitted
def weights(z, is_near):
    """exp and phi_1 of z/2, exp of z, and the three weights of a step;  is_near: abs(z) < 2."""
    e, p1, p2, p3 = phi_near(z / 2) if is_near else phi(z / 2)
    q1 = 0.5 * (e + 1.0) * p1
    q2 = 0.25 * (p1 * p1 + 2 * p2)
    q3 = 0.125 * (p1 * p2 + p2 + 2 * p3)
    return e, p1, e * e, q1 - 3 * q2 + 4 * q3, 2 * q2 - 4 * q3, 4 * q3 - q2
'''
_JIT = """from numba import njit

jitted = njit(cache=True, nogil=True, error_model="numpy")
"""


def head(text: str) -> str:
    """First lines of a generated module: its docstring, its imports, and `jitted`."""
    return f'"""{text}"""\nfrom math import *\n\nimport numpy as np\n{_JIT}\n'
