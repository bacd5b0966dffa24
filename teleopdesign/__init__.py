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
    controllers   CONTROLLERS, controller, cancel
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
    block_cuts    a whole diagram against its recording: which block is wrong, by which effect
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

from .base.arguments import type_imports
from .base.errors import did_you_mean
from .base.folders import let_folders_be_called

if TYPE_CHECKING:
    from . import app as app
    from . import arms as arms
    from . import block_cuts as block_cuts
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
    from .base.errors import ExperimentError as ExperimentError
    from .base.errors import ModelError as ModelError
    from .base.errors import TeleopDesignError as TeleopDesignError
    from .block_cuts import BlockDiagnosis as BlockDiagnosis
    from .block_cuts import DiagramExperiment as DiagramExperiment
    from .block_cuts import compare as compare
    from .block_cuts import describe as describe
    from .block_cuts import diagram_experiment as diagram_experiment
    from .block_cuts import find_missing as find_missing
    from .block_cuts import load_answer as load_answer
    from .block_cuts import load_experiment as load_experiment
    from .block_cuts import rank as rank
    from .blocks import Body as Body
    from .blocks import Value as Value
    from .blocks import hand as hand
    from .controllers import CONTROLLERS as CONTROLLERS
    from .controllers import Controller as Controller
    from .controllers import cancel as cancel
    from .controllers import controller as controller
    from .controllers import from_control as from_control
    from .controllers import load_controller as load_controller
    from .derive import all_transfers as derive_transfers
    from .derive import transfer_functions as transfer_functions
    from .design import Assumptions as Assumptions
    from .design import Design as Design
    from .design import design as design_compensation
    from .design import verify as verify
    from .diagnose import Comparison as Comparison
    from .diagnose import Diagnosis as Diagnosis
    from .diagnose import Ranking as Ranking
    from .diagnose import fit as fit
    from .diagrams import ANY as ANY
    from .diagrams import Diagram as Diagram
    from .diagrams import haptic_interface as haptic_interface
    from .diagrams import read_diagram as read_diagram
    from .diagrams import teleoperator as teleoperator
    from .diagrams import write_diagram as write_diagram
    from .effects import EFFECTS as EFFECTS
    from .effects import Effect as Effect
    from .effects import FitSearch as FitSearch
    from .effects import Parameter as Parameter
    from .effects import State as State
    from .effects import load_effect as load_effect
    from .examples import example as example
    from .fitted_checks import check_experiment as check_experiment
    from .frequency import bode as bode
    from .frequency import measured_impedance as measured_impedance
    from .measurement import Experiment as Experiment
    from .measurement import Record as Record
    from .measurement.from_arrays import experiment as experiment
    from .measurement.new_curve import friction_curve as friction_curve
    from .measurement.recordings import fetch as fetch
    from .model import Model as Model
    from .next_experiment import propose as propose_experiment
    from .passivity import Certificate as Certificate
    from .passivity import Claim as Claim
    from .passivity import diagram_claims as diagram_claims
    from .passivity import positive_real as positive_real
    from .realise.iosystem import to_iosystem as to_iosystem
    from .simulate import Sampling as Sampling
    from .simulate import Simulation as Simulation
    from .simulate import simulate as simulate_diagram
    from .simulate import simulate_many as simulate_many
    from .simulate import sine as sine
    from .studies import MEASURES as MEASURES
    from .studies import Study as Study
    from .studies import latin_hypercube as latin_hypercube
    from .studies import measure as measure
    from .studies import random_samples as random_samples
    from .studies import read_study as read_study
    from .studies import sensitivities as sensitivities
    from .studies import sensitivity_samples as sensitivity_samples
    from .studies import sobol as sobol
    from .studies import study as study
    from .tuning import fit_simulation as fit_simulation
    from .tuning import limit as limit
    from .tuning import trade_off as trade_off
    from .tuning import tune as tune

# fmt: off
#: group -> the public names that a user types
GROUPS = {
    "experiments": ("Experiment", "experiment", "load_experiment", "check_experiment", "example"),
    "models": ("Model", "Body"),
    "effects": ("EFFECTS", "load_effect"),
    "diagnosis": (
        "fit", "compare", "rank", "find_missing", "load_answer", "describe",
        "propose_experiment",
    ),
    "diagrams": (
        "Diagram", "haptic_interface", "teleoperator", "hand", "read_diagram", "write_diagram",
    ),
    "controllers": ("CONTROLLERS", "controller", "cancel"),
    "responses": (
        "derive_transfers", "transfer_functions", "bode", "simulate_diagram", "simulate_many",
        "Sampling", "sine",
    ),
    "design": ("design_compensation",),
    "studies": ("study", "measure", "tune"),
    "passivity": ("diagram_claims", "positive_real"),
    "errors": ("ExperimentError", "ModelError"),
}
#: group -> names that `dir` does not list: classes of results, parts of definitions, studies and
#: recordings
FURTHER = {
    "results": (
        "Comparison", "Ranking", "Diagnosis", "BlockDiagnosis", "Simulation", "Design", "Study",
        "Claim", "Certificate",
    ),
    "parts of definitions": (
        "Value", "ANY", "Effect", "Parameter", "FitSearch", "State", "Controller",
        "load_controller", "Assumptions", "TeleopDesignError",
    ),
    "parts of studies": (
        "read_study", "MEASURES", "latin_hypercube", "sobol", "random_samples",
        "sensitivity_samples", "limit", "trade_off", "sensitivities", "fit_simulation",
    ),
    "recordings": (
        "Record", "DiagramExperiment", "diagram_experiment", "friction_curve", "fetch",
        "measured_impedance", "verify",
    ),
    "exchange": ("to_iosystem", "from_control"),
}
#: these have another name in their folders; type checkers see all others by their imports
__all__ = ["derive_transfers", "design_compensation", "propose_experiment", "simulate_diagram"]
__all__ += [name for names in GROUPS.values() for name in names if name not in __all__]
# fmt: on
__version__ = "0.1.0"
let_folders_be_called(__name__)


def __getattr__(name: str) -> Any:
    """A name of the imports above, which are for type checkers: imported at its first use."""
    if name.startswith("__"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    homes = type_imports(__name__)
    if name in homes:
        home, local = homes[name]
        if home == __name__:
            return import_module(f"{home}.{name}")
        globals()[name] = value = getattr(import_module(home), local)
        return value
    raise AttributeError(
        f"module {__name__!r} has no attribute {name!r}{did_you_mean(name, homes)}"
    )


def __dir__() -> list[str]:
    """The names that a user types, and the folders."""
    folders = (n for n, (home, _) in type_imports(__name__).items() if home == __name__)
    return sorted({*__all__, *folders, *(n for n in globals() if n.startswith("__"))})
