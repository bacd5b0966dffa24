"""Friction in haptic interfaces and teleoperators: find what a model lacks, design compensation.

    import teleopdesign as td

    experiment = td.load_experiment(td.example("rod"))  # a folder: experiment.toml and records
    model = td.fit(td.Model.from_experiment(experiment), experiment)
    td.compare(model, experiment)                       # see where it fails
    td.rank(model, experiment)                          # which effect would explain it
    better = td.fit(model.with_effect("stribeck", at="device"), experiment)
    td.compare(better, experiment)                      # see the error fall
    td.find_missing(experiment)                         # all of that, step by step: the ladder

The folders, each importing only from those before it:

    quantity      force, velocity ... -> unit on a prismatic or a revolute axis
    finding       a sentence, its numbers, and a graph that shows it
    effects       what physics does: one effect = one file
    blocks        bodies, hand: equations only
    controllers   chosen, not found: one control law = one file
    diagrams      which blocks, wired by signal names; read from and written to files
    model         bodies with their effects at places; frozen
    realise       any block into each form: residual, transfer function, equations, kernel, iosystem
    derive        transfer functions and impedances from the wiring, symbolic
    frequency     Bode plots, describing functions, impedance over amplitude and frequency
    passivity     claims: proved with a certificate, refuted by a motion, or evidence
    simulate      motions and responses in time, sampled or continuous
    measurement   experiment, record, motion; whether a recording is sound
    diagnose      residual, noise floor, ladder, answer; what is left, what to measure next
    identify      Coulomb level and largest stiffness by the papers' own experiments
    design        from a diagnosed model to controllers, predictions and claims
    papers        statements of the two papers, each with its proof or check
    plot          draws result objects, computes nothing
    report        the diagnosis as one page that needs nothing else
    commands      what `teleopdesign COMMAND` does: one file each
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .blocks import Body, Value
    from .diagnose import (
        Comparison,
        Diagnosis,
        Ranking,
        check_experiment,
        compare,
        find_missing,
        fit,
        rank,
    )
    from .effects import EFFECTS, Effect, Parameter, State, load_effect
    from .errors import ExperimentError, ModelError, TeleopDesignError
    from .examples import example
    from .measurement import Experiment, Record, load_experiment
    from .measurement.recordings import fetch
    from .model import Model

__all__ = [
    "EFFECTS",
    "Body",
    "Comparison",
    "Diagnosis",
    "Effect",
    "Experiment",
    "ExperimentError",
    "Model",
    "ModelError",
    "Parameter",
    "Ranking",
    "Record",
    "State",
    "TeleopDesignError",
    "Value",
    "check_experiment",
    "compare",
    "example",
    "fetch",
    "find_missing",
    "fit",
    "load_effect",
    "load_experiment",
    "rank",
]

#: where a public name is looked up when it is first used, so that `import teleopdesign` is instant
_HOMES = (
    "examples",
    "errors",
    "effects",
    "blocks",
    "model",
    "measurement",
    "measurement.recordings",
    "diagnose",
)
__version__ = "0.1.0.dev0"


def __getattr__(name: str) -> Any:
    if name in __all__:
        for home in _HOMES:
            module = import_module(f"{__name__}.{home}")
            if hasattr(module, name):
                return getattr(module, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
