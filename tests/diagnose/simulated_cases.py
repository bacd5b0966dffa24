"""Cases drawn for these tests, by the simulator that shares nothing with the package."""

import json
from dataclasses import replace

import numpy as np
from cases import make_case, write_case
from truth_effects import TEN

from teleopdesign.effects import EFFECTS

SEED = 8  # of the plain run's cases; drawn once, not chosen for their answers
#: the effects that the plain run chooses from, so that it stays quick; `slow` takes them all
FEW = {name: EFFECTS[name] for name in TEN}


def write_simulated(folder, effect, *, seed=SEED, level=None):
    """A case that hides this effect, or two ("bias+spring"; None: nothing is missing) in a folder.

    Every effect of the user's own model has its values: none is left to defaults.
    """
    names = effect.split("+") if effect else None
    rng = np.random.default_rng(seed)
    case = make_case(rng, level or ("clear" if effect else "null"), names)
    # an even seed: the writer gives every effect of the model its starting values
    machine = replace(case.machine, noise_seed=case.machine.noise_seed // 2 * 2)
    write_case(replace(case, machine=machine), folder)
    return folder


def truth_of(folder):
    """The truth file of a case."""
    return json.loads((folder / "truth.json").read_text())
