"""Experiments that ship with the package."""

from __future__ import annotations

from pathlib import Path

from ..base.arguments import check_types
from ..base.errors import ExperimentError, unknown


@check_types
def example(name: str = "rod") -> Path:
    """The folder of an experiment that comes with the package: "rod", "friction_curve".

    raises ExperimentError: no such experiment; the message has the nearest name

        >>> td.example("rod").name
        'rod'
    """
    folders = {p.parent.name: p.parent for p in Path(__file__).parent.glob("*/experiment.toml")}
    if name not in folders:
        raise ExperimentError(f"examples: {unknown('example', name, folders)}")
    return folders[name]
