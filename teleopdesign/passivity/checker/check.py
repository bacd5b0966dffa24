"""Check a certificate of any kind: first its digest, then the rules of its kind."""

from __future__ import annotations

import hashlib
import json
import os
import stat
from collections.abc import Callable
from typing import Any

from .algebra import expect
from .effort import FILE, Refused, need
from .matrices import state_absolute_stability, state_positive_real
from .over_a_box import state_stability
from .storage import Storage

#: kinds that are decided from the fields alone; a certificate of kind "storage" contains its proofs
_DECIDED: dict[str, Callable[[dict[str, Any]], str]] = {
    "positive real": state_positive_real,
    "absolute stability": state_absolute_stability,
    "stable over a box": state_stability,
    "positive real over a box": state_positive_real,
    "absolute stability over a box": state_absolute_stability,
}
KINDS = ("storage", *_DECIDED)


def read(content: object) -> tuple[dict[str, Any], Storage | None]:
    """Fields of a certificate, and its meaning if its kind is "storage"; no proof is checked."""
    c: dict[str, Any] = expect(dict, content, "certificate")
    for field in ("kind", "title", "digest"):
        expect(str, c.get(field), field)
    try:
        body = {k: v for k, v in c.items() if k != "digest"}
        text = json.dumps(body, sort_keys=True, allow_nan=False)
    except (TypeError, ValueError, RecursionError):
        raise Refused("refused: not plain data, or nested too deeply") from None
    digest = hashlib.sha256(text.encode()).hexdigest()
    need(len(text) <= FILE and digest == c["digest"], "changed since it was written, or too long")
    need(c["kind"] in KINDS, f"kind: expected {', '.join(KINDS[:-1])} or {KINDS[-1]}")
    return c, Storage(c) if c["kind"] == "storage" else None


def check(content: object) -> str:
    """The statement that a certificate (data as read from JSON) proves; raises Refused if none."""
    c, storage = read(content)
    if storage is None:
        return _DECIDED[c["kind"]](c)
    storage.check_proofs()
    return storage.statement()


def load(path: str) -> object:
    """The data of a JSON file; raises Refused: not readable, too long, no JSON, a field twice."""

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        need(len(dict(pairs)) == len(pairs), "a field twice")
        return dict(pairs)

    try:
        need(not stat.S_ISFIFO(os.stat(path).st_mode), "a pipe")  # which may never end
        with open(path, "rb") as file:
            data = file.read(FILE + 1)
        need(len(data) <= FILE, "too long")
        return json.loads(data.decode("utf-8"), object_pairs_hook=once)
    except Refused:
        raise
    except (OSError, ValueError, RecursionError) as problem:
        raise Refused(f"refused: no certificate: {type(problem).__name__}") from None


def main(paths: list[str]) -> int:
    """Print one line for each file; returns 0 if all are proved, 1 if not, 2 without files."""
    status = 0 if paths else 2
    for path in paths:
        try:
            line = f"proved: {check(load(path))}"
        except Refused as problem:
            line, status = str(problem), 1
        print(f"{ascii(path)[1:-1]}: {line}")
    return status
