"""A residual is drawn over the variable that carries the effect."""

from types import SimpleNamespace

import matplotlib.pyplot as plt
import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.show.figures.carrier import carrier_of


def diagnosis_with(name, values):
    body = td.Body("revolute", {"inertia": 0.01}).with_effect(td.EFFECTS["coulomb"], {"level": 0.2})
    effect = td.EFFECTS[name]
    model = td.Model({"device": body.with_effect(effect, values)})
    added = SimpleNamespace(effect=effect, at="device")
    rungs = (SimpleNamespace(added=None), SimpleNamespace(added=added))
    return SimpleNamespace(rungs=rungs, model=model)


@pytest.mark.parametrize(
    "name, values, variable",
    [
        ("stribeck", {"extra_static_level": 0.1, "stribeck_velocity": 0.1}, "velocity"),
        ("spring", {"stiffness": 0.4}, "position"),
        ("load_dependent_friction", {"coefficient": 0.2}, "command"),
        ("actuator_gain", {"gain": 0.9}, "command"),
    ],
)
def test_an_effect_is_carried_by_what_its_law_depends_on(name, values, variable):
    assert carrier_of(diagnosis_with(name, values), "device").words == variable


def test_a_wave_is_folded_into_its_period_so_that_one_sees_it_once():
    wave = {"amplitude": 0.1, "period": 2 * np.pi / 11, "phase": 0.3}
    carrier = carrier_of(diagnosis_with("cogging", wave), "device")
    places = np.linspace(-3, 3, 501)
    folded = carrier.values({"position": places})
    assert folded.min() >= 0 and folded.max() < wave["period"]
    angle = 2 * np.pi / wave["period"]
    np.testing.assert_allclose(np.sin(angle * folded), np.sin(angle * places), atol=1e-9)
    assert carrier.label("revolute") == "position in a period of 0.5712 rad, 11.0 a turn"


def test_a_comparison_beside_another_shows_both_on_one_scale_over_what_carries_the_effect():
    experiment = td.load_experiment(td.example("rod"))
    stated = td.Model.from_experiment(experiment)
    spring = stated.with_effect("spring", values={"stiffness": 30.0})
    before, after = (td.compare(model, experiment) for model in (stated, spring))
    for one, other, error in ((after, before, before), (before, after, after)):
        force, time, left, right = one.plot(before=other).axes
        assert left.get_xlabel() == right.get_xlabel() == "position (m)"
        assert left.get_ylim() == right.get_ylim()
        assert left.get_title("left").endswith(f"{100 * error.check_error:.2f} %")
        assert len(force.lines) == 3 and len(time.lines) == 2
    plt.close("all")
