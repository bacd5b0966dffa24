"""One object of each kind that a user holds, made once: for tests that go through all of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp
from study_models import product, value

import teleopdesign as td
from teleopdesign import (
    arms,
    block_cuts,
    blocks,
    derive,
    diagrams,
    frequency,
    next_experiment,
    passivity,
    simulate,
    studies,
)

BODY = td.Body(
    "prismatic",
    {"inertia": 0.15, "coulomb.level": 0.5, "viscous.damping": 2.0},
    (td.EFFECTS["coulomb"], td.EFFECTS["viscous"]),
)
LAW = td.controller("smoothed_coulomb", {"level": 0.4, "smoothing_velocity": 0.02})
LOW = td.controller("low_pass", {"bandwidth": 20.0})
COVARIANCE = frequency.ParameterCovariance(("Z_M.inertia", "Z_M.coulomb.level"), np.eye(2) * 1e-4)
HAND = td.hand(mass=0.2, damping=4.0, stiffness=300.0)


@lru_cache(maxsize=1)
def experiment() -> td.Experiment:
    return td.load_experiment(td.example("rod"))


@lru_cache(maxsize=1)
def model() -> td.Model:
    return td.fit(td.Model.from_experiment(experiment()), experiment())


@lru_cache(maxsize=1)
def diagnosis() -> td.Diagnosis:
    return td.find_missing(experiment(), among=["stribeck", "bias"])


@lru_cache(maxsize=1)
def diagram() -> td.Diagram:
    return td.haptic_interface(BODY, hand=HAND, cancellation=LAW, force_feedback=LOW.then(LOW))


@lru_cache(maxsize=1)
def simulation() -> td.Simulation:
    motion = {"L": td.sine(amplitude=0.01, frequency=2.0)}
    return td.simulate_diagram(diagram().without("Z_H"), duration=0.05, motion=motion, jit=False)


def _refuted() -> td.Claim:
    return passivity.dahl_compensation(
        coulomb_level=1, compensator_level=2, compensator_stiffness=1000
    )


def _response() -> frequency.FrequencyResponse:
    return td.bode(diagram(), frequency=np.array([1.0, 10.0]))


#: name -> what makes the object; those of a diagnosis take seconds
QUICK: Mapping[str, Callable[[], Any]] = {
    "experiment": experiment,
    "record": lambda: experiment().records[0],
    "model from an experiment": lambda: td.Model.from_experiment(experiment()),
    "body": lambda: BODY,
    "body with a wall": lambda: blocks.soft_rubber(
        HAND, stiffness=800.0, damping=2.0, level=0.3, give=5e-4
    ),
    "effect": lambda: td.EFFECTS["stribeck"],
    "effect of a block": lambda: blocks.CONTACT,
    "effect without a parameter": lambda: td.EFFECTS["presliding"].without("bristle_damping"),
    "catalogue": lambda: td.EFFECTS,
    "parameter": lambda: td.EFFECTS["stribeck"].parameters["stribeck_velocity"],
    "value": lambda: td.Value(2.0),
    "matrix impedance": lambda: blocks.matrix_impedance(mass=np.eye(2), damping=0.1),
    "controller": lambda: LAW.then(LOW).then(LOW),
    "controller of python-control": lambda: _from_control(),
    "diagram": diagram,
    "diagram without values": lambda: diagrams.load_shipped("teleoperator"),
    "diagram of parallel rods": lambda: diagrams.parallel_rods((BODY, BODY), np.eye(2)),
    "transfer functions": lambda: td.transfer_functions(diagrams.load_shipped("haptic-interface")),
    "all transfers": lambda: td.derive_transfers(diagrams.load_shipped("haptic-interface")),
    "simulation": simulation,
    "sampling": lambda: td.Sampling(delay=1e-3),
    "sine": lambda: td.sine(amplitude=0.01, frequency=1.5),
    "sampled motion": lambda: simulate.sampled_motion(np.linspace(0, 1, 20), np.zeros(20)),
    "strokes": lambda: passivity.Strokes((0.01, -0.01), 0.1),
    "force over velocity": lambda: simulate.force_velocity({"one": simulation()}),
    "frequency response": _response,
    "parameter covariance": lambda: COVARIANCE,
    "response band": lambda: (
        td.bode(diagram(), frequency=np.array([1.0, 10.0]), covariance=COVARIANCE).band
    ),
    "two-port functions": lambda: derive.two_port_functions(diagrams.load_shipped("teleoperator")),
    "proved claim": lambda: td.positive_real(0.15 * sp.Symbol("s") + 4),
    "refuted claim": _refuted,
    "certificate": lambda: td.positive_real(0.15 * sp.Symbol("s") + 4).certificates[0],
    "evidence": lambda: passivity.Evidence(True, "nothing", float("nan")),
    "two-port": lambda: passivity.teleoperator_two_port(master=1, slave=1, stiffness=100.0),
    "port energy": lambda: passivity.observe(
        np.linspace(0, 1, 50), np.linspace(0, 1, 50), np.ones(50)
    ),
    "drawing": lambda: _drawing(),
    "matrix response": lambda: frequency.matrix_response(
        diagram(), ["L"], ["R_V"], np.array([1.0, 10.0])
    ),
    "loop gain": lambda: frequency.loop_gain(diagram(), controller="H"),
    "impedance over amplitude": lambda: frequency.quasi_linear_impedance(
        diagram(), amplitude=[1e-3, 1e-2], frequency=[1.0, 2.0]
    ),
    "impedance": lambda: passivity.impedance(0.15 * sp.Symbol("s") + 4),
    "excess of damping": lambda: passivity.damping_excess(0.15 * sp.Symbol("s") + 4),
    "claim over intervals": lambda: passivity.claim_over_intervals(
        diagrams.haptic_interface(td.Body("prismatic", {"inertia": 0.1})),
        {"Z_M.inertia": (0.1, 0.2)},
    ),
    "claims on a diagram": lambda: passivity.diagram_claims(
        diagrams.haptic_interface(HAND), rng=np.random.default_rng(0)
    ),
    "Z-width": lambda: passivity.z_width(damping=2, sample_time=0.001),
    "available storage": lambda: passivity.available_storage(
        passivity.Dahl(0.5, 1e4), [passivity.Spring(1.0, 1e4)], points=5
    ),
    "trembling": lambda: passivity.Trembling(
        passivity.Dahl(0.5, 1e4), passivity.Dahl(1.0, 1e4), 1.0, 1e-3, 1e-5, -1e-6, 10
    ),
    "steady strokes": lambda: passivity.SteadyStrokes(
        0.5, 1e-3, passivity.Coulomb(0.4), 1.0, 0.01, 0.02
    ),
    "case of a study": lambda: studies.SimulatedCase(diagram(), duration=0.1),
    "measure": lambda: td.measure("rms", signal="R_M"),
    "samples": lambda: td.latin_hypercube({"Z_M.inertia": (0.1, 0.2)}, 4),
    "limit of a search": lambda: td.limit(td.measure("rms", signal="R_M"), most=1.0),
    "study": lambda: _study(),
    "assumptions": lambda: td.Assumptions(delay=1e-3),
    "limits of a motion": lambda: next_experiment.Limits(-0.1, 0.1, 1.0, 10.0, 1e3, 5.0),
    "spring of a contact": lambda: passivity.Spring(1.0, 1e4),
    "any block": lambda: td.ANY,
    "kinematics": lambda: diagrams.Kinematics("y", 2 * diagrams.position_symbol("x")),
    "search for a motion": lambda: passivity.Search(tries=3),
    "arm": lambda: arms.Chain((_link(),)),
    "base parameters": lambda: arms.base_parameters(arms.Chain((_link(), _link()))),
    "felt friction": lambda: diagrams.felt_friction(np.eye(2), [0.4, 0.5]),
    "diagram experiment": lambda: _diagram_experiment(),
    "cuts": lambda: _diagram_experiment().cuts,
    "channel proposal": lambda: _channel_proposal(),
    "logging plan": lambda: block_cuts.what_to_log(diagram()),
}
SLOW: Mapping[str, Callable[[], Any]] = {
    "model": model,
    "comparison": lambda: td.compare(model(), experiment()),
    "ranking": lambda: td.rank(model(), experiment()),
    "fit": lambda: diagnosis().last_fit,
    "diagnosis": diagnosis,
    "finding": lambda: td.check_experiment(experiment())[0],
    "description": lambda: td.describe(model(), experiment()),
    "design": lambda: _design(),
    "diagnosis of blocks": lambda: td.find_missing(_diagram_experiment(), at=["R_A"]),
    "verification": lambda: td.verify(_design(), experiment()),
}


def _study() -> td.Study:
    return td.study(product, {"x": [1.0, 2.0], "y": [0.5, 0.7]}, measures=value, workers=1)


@lru_cache(maxsize=1)
def _diagram_experiment() -> td.DiagramExperiment:
    log = td.simulate_diagram(diagram(), duration=2.0, inputs={"R_D": np.sin})
    names = ("R_A", "R_M", "L")
    data = {n: log[n].values for n in names}
    data |= {"t": log.data["time"].values, "R_D": np.sin(log.data["time"].values)}
    channels = {n: {"column": n, "unit": "N"} for n in ("R_D", "R_A", "R_M")}
    channels |= {"time": {"column": "t", "unit": "s"}, "L": {"column": "L", "unit": "m"}}
    return td.diagram_experiment(
        diagram(), data, channels=channels, outside=["R_V"], sample_period=1e-3, bandwidth=60
    )


def _channel_proposal() -> block_cuts.ChannelProposal:
    columns = _diagram_experiment().logs[0].columns.values
    return block_cuts.propose_channels(diagram(), dict(columns))


def _link() -> arms.Link:
    inertial = arms.inertia_about(2.0, np.array([0.0, 0.0, 0.1]), np.diag([0.02, 0.02, 0.01]))
    axis, origin = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 0.3])
    return arms.Link("link", "joint", "revolute", axis, np.eye(3), origin, inertial)


def _drawing() -> Any:
    from teleopdesign.show import draw_diagram

    return draw_diagram(diagram())


@lru_cache(maxsize=1)
@lru_cache(maxsize=1)
def _design() -> td.Design:
    return td.design_compensation(diagnosis())


def _from_control() -> td.Controller:
    import control

    return td.from_control(control.tf([1.0], [0.01, 1.0]), name="lag")
