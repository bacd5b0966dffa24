"""The simulation at a point of a study: a diagram with all arguments of `simulate`.

A parameter is named as in `Diagram.values` ("C.dahl.level"), or is one of the simulation:

    computer.delay, .period, .encoder_step, .velocity_bandwidth    of `Sampling`
    inputs.R_D, initial.L                          signals from outside and states at the start
    motion.L.amplitude, .frequency, .phase         of a motion made by `sine`
    duration, step, give                           s, s, m or rad
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, Literal

import numpy as np

from ..base.arguments import check_types
from ..base.errors import ModelError, unknown
from ..base.frozen import ByValue
from ..base.units import unit_of
from ..diagrams import Diagram
from ..diagrams.units import first_axis, unit_of_value
from ..simulate import Sampling, Setup, Simulation, Trajectory, prepare, simulate, sine
from ..simulate.sampling import SAMPLED
from ..simulate.units import signal_units

#: number of a computer that may be varied -> its unit; "": the unit of the first body's motion
_COMPUTER = {"period": "s", "delay": "s", "encoder_step": "", "velocity_bandwidth": "Hz"}
_SINE = {"amplitude": "", "frequency": "Hz", "phase": "rad"}
_OF_SIMULATION = {"duration": "s", "step": "s", "give": ""}


@check_types
@dataclass(frozen=True, eq=False)
class SimulatedCase(ByValue):
    """A diagram and the settings of its simulation; the arguments are those of `simulate`.

    duration: s; 0: no simulation; measures that need a motion are then refused
    """

    diagram: Diagram
    duration: float = 0.0
    inputs: Mapping[str, Any] = field(default_factory=dict)
    motion: Mapping[str, Trajectory] = field(default_factory=dict)
    initial: Mapping[str, float] = field(default_factory=dict)
    computer: Sampling | Literal["continuous"] = SAMPLED
    step: float = 1e-4
    give: float = 1e-5
    every_step: bool = False

    def simulate(self) -> Simulation:
        """Run the simulation; raises ModelError: no duration, or the errors of `simulate`."""
        if not self.duration:
            raise ModelError("duration: found none, expected the time to simulate, s")
        return simulate(self.diagram, **self.settings())

    def setup(self) -> Setup:
        """The simulation, ready to run; raises ModelError as `simulate` does."""
        return prepare(self.diagram, **self.settings_of_steps())

    def names(self) -> tuple[str, ...]:
        """Names of the parameters that can be varied; of initial states, only stated ones."""
        computer = [] if isinstance(self.computer, str) else [f"computer.{n}" for n in _COMPUTER]
        inputs = [f"inputs.{s}" for s in self.diagram.outside if s not in self.motion]
        initial = [f"initial.{s}" for s in self.initial]
        motions = [f"motion.{s}.{n}" for s, m in self.motion.items() if _is_sine(m) for n in _SINE]
        return (*self.diagram.values, *computer, *inputs, *initial, *motions, *_OF_SIMULATION)

    def check_names(self, names: Iterable[str]) -> None:
        """Raise ModelError, with the nearest name, for a name that is no parameter."""
        known = self.names()
        for name in names:
            if name in known or (name.startswith("initial.") and name.count(".") == 1):
                continue
            stem, _, rest = name.partition(".")
            if stem == "motion" and (motion := rest.rpartition(".")[0]) in self.motion:
                if not _is_sine(self.motion[motion]):
                    raise ModelError(f'"{name}": the motion of {motion} is none of `sine`')
            if stem == "computer" and isinstance(self.computer, str):
                raise ModelError(f'"{name}": the computer is "continuous"')
            raise ModelError(unknown("parameter", name, known))

    def with_values(self, values: Mapping[str, Any]) -> SimulatedCase:
        """The case with other values, by the names of `names`."""
        self.check_names(values)
        changes: dict[str, Any] = {n: values[n] for n in _OF_SIMULATION if n in values}
        computer: dict[str, float] = {}
        inputs, motion, initial = dict(self.inputs), dict(self.motion), dict(self.initial)
        within: dict[str, float] = {}
        known = self.diagram.values
        for name, value in values.items():
            stem, _, rest = name.partition(".")
            if name in known:
                within[name] = value
            elif stem == "computer":
                computer[rest] = value
            elif stem == "inputs":
                inputs[rest] = value
            elif stem == "initial":
                initial[rest] = value
            elif stem == "motion":
                signal, _, part = rest.rpartition(".")
                motion[signal] = sine(**{**_sine_parts(motion[signal]), part: value})
        if computer:
            changes["computer"] = replace(self.computer, **computer)  # type: ignore[type-var]
        diagram = self.diagram.with_values(within) if within else self.diagram
        return replace(
            self, diagram=diagram, inputs=inputs, motion=motion, initial=initial, **changes
        )

    def unit(self, name: str) -> str:
        """SI unit of a parameter; "1" where it has none."""
        stem, _, rest = name.partition(".")
        length = unit_of("position", first_axis(self.diagram))
        if name in self.diagram.values:
            return unit_of_value(self.diagram, name)
        if name in _OF_SIMULATION:
            return _OF_SIMULATION[name] or length
        if stem == "computer":
            return _COMPUTER.get(rest, "1") or length
        units = signal_units(self.diagram)
        if stem == "motion":
            signal, _, part = rest.rpartition(".")
            return _SINE.get(part, "1") or units(signal)
        return units(rest)

    def value(self, name: str) -> Any:
        """Present value of a parameter; None for an input that is no number."""
        stem, _, rest = name.partition(".")
        if name in self.diagram.values:
            return self.diagram.values[name]
        if name in _OF_SIMULATION:
            return getattr(self, name)
        if stem == "computer":
            return getattr(self.computer, rest)
        if stem == "motion":
            signal, _, part = rest.rpartition(".")
            return _sine_parts(self.motion[signal])[part]
        start = (self.inputs if stem == "inputs" else self.initial).get(rest, 0.0)
        return float(start) if np.ndim(start) == 0 and not callable(start) else None

    def settings(self) -> dict[str, Any]:
        """The settings of the simulation by name, without the diagram."""
        return {f.name: getattr(self, f.name) for f in fields(self) if f.name != "diagram"}

    def settings_of_steps(self) -> dict[str, Any]:
        """The settings without the one that says which rows of the result are kept."""
        return {n: v for n, v in self.settings().items() if n != "every_step"}


def case_of(diagram: Diagram | SimulatedCase, **settings: Any) -> SimulatedCase:
    """The diagram with settings of its simulation; a case is returned unchanged."""
    if isinstance(diagram, SimulatedCase):
        return diagram
    kept = {n: v for n, v in settings.items() if v is not None}
    return SimulatedCase(diagram, **kept)


def _is_sine(motion: Trajectory) -> bool:
    wanted = ("size", "rate", "phase")
    return all(hasattr(motion.position, name) for name in wanted)


def _sine_parts(motion: Trajectory) -> dict[str, float]:
    made: Any = motion.position
    return {"amplitude": made.size, "frequency": made.rate / (2 * np.pi), "phase": made.phase}
