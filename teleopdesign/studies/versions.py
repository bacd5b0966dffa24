"""Versions of what can change a number."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version

_COUNTED = ("teleopdesign", "numpy", "scipy", "sympy", "numba", "xarray")


def versions() -> dict[str, str]:
    """Package -> version, "" where it is used without an installation; Python among them."""
    found = {"python": platform.python_version()}
    for name in _COUNTED:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = ""
    return found
