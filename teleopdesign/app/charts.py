"""The charts of the page, which share one selection (Vega-Lite, drawn in the browser)."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.sentences import unit_on_page
from ..show.figures.style import AFTER, BACKWARD, BEFORE, FORWARD

if TYPE_CHECKING:
    from xarray import Dataset

#: most samples of a chart: more make a selection slow in a browser
MOST = 2500
#: pixels of the widest chart
WIDE = 800
#: pixels of the height of each
HIGH = 170
#: name of the selection of rows that all panels share
ROWS = "rows"
_TIPS = ("time", "position", "velocity", "measured", "model", "residual")


@dataclass(frozen=True)
class Chart:
    """A Vega-Lite specification that a notebook shows."""

    specification: dict[str, Any]

    def _mime_(self) -> tuple[str, str]:
        return "application/vnd.vegalite.v5+json", json.dumps(self.specification)


def rows_of(data: Dataset, body: str, use: str) -> list[dict[str, float | str]]:
    """Samples that count in the error, thinned evenly to `MOST`, as rows for a chart."""
    counts = data["counts"].values & (data["body"].values == body) & (data["use"].values == use)
    chosen = np.flatnonzero(counts)
    chosen = chosen[:: max(1, -(-len(chosen) // MOST))]
    names = [n for n in (*_TIPS, "carrier") if n in data]
    columns: dict[str, list[Any]] = {
        n: [float(f"{x:.6g}") for x in data[n].values[chosen]] for n in names
    }
    sign = np.sign(data["direction"].values[chosen]).astype(int)
    columns["direction"] = [("at rest", "forward", "backward")[k] for k in sign]  # -1: the last
    columns["record"] = [str(name) for name in data["record"].values[chosen]]
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def residual_chart(data: Dataset, body: str, use: str) -> Chart:
    """Measured and modelled force over time; the residual over time, velocity and position.

    A span that the user draws in one panel is marked in the others.

    data: as `Comparison.data`;  use: "fit" or "check"
    """
    half, colour = WIDE // 2 - 35, _colour_by_direction()
    over = {
        name: {"name": f"residual_over_{name}"} | _points(data, name, colour, width)
        for name, width in (("time", WIDE), ("velocity", half), ("position", half))
    }
    below = {"hconcat": [over["velocity"], over["position"]]}
    views = [view["name"] for view in over.values()]
    chart = _chart(rows_of(data, body, use), [_forces(data), over["time"], below])
    chart["params"] = [{"name": "span", "select": {"type": "interval"}, "views": views}]
    chart["resolve"] = {"scale": {"color": "independent"}}
    return Chart(chart)


def _chart(rows: list[dict[str, float | str]], panels: list[dict[str, Any]]) -> dict[str, Any]:
    """Panels below each other, of the same rows."""
    return {
        "$schema": "https://vega.github.io/schema/vega-lite/v5.json",
        "datasets": {ROWS: rows},
        "vconcat": panels,
        "config": {"axis": {"grid": False}},
    }


def _title(data: Dataset, name: str) -> str:
    """Name and unit of a variable."""
    shown = data[name].attrs
    return f"{shown.get('label', name)} ({unit_on_page(shown['units'])})"


def _panel(data: Dataset, x: str, mark: dict[str, Any], width: int) -> dict[str, Any]:
    """A panel over a variable, still without what it shows."""
    along = {"field": x, "type": "quantitative", "title": _title(data, x), "scale": {"zero": False}}
    return {
        "data": {"name": ROWS},
        "width": width,
        "height": HIGH,
        "mark": mark,
        "encoding": {"x": along},
    }


def _points(data: Dataset, x: str, colour: dict[str, Any], width: int = WIDE) -> dict[str, Any]:
    """The residual over a variable of the data."""
    panel = _panel(data, x, {"type": "circle", "size": 9, "opacity": 0.7}, width)
    residual = {"field": "residual", "type": "quantitative", "title": _title(data, "residual")}
    panel["encoding"] |= {"y": residual, "color": colour, "tooltip": _tip()}
    return panel


def _forces(data: Dataset) -> dict[str, Any]:
    """Measured and modelled force over time, one line for each record."""
    panel = _panel(data, "time", {"type": "line", "strokeWidth": 1.2, "clip": True}, WIDE)
    title = _title(data, "residual").replace("residual", "force")
    panel["transform"] = [{"fold": ["measured", "model"], "as": ["force", "value"]}]
    panel["encoding"] |= {
        "y": {"field": "value", "type": "quantitative", "title": title},
        "detail": {"field": "record", "type": "nominal"},
        "color": _colour("force", {"measured": "gray", "model": AFTER}),
    }
    return panel


def comparison_chart(
    one: Dataset, other: Dataset, body: str, use: str, names: tuple[str, str]
) -> Chart:
    """The residuals of two models over "carrier" and over time, one panel above the other.

    one, other: as `Comparison.data`, with the variable that carries the effect by which they
        differ;  names: of the two models
    """
    rows = [
        {**row, "of": name}
        for data, name in zip((one, other), names, strict=True)
        for row in rows_of(data, body, use)
    ]
    colour = _colour("of", dict(zip(names, (BEFORE, AFTER), strict=True)))
    return Chart(_chart(rows, [_points(one, x, colour) for x in ("carrier", "time")]))


def _colour(field: str, colours: dict[str, str]) -> dict[str, Any]:
    """A colour for each value of a field, with a legend above."""
    return {
        "field": field,
        "type": "nominal",
        "scale": {"domain": list(colours), "range": list(colours.values())},
        "legend": {"title": None, "orient": "top"},
    }


def _colour_by_direction() -> dict[str, Any]:
    """Colour by the direction of motion; samples that are not selected are grey."""
    ways = {"forward": FORWARD, "backward": BACKWARD, "at rest": "darkgray"}
    return {"condition": {"param": "span", **_colour("direction", ways)}, "value": "lightgray"}


def _tip() -> list[dict[str, str]]:
    return [{"field": n, "type": "quantitative", "format": ".4g"} for n in _TIPS]
