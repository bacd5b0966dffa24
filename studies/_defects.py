"""Ways to spoil a record: samples, clocks, channels. Each takes a table and how strong it is."""

from __future__ import annotations

import gzip
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

#: Hz, at which the records are
RATE = 500.0
Table = dict[str, np.ndarray]


def _columns(table: Table, *starts: str) -> list[str]:
    return [name for name in table if name.startswith(starts)]


def _kept(table: Table, rows: np.ndarray) -> Table:
    return {name: y[rows] for name, y in table.items()}


def _changed(table: Table, change: Callable[[np.ndarray], np.ndarray], *starts: str) -> Table:
    return table | {name: change(table[name]) for name in _columns(table, *starts)}


def _low_passed(y: np.ndarray, frequency: float) -> np.ndarray:
    keep, out = np.exp(-2 * np.pi * frequency / RATE), np.empty_like(y)
    last = y[0]
    for i, value in enumerate(y):
        out[i] = last = keep * last + (1 - keep) * value
    return out


def _spans(rng: Any, rows: int, share: float, length: int = 25) -> np.ndarray:
    """Rows within spans of that length, which together are that share of all."""
    dead = np.zeros(rows, dtype=bool)
    for _ in range(max(round(share * rows / length), 1)):
        start = int(rng.integers(rows - length))
        dead[start : start + length] = True
    return dead


def _lost(table: Table, rng: Any, strength: float) -> Table:
    lost = rng.random(len(table["t"])) < strength
    lost[0] = False
    return _kept(table, ~lost)


def _repeated(table: Table, rng: Any, strength: float) -> Table:
    """A row is the one logged before it, under its own time."""
    again = rng.random(len(table["t"])) < strength
    again[0] = False
    return _held(table, again)


def _held(table: Table, rows: np.ndarray) -> Table:
    """Rows that hold the last row before them, under their own times."""
    last = np.maximum.accumulate(np.where(rows, 0, np.arange(len(rows))))
    return {name: y if name == "t" else y[last] for name, y in table.items()}


def _jittered(table: Table, rng: Any, strength: float) -> Table:
    """Samples are taken at moments that jitter, and the log has the even grid (rms in rows)."""
    t = table["t"]
    moments = t + strength / RATE * rng.standard_normal(len(t))
    return {name: y if name == "t" else np.interp(moments, t, y) for name, y in table.items()}


def _drifting(table: Table, rng: Any, strength: float) -> Table:
    """The force channel's clock is fast by this share."""
    t = table["t"]
    return _changed(table, lambda y: np.interp(t * (1 + strength), t, y), "f")


def _outliers(table: Table, rng: Any, strength: float) -> Table:
    def change(y: np.ndarray) -> np.ndarray:
        hit = rng.random(len(y)) < strength
        return np.where(hit, y + 10 * y.std() * rng.choice([-1, 1], len(y)), y)

    return _changed(table, change, "f", "x")


def _clipped(table: Table, rng: Any, strength: float) -> Table:
    def change(y: np.ndarray) -> np.ndarray:
        limit = np.quantile(np.abs(y), 1 - strength)
        return np.clip(y, -limit, limit)

    return _changed(table, change, "f", "u")


def _dead(table: Table, rng: Any, strength: float) -> Table:
    return _held(table, _spans(rng, len(table["t"]), strength))


def _humming(table: Table, rng: Any, strength: float) -> Table:
    hum = np.sqrt(2) * np.sin(2 * np.pi * 50 * table["t"] + rng.uniform(0, 2 * np.pi))
    return _changed(table, lambda y: y + strength * y.std() * hum, "f", "u")


def _quantised(table: Table, rng: Any, strength: float) -> Table:
    def change(y: np.ndarray) -> np.ndarray:
        step = strength * np.abs(y).max()
        return np.round(y / step) * step

    return _changed(table, change, "u")


def _late(table: Table, rng: Any, strength: float) -> Table:
    """The command is written late (rows)."""
    t = table["t"]
    return _changed(table, lambda y: np.interp(t - strength / RATE, t, y), "u")


def _soft(table: Table, rng: Any, strength: float) -> Table:
    return _changed(table, lambda y: _low_passed(y, strength), "f")


def _turned(table: Table, rng: Any, strength: float) -> Table:
    """1: the force, 2: the command, 3: the position has the other sign."""
    return _changed(table, lambda y: -y, {1: "f", 2: "u", 3: "x"}[round(strength)])


@dataclass(frozen=True)
class Defect:
    """What is spoilt, how (weak, middle, strong), and the unit of that."""

    name: str
    spoil: Callable[[Table, Any, float], Table]
    sizes: tuple[float, float, float]
    unit: str


DEFECTS = (
    Defect("lost samples", _lost, (0.001, 0.01, 0.1), "of all"),
    Defect("repeated samples", _repeated, (0.001, 0.01, 0.1), "of all"),
    Defect("jittered samples", _jittered, (0.01, 0.1, 0.5), "rows rms"),
    Defect("clock drift of the force", _drifting, (1e-5, 1e-4, 1e-3), "fast"),
    Defect("outliers", _outliers, (0.0003, 0.003, 0.03), "of all"),
    Defect("clipping", _clipped, (0.001, 0.01, 0.1), "of all"),
    Defect("dead spans", _dead, (0.003, 0.03, 0.2), "of all"),
    Defect("hum at 50 Hz", _humming, (0.01, 0.1, 0.5), "of rms"),
    Defect("quantised command", _quantised, (0.001, 0.01, 0.1), "of the largest"),
    Defect("late command", _late, (0.5, 2.0, 8.0), "rows"),
    Defect("low-passed force", _soft, (100.0, 30.0, 8.0), "Hz"),
    Defect("wrong sign", _turned, (1, 2, 3), "1 force, 2 command, 3 position"),
)


def rewrite_records(folder: Path, spoil: Callable[[Table], Table]) -> None:
    """Spoil every record (.csv.gz) of a folder in its place."""
    for path in sorted(folder.glob("*.csv.gz")):
        head, *lines = gzip.decompress(path.read_bytes()).decode().splitlines()
        values = np.array([line.split(",") for line in lines], dtype=float)
        spoilt = spoil(dict(zip(head.split(","), values.T, strict=True)))
        rows = np.column_stack(list(spoilt.values())).tolist()
        text = "\n".join([head, *(",".join(f"{x:.9g}" for x in row) for row in rows), ""])
        path.write_bytes(gzip.compress(text.encode(), 5, mtime=0))


def log_as_loggers_do(table: Table, rng: Any, shift: float) -> Table:
    """Commands so many rows late (< 0: early); rows read 0.05 rows off their place; 0.2 % lost.

    The stamp says when a row was read. An encoder reads whole steps.
    """
    t = table["t"]
    period = float(np.median(np.diff(t)))
    moments = t + period * np.clip(0.05 * rng.standard_normal(len(t)), -0.2, 0.2)
    out = {"t": moments} | {n: np.interp(moments, t, y) for n, y in table.items() if n != "t"}
    for name in _columns(table, "x"):
        step = np.diff(np.unique(table[name])).min()
        out[name] = step * np.round(out[name] / step)
    for name in _columns(table, "u"):
        out[name] = np.interp(t - shift * period, t, table[name])
    return _lost(out, rng, 0.002)
