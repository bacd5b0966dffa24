"""What a search states at its end: each candidate at each step, look-alikes, no state of it."""

import pickle

import numpy as np

from teleopdesign.base.frozen import is_same
from teleopdesign.diagnose.fit import Fit
from teleopdesign.diagnose.ranking import Ranking
from teleopdesign.diagnose.result import diagnosis_of


def parts_of(thing, parts=None):
    """Every object within a result, those of its recording left out."""
    parts = {} if parts is None else parts
    if id(thing) in parts or isinstance(thing, str | bytes | int | float | np.ndarray):
        return parts
    parts[id(thing)] = thing
    if isinstance(thing, dict):
        inner = [*thing.values()]
    elif isinstance(thing, list | tuple):
        inner = [*thing]
    else:
        inner = [v for n, v in getattr(thing, "__dict__", {}).items() if n != "recording"]
    for one in inner:
        parts_of(one, parts)
    return parts


def test_a_diagnosis_holds_no_state_of_its_search(end):
    stated = diagnosis_of(end)
    kinds = {type(one) for one in parts_of(stated).values()}
    assert not kinds & {Fit, Ranking}
    assert is_same(pickle.loads(pickle.dumps(stated)), stated)
