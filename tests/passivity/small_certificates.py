"""A small certificate that is true, written by hand: what tests of the checker change."""

import hashlib
import json


def sealed(content):
    """With a digest that fits, as a forger would."""
    body = {k: v for k, v in content.items() if k != "digest"}
    text = json.dumps(body, sort_keys=True)
    return {**body, "digest": hashlib.sha256(text.encode()).hexdigest()}


def storage(**changes):
    """A small true certificate: p' = k v, V = p^2/(2 k), supply p v + b v^2."""
    content = {
        "kind": "storage",
        "title": "spring and damper",
        "constants": ["k"],
        "signals": ["b", "v"],
        "rates": {"p": "k*v"},
        "signs": ["v"],
        "positive": {"k": "k"},
        "nonnegative": {"b": "b"},
        "invariant": {},
        "supply": "p*v + b*v**2",
        "storage": "p**2/(2*k)",
        "proofs": {
            "supply": {"1": [["1", {"b": 1}, "v"]], "-1": [["1", {"b": 1}, "v"]]},
            "storage": {s: [["1/2", {"k": -1}, "p"]] for s in ("1", "-1")},
        },
        "example": {"k": "2", "b": "1", "v": "1"},
    }
    return sealed({**content, **changes})


def impedance(text):
    return sealed({"kind": "positive real", "title": "", "impedance": [[text]]})


def paths_of(value, path=()):
    """Where each part of plain data is: keys and indices from the top."""
    if path:
        yield path
    steps = {dict: lambda: list(value), list: lambda: range(len(value))}
    for k in steps.get(type(value), tuple)():
        yield from paths_of(value[k], (*path, k))
