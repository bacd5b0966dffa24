"""Motors whose force varies along the stroke: coils that leave the field, waves of teeth."""

import numpy as np
import pytest
from diagnose.made_records import write_made

import teleopdesign as td

FRICTION = "coulomb = { level = 0.02 }\nviscous = { damping = 0.01 }"
INERTIA = 0.01  # kg m^2
#: what depends on the place or the command, and what that is mistaken for
CANDIDATES = (
    "actuator_gain bias cogging cogging_harmonic coulomb coulomb_asymmetry hardening_spring "
    "load_dependent_friction position_dependent_friction position_dependent_gain quadratic_drag "
    "shear_thinning spring stribeck torque_ripple viscous viscous_asymmetry"
).split()


def sway(seed, size, fastest=4.0, tones=12):
    """A motion of many tones, so that each place is passed at many speeds; rad of s."""
    rng = np.random.default_rng(seed)
    frequencies, phases = rng.uniform(0.15, fastest, tones), rng.uniform(0.0, 2 * np.pi, tones)

    def motion(t):
        waves = np.sin(2 * np.pi * np.outer(frequencies, t) + phases[:, None])
        return size * (waves / np.sqrt(frequencies)[:, None]).sum(axis=0) / tones

    return motion


def friction(v):
    return 0.03 * np.sign(v) + 0.012 * v


def diagnose(folder, force, size, **changed):
    records = {"fit": [(12.0, sway(1, size))], "check": [(10.0, sway(2, size))]}
    write_made(
        folder, records, force, effects=FRICTION, step=2e-5, noise=2e-3, bandwidth=60,
        inertia=INERTIA, rate=1000, fixed=False, **changed,
    )  # fmt: skip
    return td.find_missing(td.load_experiment(folder), among=CANDIDATES)


def named(diagnosis):
    return [c.effect.name for c in diagnosis.missing]


def value(diagnosis, name):
    return diagnosis.model.parameters[f"device.{name}"]


@pytest.mark.slow
def test_a_gain_that_falls_to_the_ends_of_the_stroke_is_named_and_not_a_hardening_spring(tmp_path):
    fall, centre = 2.0, 0.05  # 1/rad^2, rad

    def force(t, x, v):
        inertial = INERTIA * np.gradient(v, t)
        needed = inertial + friction(v) + 0.3 * x
        return needed / (1 - fall * (x - centre) ** 2) - inertial

    diagnosis = diagnose(tmp_path, force, size=0.4)
    assert sorted(named(diagnosis)) == ["position_dependent_gain", "spring"]
    for name, true in (("fall", fall), ("centre", centre)):
        fitted = value(diagnosis, f"position_dependent_gain.{name}")
        assert abs(fitted.value - true) < 5 * fitted.stderr
        assert abs(fitted.value - true) < 0.05 * true


@pytest.mark.slow
@pytest.mark.parametrize("parts", [3])
def test_a_second_wave_of_cogging_is_named_beside_the_first(parts, tmp_path):
    period = 2 * np.pi / 24

    def force(t, x, v):
        first = 0.05 * np.sin(2 * np.pi * x / period + 1.0)
        return friction(v) + first + 0.02 * np.sin(2 * np.pi * parts * x / period + 2.0)

    diagnosis = diagnose(tmp_path, force, size=1.2)
    assert named(diagnosis) == ["cogging", "cogging_harmonic"]
    for name, true in (("cogging.amplitude", 0.05), ("cogging_harmonic.amplitude", 0.02)):
        fitted = value(diagnosis, name)
        assert abs(fitted.value - true) < max(5 * fitted.stderr, 0.03 * true)
    fitted = value(diagnosis, "cogging_harmonic.period")
    assert fitted.value == pytest.approx(period / parts, rel=1e-3)


@pytest.mark.slow
def test_of_one_sine_no_gain_over_the_place_is_named(tmp_path):
    """Each place is passed at one speed: friction that flattens with speed looks the same."""

    def sine(t):
        return 0.8 * np.sin(2 * np.pi * 0.5 * t)

    def force(t, x, v):
        return 0.03 * np.sign(v) + 0.08 * np.sign(v) * np.abs(v) ** 0.4

    write_made(
        tmp_path, {"fit": [(12.0, sine)], "check": [(8.0, sine)]}, force, effects=FRICTION,
        step=2e-5, noise=2e-3, bandwidth=60, inertia=INERTIA, rate=1000, fixed=False,
    )  # fmt: skip
    diagnosis = td.find_missing(td.load_experiment(tmp_path), among=CANDIDATES)
    assert "position_dependent_gain" not in named(diagnosis)
