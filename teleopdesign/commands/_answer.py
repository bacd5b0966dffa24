"""The model of a diagnosis, read back from its answer file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import ExperimentError, did_you_mean

if TYPE_CHECKING:
    from ..blocks import Body

#: unit of the inertia -> axis
_AXES = {"kg": "prismatic", "kg*m^2": "revolute"}


def body_of_answer(path: Path, at: str | None) -> Body:
    """The body at that place (default: the only one) with all effects that the answer holds.

    raises ExperimentError: no answer of `teleopdesign diagnose --json`, or no such body
    """
    from ..blocks import Body, Value
    from ..effects import EFFECTS

    content = _content(path)
    found: dict[str, dict[str, Any]] = {}
    for name, value in content["model_parameters"].items():
        place, _, own = name.partition(".")
        found.setdefault(place, {})[own] = value
    for candidate in content["candidates"]:
        key = {n: candidate[n] for n in ("effect", "at")}
        if key in content["missing"]:
            for name, value in candidate["parameters"].items():
                found.setdefault(key["at"], {})[f"{key['effect']}.{name}"] = value
    place = at or next(iter(found))
    if place not in found:
        known = ", ".join(found)
        raise ExperimentError(f"{path}: no body {place!r}, has {known}{did_you_mean(place, found)}")
    if at is None and len(found) > 1:
        raise ExperimentError(f"{path}: bodies {', '.join(found)}: choose one with --body")
    parameters = found[place]
    if "inertia" not in parameters:
        raise ExperimentError(f"{path}: model_parameters.{place}.inertia: missing")
    axis = _AXES.get(parameters["inertia"]["unit"], "prismatic")
    effects = {n.partition(".")[0] for n in parameters} - {"inertia"}
    if unknown := effects - set(EFFECTS):
        raise ExperimentError(f"{path}: unknown effect {min(unknown)!r}")
    values = {
        n: Value(v["value"], stderr=float("nan") if v["stderr"] is None else v["stderr"])
        for n, v in parameters.items()
    }
    # parameters that are optional are zero where the answer does not hold them
    return Body(axis, values, tuple(EFFECTS[name] for name in sorted(effects)))


def place_of_answer(path: Path) -> str:
    """The first body of an answer; raises ExperimentError: no answer."""
    return str(next(iter(_content(path)["model_parameters"]))).partition(".")[0]


def _content(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as problem:
        raise ExperimentError(f"{path}: no answer: {problem}") from problem
    expected = ("model_parameters", "candidates", "missing")
    if not isinstance(content, dict) or not all(n in content for n in expected):
        raise ExperimentError(f"{path}: no answer of `teleopdesign diagnose --json`")
    return content
