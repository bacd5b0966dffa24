"""Compare two frozen states: python golden/compare.py BEFORE AFTER (folders, or two files)."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

#: relative difference that counts as rounding, by part. Where an optimiser stops; along a loop that
#: amplifies rounding by itself; where values were rounded to print or to save
ROUNDING = {
    "answers": 1e-6,
    "recordings": 1e-6,
    "hidden": 1e-6,
    "data": 1e-6,
    "drawn": 1e-6,
    "results": 1e-6,
    "logs": 1e-5,
    "studies": 1e-6,
    "simulations": 1e-9,
}
PLAIN = 1e-12
#: part of its own standard error by which an estimate may move: a thousandth decides nothing
OF_ERROR = 1e-3
#: relative difference of a standard error: a second derivative at where an optimiser stops
ERRORS = 1e-4
#: places in which rounding decides more: the simplex of a tuning stops at a step of 1e-4 of each
#: interval; a probability is stated with two digits
WIDER = {"studies/tuned": 1e-3, "studies/trade-off": 1e-3}
PROBABILITY = 1e-3


def between(before: Path, after: Path) -> list[str]:
    """A line for each place where two files of one part differ."""
    if not before.exists():
        return [f"{after.stem}: nothing is frozen"]
    pair = [json.loads(path.read_text(encoding="utf-8")) for path in (before, after)]
    near = ROUNDING.get(before.stem, PLAIN)
    return list(differences(*pair, near=near, where=before.stem))


def differences(before: Any, after: Any, *, near: float, where: str = "") -> Iterator[str]:
    """A line for each place where the two differ by more than rounding.

    near: relative difference that counts as rounding
    """
    near = max((w for place, w in WIDER.items() if where.startswith(place)), default=near)
    if isinstance(before, dict) and isinstance(after, dict):
        near = max(near, _slack(before))
        for key in sorted({*before, *after}):
            place = f"{where}/{key}"
            if key not in before or key not in after:
                yield f"{place}: {'only before' if key in before else 'only after'}"
                continue
            at = {"stderr": max(near, ERRORS), "probability": PROBABILITY}.get(key, near)
            yield from differences(before[key], after[key], near=at, where=place)
    elif isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        scale = _scale(before, after)
        for k, (a, b) in enumerate(zip(before, after, strict=True)):
            if scale and _is_number(a) and _is_number(b):
                if abs(a - b) > near * scale:
                    yield f"{where}/{k}: {a!r} -> {b!r}"
            else:
                yield from differences(a, b, near=near, where=f"{where}/{k}")
    elif _is_number(before) and _is_number(after):
        is_share = where.endswith("/probability")
        if not math.isclose(before, after, rel_tol=near, abs_tol=near if is_share else 0.0):
            yield f"{where}: {before!r} -> {after!r}"
    elif before != after:
        yield f"{where}: {before!r} -> {after!r}"


def _is_number(content: Any) -> bool:
    return isinstance(content, int | float) and not isinstance(content, bool)


def _slack(entry: dict[str, Any]) -> float:
    """Relative difference within which an estimate with a standard error stays the same."""
    value, error = entry.get("value"), entry.get("stderr")
    if not (_is_number(value) and _is_number(error)) or value == 0 or error is None:
        return 0.0
    return OF_ERROR * abs(error / value)


def _scale(*rows: list[Any]) -> float:
    """Largest size in a row of numbers: zero crossings are compared with the whole row."""
    if not all(_is_number(x) for row in rows for x in row):
        return 0.0
    return max((abs(x) for row in rows for x in row if math.isfinite(x)), default=0.0)


def main(before: Path, after: Path) -> int:
    """Print what differs; returns how the program ends: 1 where anything does."""
    pairs = [(p, after / p.name) for p in sorted(before.glob("*.json"))]
    lines = []
    for one, other in pairs if before.is_dir() else [(before, after)]:
        if not other.exists():
            print(f"{one.stem}: not frozen in {after}")
            continue
        lines += between(one, other)
    print("".join(f"{line}\n" for line in lines) + f"{len(lines)} differences")
    return int(bool(lines))


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))
