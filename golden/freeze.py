"""Freeze what the package answers today and compare it with golden/frozen; see the README.

python golden/freeze.py [PART ...] [--whole] [--accept]
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
sys.path[:0] = [str(HERE), str(ROOT)]

import answers  # noqa: E402  (beside this file)
import compare  # noqa: E402
import pieces  # noqa: E402

FROZEN = HERE / "frozen"
#: digits that are kept of numbers: of answers as many as an optimiser determines
DIGITS = {"answers": 7, "recordings": 7, "hidden": 7, "data": 7, "drawn": 7, "results": 7,
          "studies": 8, "logs": 6, "simulations": 10}  # fmt: skip
#: longest text of a list or table that stands on one line
LINE = 140

QUICK = (*pieces.PARTS, *answers.PARTS)
ALL = (*QUICK, *answers.WHOLE)


def rounded(content: Any, digits: int | None) -> Any:
    """The same data with numbers of so many digits; None: as they are. Infinity is a text."""
    if isinstance(content, dict):
        return {str(k): rounded(v, digits) for k, v in content.items()}
    if isinstance(content, list | tuple):
        return [rounded(v, digits) for v in content]
    if isinstance(content, float):
        if content != content or content in (float("inf"), float("-inf")):
            return str(content)
        return content if digits is None else float(f"{content:.{digits}g}")
    return content


def lines(content: Any) -> str:
    """JSON in which what is short stands on one line, and texts of pages on a line each."""
    short = json.dumps(content, sort_keys=True, ensure_ascii=False)
    numbers = isinstance(content, list) and not any(isinstance(x, str | dict) for x in content)
    if not isinstance(content, dict | list) or len(short) <= LINE or numbers:
        return short
    if isinstance(content, dict):
        rows = [
            f"{json.dumps(k, ensure_ascii=False)}: {lines(content[k])}" for k in sorted(content)
        ]
        return "{\n" + ",\n".join(rows) + "\n}"
    return "[\n" + ",\n".join(map(lines, content)) + "\n]"


def freeze(part: str, work: Path) -> Path:
    """Write one part into `work`; raises answers.NotThere: what it needs is not here."""
    diagnosed = {**answers.PARTS, **answers.WHOLE}
    whole = pieces.PARTS[part]() if part in pieces.PARTS else diagnosed[part](work)
    content = rounded(whole, DIGITS.get(part))
    path = work / f"{part}.json"
    path.write_text(lines(content) + "\n", encoding="utf-8")
    return path


def main(arguments: Sequence[str] | None = None) -> int:
    """Freeze, then compare or accept; returns 1 where anything moved."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(ALL))
    parser.add_argument("--whole", action="store_true", help=f"also {', '.join(answers.WHOLE)}")
    parser.add_argument("--accept", action="store_true", help="make this state golden/frozen")
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "golden", metavar="FOLDER")
    options = parser.parse_args(arguments)
    if unknown := set(options.parts) - set(ALL):
        parser.error(f"no part {', '.join(sorted(unknown))}; found {', '.join(ALL)}")
    chosen = options.parts or [*QUICK, *(answers.WHOLE if options.whole else ())]
    work = options.work / answers.digest_of([ROOT / "teleopdesign"])
    work.mkdir(parents=True, exist_ok=True)
    count = 0
    for part in chosen:
        began = time.monotonic()
        try:
            path = freeze(part, work)
        except answers.NotThere as why:
            print(f"{part}: left out: {why}", flush=True)
            continue
        took = f"{time.monotonic() - began:.0f} s"
        if options.accept:
            FROZEN.mkdir(exist_ok=True)
            (FROZEN / path.name).write_bytes(path.read_bytes())
            print(f"{part}: accepted, {took}", flush=True)
            continue
        moved = compare.between(FROZEN / path.name, path)
        print(f"{part}: {len(moved)} differences, {took}", flush=True)
        print("".join(f"  {line}\n" for line in moved), end="", flush=True)
        count += len(moved)
    return int(count > 0)


if __name__ == "__main__":
    sys.exit(main())
