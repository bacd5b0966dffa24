"""Hold two frozen states against each other: python golden/compare.py BEFORE AFTER."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

#: relative difference that counts as rounding: where an optimiser stops, along a loop that grows by
#: itself, and elsewhere
ROUNDING = {"answers": 1e-6, "recordings": 1e-6, "simulations": 1e-9}
PLAIN = 1e-12


def differences(before: Any, after: Any, *, near: float, where: str = "") -> Iterator[str]:
    """A line for each place where the two differ by more than `near`, relative."""
    if isinstance(before, dict) and isinstance(after, dict):
        for key in sorted({*before, *after}):
            place = f"{where}/{key}"
            if key not in before or key not in after:
                yield f"{place}: {'only before' if key in before else 'only after'}"
            else:
                yield from differences(before[key], after[key], near=near, where=place)
    elif isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        scale = _scale(before, after)
        for k, (a, b) in enumerate(zip(before, after, strict=True)):
            if scale and isinstance(a, float) and isinstance(b, float):
                if abs(a - b) > near * scale:
                    yield f"{where}/{k}: {a!r} -> {b!r}"
            else:
                yield from differences(a, b, near=near, where=f"{where}/{k}")
    elif isinstance(before, float) and isinstance(after, float):
        if not math.isclose(before, after, rel_tol=near) and before != after:
            yield f"{where}: {before!r} -> {after!r}"
    elif before != after:
        yield f"{where}: {before!r} -> {after!r}"


def _scale(*rows: list[Any]) -> float:
    """Largest size in a row of numbers: zero crossings are compared with the whole row."""
    numbers = [abs(x) for row in rows for x in row if isinstance(x, float) and math.isfinite(x)]
    return max(numbers, default=0.0) if all(isinstance(x, float) for x in rows[0]) else 0.0


def main(before: Path, after: Path) -> int:
    """Print what differs; returns how the program ends: 1 where anything does."""
    count = 0
    for path in sorted(before.glob("*.json")):
        other = after / path.name
        if not other.exists():
            print(f"{path.stem}: not frozen in {after}")
            continue
        pair = (json.loads(p.read_text(encoding="utf-8")) for p in (path, other))
        near = ROUNDING.get(path.stem, PLAIN)
        for line in differences(*pair, near=near, where=path.stem):
            print(line)
            count += 1
    print(f"{count} differences")
    return int(count > 0)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))
