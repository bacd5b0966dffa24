"""The start of a search: every form of an effect at its least-squares strength, without a step."""

from dataclasses import replace

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.diagnose.candidates import make_starts
from teleopdesign.diagnose.fit import estimate, free_parameters
from teleopdesign.diagnose.linear_start import Promises, linear_starts
from teleopdesign.diagnose.search import estimate_from_starts
from teleopdesign.diagnose.search_plan import EFFORTS
from teleopdesign.diagnose.solve import solve
from teleopdesign.effects import EFFECTS
from teleopdesign.measurement.experiment import Experiment
from teleopdesign.measurement.prepare import prepare

PERIOD, AMPLITUDE, PHASE = 7.3e-4, 0.08, 2.0  # m: travel of some fifty periods; N; rad


@pytest.fixture(scope="module")
def cogged() -> Experiment:
    """The shipped rod, Stribeck friction in its model, and a fine cogging added to its motor."""
    experiment = td.load_experiment(td.example("rod"))
    wave = 2 * np.pi / PERIOD

    def driven(record):
        force = AMPLITUDE * np.sin(wave * record.signals["device.position"] + PHASE)
        signals = dict(record.signals)
        # a command that overcomes the cogging; held for a sample of a thousandth of a second
        signals["device.actuator_force"] = signals["device.actuator_force"] + force
        return replace(record, signals=signals)

    return replace(experiment, records=tuple(driven(r) for r in experiment.records))


@pytest.fixture(scope="module")
def base(cogged):
    model = td.Model.from_experiment(cogged).with_effect(
        "stribeck", values={"extra_static_level": 0.2, "stribeck_velocity": 0.022}
    )
    return estimate(model, prepare(cogged))


def test_the_start_of_a_linear_effect_is_where_the_search_ends(cogged, base):
    """Bias and damping enter the residual linearly but for friction that balances."""
    prepared = prepare(cogged)
    model = base.model.with_effect("bias")
    (start,) = linear_starts([model], EFFECTS["bias"], "device", prepared, base)
    exact = estimate_from_starts(model, prepared).model.parameters["device.bias.force"]
    assert start.model.parameters["device.bias.force"].value == pytest.approx(
        exact.value, abs=3 * exact.stderr
    )


def test_a_promise_is_what_one_step_leaves(cogged, base):
    """A step by the base's parameters, at the base, and by those of the effect, at the start."""
    prepared = prepare(cogged)
    starts = make_starts(base.model.with_effect("presliding"), prepared.scales)
    promises = Promises(prepared, base)
    for start in (starts[0], starts[-1]):
        free = free_parameters(start)
        there = solve(start, free, prepared, prepared.of("fit"), EFFORTS.evaluation)
        new = [i for i, name in enumerate(free) if name not in base.free]
        columns = np.hstack([base.jacobian, base.by_shift, there.jacobian[:, new]])
        step = np.linalg.lstsq(columns, -there.residual, rcond=None)[0]
        left = there.residual + columns @ step
        assert promises.squares(start) == pytest.approx(float(left @ left), rel=1e-6)
