"""Models of one body whose parameters have stated values and errors, and fits of them."""

from types import SimpleNamespace

import numpy as np

from teleopdesign import Body, Model
from teleopdesign.blocks import Value
from teleopdesign.effects import EFFECTS

#: of a fit
ROWS = 200
BY_EFFECT = {
    "coulomb": {"level": (1.0, 0.01)},
    "viscous": {"damping": (2.0, 0.1)},
    "bias": {"force": (0.5, 0.01)},
    "spring": {"stiffness": (3.0, 0.01)},
    "stribeck": {"extra_static_level": (0.5, 0.01), "stribeck_velocity": (0.1, 0.001)},
    "presliding": {"stiffness": (1e3, 1.0), "bristle_damping": (4.0, 0.1)},
    "friction_drift": {"fraction": (0.5, 0.01), "time_constant": (60.0, 1.0)},
    "actuator_lag": {"time_constant": (0.01, 0.0005)},
    "backlash": {
        "tip_inertia": (0.1, 0.001),
        "stiffness": (50.0, 0.5),
        "damping": (0.1, 0.001),
        "gap": (0.02, 0.0002),
    },
    "cogging": {"amplitude": (0.3, 0.003), "period": (0.1, 0.001), "phase": (0.4, 0.1)},
    "actuator_gain": {"gain": (1.5, 0.01)},
}


def model(*effects, **changed):
    """These effects; changed: parameter -> (value, standard error), and True if it is fixed."""
    values = {
        f"{e}.{n}": Value(v[0], len(v) > 2, v[1])
        for e in effects
        for n, v in {n: changed.get(n, v) for n, v in BY_EFFECT[e].items()}.items()
    }
    bodies = Body("revolute", {"inertia": 1.0, **values}, tuple(EFFECTS[e] for e in effects))
    return Model({"device": bodies})


def fitted(known, *effects, columns=None, at_bound=()):
    """A fit of that model in which the parameters of these effects are free."""
    free = tuple(
        n for n in known.parameters if n.split(".")[1] in effects and not known.parameters[n].fixed
    )
    if columns is None:
        columns = np.random.default_rng(0).standard_normal((ROWS, len(free)))
    return SimpleNamespace(
        model=known,
        free=free,
        jacobian=columns,
        scale=np.ones(len(free)),
        at_bound=at_bound,
        fit_residual=np.ones(ROWS),
        check_residual=np.ones(ROWS),
    )
