"""The charts of the page, which share one selection (Vega-Lite, drawn in the browser)."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..show.figures.diagnosis import label_of
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
    unit = {n: data[n].attrs["units"] for n in ("time", "position", "velocity", "residual")}
    residual = {
        "field": "residual",
        "type": "quantitative",
        "title": f"residual ({unit['residual']})",
    }

    def over(name: str, width: int) -> dict[str, Any]:
        along = {
            "field": name,
            "type": "quantitative",
            "title": f"{name} ({unit[name]})",
            "scale": {"zero": False},
        }
        return {
            "data": {"name": ROWS},
            "name": f"residual_over_{name}",
            "width": width,
            "height": HIGH,
            "mark": {"type": "circle", "size": 9, "opacity": 0.7},
            "encoding": {
                "x": along,
                "y": residual,
                "color": _colour_by_direction(),
                "tooltip": _tip(),
            },
        }

    half = WIDE // 2 - 35
    below = {"hconcat": [over("velocity", half), over("position", half)]}
    views = [f"residual_over_{name}" for name in ("time", "velocity", "position")]
    return Chart(
        {
            "$schema": "https://vega.github.io/schema/vega-lite/v5.json",
            "datasets": {ROWS: rows_of(data, body, use)},
            "params": [{"name": "span", "select": {"type": "interval"}, "views": views}],
            "vconcat": [_forces(unit), over("time", WIDE), below],
            "resolve": {"scale": {"color": "independent"}},
            "config": {"axis": {"grid": False}},
        }
    )


def _forces(unit: dict[str, str]) -> dict[str, Any]:
    """Measured and modelled force over time, one line for each record."""
    colours = {"domain": ["measured", "model"], "range": ["gray", AFTER]}
    force = {"field": "value", "type": "quantitative", "title": f"force ({unit['residual']})"}
    return {
        "data": {"name": ROWS},
        "width": WIDE,
        "height": HIGH,
        "transform": [{"fold": ["measured", "model"], "as": ["force", "value"]}],
        "mark": {"type": "line", "strokeWidth": 1.2, "clip": True},
        "encoding": {
            "x": {"field": "time", "type": "quantitative", "title": f"time ({unit['time']})"},
            "y": force,
            "detail": {"field": "record", "type": "nominal"},
            "color": {
                "field": "force",
                "type": "nominal",
                "scale": colours,
                "legend": _legend_above(),
            },
        },
    }


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
    unit = one["residual"].attrs["units"]
    residual = {"field": "residual", "type": "quantitative", "title": f"residual ({unit})"}
    colours = {"domain": list(names), "range": [BEFORE, AFTER]}
    of = {"field": "of", "type": "nominal", "scale": colours, "legend": _legend_above()}

    def over(name: str) -> dict[str, Any]:
        title = label_of(one, name)
        along = {"field": name, "type": "quantitative", "title": title, "scale": {"zero": False}}
        return {
            "data": {"name": ROWS},
            "width": WIDE,
            "height": HIGH,
            "mark": {"type": "circle", "size": 9, "opacity": 0.6},
            "encoding": {"x": along, "y": residual, "color": of, "tooltip": _tip()},
        }

    return Chart(
        {
            "$schema": "https://vega.github.io/schema/vega-lite/v5.json",
            "datasets": {ROWS: rows},
            "vconcat": [over("carrier"), over("time")],
            "config": {"axis": {"grid": False}},
        }
    )


def _colour_by_direction() -> dict[str, Any]:
    """Colour by the direction of motion; samples that are not selected are grey."""
    colours = {
        "domain": ["forward", "backward", "at rest"],
        "range": [FORWARD, BACKWARD, "darkgray"],
    }
    shown = {"field": "direction", "type": "nominal", "scale": colours, "legend": _legend_above()}
    return {"condition": {"param": "span", **shown}, "value": "lightgray"}


def _legend_above() -> dict[str, Any]:
    return {"title": None, "orient": "top"}


def _tip() -> list[dict[str, str]]:
    return [{"field": n, "type": "quantitative", "format": ".4g"} for n in _TIPS]
