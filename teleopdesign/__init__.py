"""Friction in haptic interfaces and teleoperators: find what a model lacks, design compensation.

    import teleopdesign as td

    experiment = td.load_experiment(td.example("rod"))  # a folder: experiment.toml and records
    model = td.fit(td.Model.from_experiment(experiment), experiment)
    td.compare(model, experiment)                       # see where it fails
    td.rank(model, experiment)                          # which effect would explain it
    better = td.fit(model.with_effect("stribeck", at="device"), experiment)
    td.compare(better, experiment)                      # see the error fall
    diagnosis = td.find_missing(experiment)             # all of that, step by step: the ladder

    design = td.design_compensation(diagnosis)          # cancellation, force feedback, predictions
    td.derive_transfers(design.diagram)                 # its transfer functions
    td.simulate_diagram(design.diagram, duration=1.0)   # signals over time

The names that a user types:

    experiments   Experiment, experiment, load_experiment, check_experiment, example
    models        Model, Body
    effects       EFFECTS, load_effect
    diagnosis     fit, compare, rank, find_missing, load_answer, describe, propose_experiment
    diagrams      Diagram, haptic_interface, teleoperator, hand, read_diagram, write_diagram
    controllers   CONTROLLERS, controller, from_control
    responses     derive_transfers, transfer_functions, bode, simulate_diagram, simulate_many,
                  Sampling, sine
    design        design_compensation
    studies       study, measure, tune
    passivity     diagram_claims, positive_real
    errors        ExperimentError, ModelError

Further names, such as `td.Effect` and `td.fetch`, are listed in `td.FURTHER`: classes of results,
and the parts of definitions, studies and recordings.

Every folder is there as well: `td.passivity`, `td.diagrams`, `td.frequency` ... A folder named by a
verb can be called: `td.diagnose` does what `td.find_missing` does, and so do `td.check`,
`td.derive`, `td.design` and `td.simulate`.

The folders, each importing only from those before it:

    base          errors, units, TOML, numbers in words, frozen values, whole files: no physics
    arms          links of an arm, of a URDF or as written, and the forces that they need
    effects       the catalogue of physical effects: one effect = one file
    blocks        equations of bodies and hand
    controllers   control laws that the user chooses: one control law = one file
    diagrams      blocks wired by signal names; read from and written to files
    model         bodies with their effects at places; frozen
    check         what a recording tells without a fit: is it sound, may a diagnosis answer at all
    realise       any block into each form: residual, transfer function, equations, kernel, iosystem
    derive        transfer functions and impedances from the wiring, symbolic
    frequency     Bode plots, describing functions, impedance over amplitude and frequency
    passivity     claims: proved with a certificate, refuted by a motion, or evidence
    simulate      motions and responses in time, sampled or continuous
    measurement   experiment, record, motion, prepared for comparison
    diagnose      residual, noise floor, ladder, answer
    identify      Coulomb level and largest stiffness by the papers' experiments
    fitted_checks  what a recording tells with a fit: signs, units, timing, visible effects
    unexplained   where a model fails, and on which variables the residual depends
    next_experiment  the motion that distinguishes the effects that a diagnosis leaves open
    design        from a diagnosed model to controllers, predictions and claims
    studies       a model at every point of named parameters, on one machine or many
    tuning        values that meet limits, trade measures off, or follow measured signals
    papers        statements of the two papers, each with its proof or check
    show          how results are drawn, worded and reported; computes nothing
    app           the page in the browser: a diagnosis step by step
    commands      what `teleopdesign COMMAND` does: one file each
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from .base.folder_calls import let_folders_be_called

if TYPE_CHECKING:
    from . import app as app
    from . import arms as arms
    from . import blocks as blocks
    from . import check as check
    from . import controllers as controllers
    from . import derive as derive
    from . import design as design
    from . import diagnose as diagnose
    from . import diagrams as diagrams
    from . import effects as effects
    from . import frequency as frequency
    from . import identify as identify
    from . import measurement as measurement
    from . import next_experiment as next_experiment
    from . import passivity as passivity
    from . import realise as realise
    from . import show as show
    from . import simulate as simulate
    from . import studies as studies
    from . import tuning as tuning
    from . import unexplained as unexplained
    from .base.errors import ExperimentError, ModelError
    from .base.errors import TeleopDesignError as TeleopDesignError
    from .blocks import Body, hand
    from .blocks import Value as Value
    from .controllers import CONTROLLERS, controller, from_control
    from .controllers import Controller as Controller
    from .controllers import load_controller as load_controller
    from .derive import all_transfers as derive_transfers
    from .derive import transfer_functions
    from .design import Assumptions as Assumptions
    from .design import Design as Design
    from .design import design as design_compensation
    from .diagnose import Comparison as Comparison
    from .diagnose import Diagnosis as Diagnosis
    from .diagnose import Ranking as Ranking
    from .diagnose import compare, find_missing, fit, load_answer, rank
    from .diagrams import ANY as ANY
    from .diagrams import Diagram, haptic_interface, read_diagram, teleoperator, write_diagram
    from .effects import EFFECTS, load_effect
    from .effects import Effect as Effect
    from .effects import FitSearch as FitSearch
    from .effects import Parameter as Parameter
    from .effects import State as State
    from .examples import example
    from .fitted_checks import check_experiment
    from .frequency import bode
    from .frequency import measured_impedance as measured_impedance
    from .measurement import Experiment, load_experiment
    from .measurement import Record as Record
    from .measurement.from_arrays import experiment
    from .measurement.recordings import fetch as fetch
    from .model import Model
    from .next_experiment import propose as propose_experiment
    from .passivity import Certificate as Certificate
    from .passivity import Claim as Claim
    from .passivity import diagram_claims, positive_real
    from .realise.iosystem import to_iosystem as to_iosystem
    from .simulate import Sampling, simulate_many, sine
    from .simulate import Simulation as Simulation
    from .simulate import simulate as simulate_diagram
    from .studies import MEASURES as MEASURES
    from .studies import Study as Study
    from .studies import latin_hypercube as latin_hypercube
    from .studies import measure, study
    from .studies import random_samples as random_samples
    from .studies import read_study as read_study
    from .studies import sensitivities as sensitivities
    from .studies import sensitivity_samples as sensitivity_samples
    from .studies import sobol as sobol
    from .tuning import fit_simulation as fit_simulation
    from .tuning import limit as limit
    from .tuning import trade_off as trade_off
    from .tuning import tune
    from .unexplained import describe

__all__ = [
    "Body",
    "CONTROLLERS",
    "Diagram",
    "EFFECTS",
    "Experiment",
    "ExperimentError",
    "Model",
    "ModelError",
    "Sampling",
    "bode",
    "check_experiment",
    "compare",
    "controller",
    "derive_transfers",
    "describe",
    "design_compensation",
    "diagram_claims",
    "example",
    "experiment",
    "find_missing",
    "fit",
    "from_control",
    "hand",
    "haptic_interface",
    "load_answer",
    "load_effect",
    "load_experiment",
    "measure",
    "positive_real",
    "propose_experiment",
    "rank",
    "read_diagram",
    "simulate_diagram",
    "simulate_many",
    "sine",
    "study",
    "teleoperator",
    "transfer_functions",
    "tune",
    "write_diagram",
]

#: group -> public name -> its folder, and its name in this folder if the two names differ. Python
#: looks up a name at its first use, so that `import teleopdesign` is instant
GROUPS: dict[str, dict[str, str]] = {
    "experiments": {
        "Experiment": "measurement",
        "experiment": "measurement.from_arrays",
        "load_experiment": "measurement",
        "check_experiment": "fitted_checks",
        "example": "examples",
    },
    "models": {
        "Model": "model",
        "Body": "blocks",
    },
    "effects": {
        "EFFECTS": "effects",
        "load_effect": "effects",
    },
    "diagnosis": {
        "fit": "diagnose",
        "compare": "diagnose",
        "rank": "diagnose",
        "find_missing": "diagnose",
        "load_answer": "diagnose",
        "describe": "unexplained",
        "propose_experiment": "next_experiment:propose",
    },
    "diagrams": {
        "Diagram": "diagrams",
        "haptic_interface": "diagrams",
        "teleoperator": "diagrams",
        "hand": "blocks",
        "read_diagram": "diagrams",
        "write_diagram": "diagrams",
    },
    "controllers": {
        "CONTROLLERS": "controllers",
        "controller": "controllers",
        "from_control": "controllers",
    },
    "responses": {
        "derive_transfers": "derive:all_transfers",
        "transfer_functions": "derive",
        "bode": "frequency",
        "simulate_diagram": "simulate:simulate",
        "simulate_many": "simulate",
        "Sampling": "simulate",
        "sine": "simulate",
    },
    "design": {
        "design_compensation": "design:design",
    },
    "studies": {
        "study": "studies",
        "measure": "studies",
        "tune": "tuning",
    },
    "passivity": {
        "diagram_claims": "passivity",
        "positive_real": "passivity",
    },
    "errors": {
        "ExperimentError": "base.errors",
        "ModelError": "base.errors",
    },
}
#: the same for names that `dir` does not list: classes of results, and the parts of definitions,
#: studies and recordings
FURTHER: dict[str, dict[str, str]] = {
    "results": {
        "Comparison": "diagnose",
        "Ranking": "diagnose",
        "Diagnosis": "diagnose",
        "Simulation": "simulate",
        "Design": "design",
        "Study": "studies",
        "Claim": "passivity",
        "Certificate": "passivity",
    },
    "parts of definitions": {
        "Value": "blocks",
        "ANY": "diagrams",
        "Effect": "effects",
        "Parameter": "effects",
        "FitSearch": "effects",
        "State": "effects",
        "Controller": "controllers",
        "load_controller": "controllers",
        "Assumptions": "design",
        "TeleopDesignError": "base.errors",
    },
    "parts of studies": {
        "read_study": "studies",
        "MEASURES": "studies",
        "latin_hypercube": "studies",
        "sobol": "studies",
        "random_samples": "studies",
        "sensitivity_samples": "studies",
        "limit": "tuning",
        "trade_off": "tuning",
        "sensitivities": "studies",
        "fit_simulation": "tuning",
    },
    "recordings": {
        "Record": "measurement",
        "fetch": "measurement.recordings",
        "measured_impedance": "frequency",
    },
    "exchange": {
        "to_iosystem": "realise.iosystem",
    },
}
_HOMES = {n: home for names in (*GROUPS.values(), *FURTHER.values()) for n, home in names.items()}
#: folders that are available as `td.NAME`, imported at their first use
_FOLDERS = (
    "app",
    "arms",
    "blocks",
    "check",
    "controllers",
    "derive",
    "design",
    "diagnose",
    "diagrams",
    "effects",
    "fitted_checks",
    "frequency",
    "identify",
    "measurement",
    "next_experiment",
    "passivity",
    "realise",
    "show",
    "simulate",
    "studies",
    "tuning",
    "unexplained",
)
__version__ = "0.1.0"
let_folders_be_called(__name__)


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        home, _, local = _HOMES[name].partition(":")
        value = getattr(import_module(f"{__name__}.{home}"), local or name)
        globals()[name] = value
        return value
    if name in _FOLDERS:
        return import_module(f"{__name__}.{name}")
    hint = ""
    if not name.startswith("_"):
        from .base.errors import did_you_mean

        hint = did_you_mean(name, (*_HOMES, *_FOLDERS))
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}{hint}")


def __dir__() -> list[str]:
    """The names that a user types, and the folders."""
    return sorted({*__all__, *_FOLDERS, *(n for n in globals() if n.startswith("__"))})
