"""Versions of the packages that can change a number."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version

_COUNTED = ("teleopdesign", "numpy", "scipy", "sympy", "numba", "xarray")


def versions() -> dict[str, str]:
    """Package -> version; "" for a package that is used without an installation; also Python."""
    by_name = {"python": platform.python_version()}
    for name in _COUNTED:
        try:
            by_name[name] = version(name)
        except PackageNotFoundError:
            by_name[name] = ""
    return by_name
