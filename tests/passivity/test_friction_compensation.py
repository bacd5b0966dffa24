"""How much friction may be cancelled: Coulomb, presliding, changing level, LuGre."""

import math

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.passivity import (
    bounded_compensation,
    dahl_compensation,
    largest_one_off_energy,
    largest_passive_level,
    largest_ratio,
    lugre_passivity,
    onset_amplitude,
    read_record,
    region,
    self_motion_speed,
    write_record,
)
from teleopdesign.passivity.rate_independent import (
    Coulomb,
    Cycle,
    Dahl,
    Spring,
    dahl_loss,
    symmetric_cycle,
)
from teleopdesign.simulate import simulate, sine


def compensated(level, stiffness=1e4, **true):
    """True friction of 1 N, unless said otherwise."""
    arguments = {"coulomb_level": 1} | true
    return dahl_compensation(compensator_level=level, compensator_stiffness=stiffness, **arguments)


@pytest.mark.parametrize("level", [0.1, 0.999999, 1])
def test_coulomb_friction_covers_any_compensator_up_to_its_level(level):
    claim = compensated(level)
    assert claim.status == "proved"
    assert claim.verdict.margin == pytest.approx(1 - level)
    assert (claim.verdict.equality != "") == (level == 1)
    assert bounded_compensation(coulomb_level=1, bound=level).status == "proved"


def test_at_the_least_level_the_highest_one_still_refutes():
    """f_D = f_C: short motion gives out energy where the level is the highest, not the least."""
    alone = compensated(1, stiffness=900, presliding_stiffness=1000)
    assert alone.status == "proved"
    changing = compensated(1, stiffness=900, presliding_stiffness=1000, highest_level=2)
    assert changing.status == "refuted"


@pytest.mark.parametrize("level", [1.000001, 1.05, 3])
def test_the_bound_is_tight(level, tmp_path):
    """However little above f_C, a long enough stroke gives out energy, and again."""
    for claim in (compensated(level), bounded_compensation(coulomb_level=1, bound=level)):
        assert claim.status == "refuted"
        write_record(claim.record, tmp_path / "motion.json")
        assert read_record(tmp_path / "motion.json").replay() > 0


def test_a_record_whose_energy_is_not_confirmed_is_refused(tmp_path):
    file = tmp_path / "motion.json"
    write_record(compensated(1.5).record, file)
    file.write_text(file.read_text().replace('"energy": ', '"energy": 1'))
    with pytest.raises(ModelError, match="the replay releases"):
        read_record(file)
    file.write_text("[]")
    with pytest.raises(ModelError, match="no record of a motion"):
        read_record(file)


@settings(max_examples=60)
@given(
    st.floats(0.1, 1.0),
    st.floats(1.0, 1e6),
    st.lists(st.floats(-1, 1), min_size=1, max_size=20),
)
def test_no_path_takes_energy_out_below_the_bound(level, stiffness, travels):
    """Exact integration along any turning points, from rest: supply is never negative."""
    force, given_out = 0.0, 0.0
    for travel in travels:
        force, work = Dahl(level, stiffness).leg(force, travel)
        given_out += work - abs(travel)
    assert given_out <= 1e-12


# --- cycles -----------------------------------------------------------------------------------


@pytest.mark.parametrize("u", [1e-4, 0.03, 0.7, 3.0, 40.0])
def test_the_loss_of_a_cycle_is_the_closed_form(u):
    """4 f A (1 - tanh(u)/u) from travel by travel, once the start is forgotten."""
    level, stiffness = 0.7, 2e4
    amplitude = u * level / stiffness
    cycle = symmetric_cycle(Dahl(level, stiffness), [], amplitude)
    expected = 4 * level * amplitude * (1 - math.tanh(u) / u) if u > 1e-2 else None
    loss = dahl_loss(level, stiffness, amplitude)
    if expected is not None:
        assert loss == pytest.approx(expected, rel=1e-9)
    assert cycle.energy == pytest.approx(loss, rel=1e-6)


def test_a_travel_in_parts_is_a_travel_at_once():
    for element in (Coulomb(1.0), Dahl(1.0, 50.0), Spring(1.0, 50.0)):
        whole = element.leg(-0.4, 0.05)
        force, total = -0.4, 0.0
        for _ in range(10):
            force, work = element.leg(force, 0.005)
            total += work
        assert (force, total) == pytest.approx(whole, rel=1e-9)


ONSETS = {1.02: 51.0, 1.05: 21.0, 1.1: 11.0, 1.2: 6.0, 1.5: 2.985, 2.0: 1.915}


@pytest.mark.parametrize("ratio", ONSETS)
def test_the_onset_agrees_with_a_search_to_a_tenth_of_a_percent(ratio):
    """f_D (1 - tanh(u)/u) = f_C at u = sigma_D A/f_D; figures of the closed form."""
    from scipy.optimize import brentq

    stiffness = 2e4
    onset = onset_amplitude(
        coulomb_level=1, compensator_level=ratio, compensator_stiffness=stiffness
    )
    u = onset * stiffness / ratio
    exact = brentq(lambda x: ratio * (1 - math.tanh(x) / x) - 1, 0.1, 100)
    assert u == pytest.approx(exact, rel=1e-3)
    assert u == pytest.approx(ONSETS[ratio], rel=1e-3)


def test_there_is_no_onset_without_over_compensation():
    assert (
        onset_amplitude(coulomb_level=1, compensator_level=1, compensator_stiffness=1e4) == math.inf
    )


def test_the_compiled_simulation_finds_the_same_onset():
    """A rod with Coulomb friction and the compensator, moved by a slow sine: within 0.1 %.

    The energy that the hand puts in per cycle changes sign at the onset; it is interpolated between
    1 % below and 1 % above, over which its curvature moves the root by 1e-4.
    """
    level, stiffness, f_c = 0.75, 1e4, 0.5
    onset = onset_amplitude(
        coulomb_level=f_c, compensator_level=level, compensator_stiffness=stiffness
    )
    rod = td.Body("prismatic", {"inertia": td.Value(1e-3)})
    rod = rod.with_effect(td.EFFECTS["coulomb"], {"level": f_c})
    law = controller("dahl", {"level": level, "stiffness": stiffness})

    def put_in(amplitude):
        result = simulate(
            haptic_interface(rod, cancellation=law),
            duration=6.0,
            motion={"L": sine(amplitude=amplitude, frequency=0.5)},
            give=1e-9,
            computer="continuous",
            every_step=True,
        )
        last = result["time"].values >= 4.0 - 1e-9  # the third cycle: the start is forgotten
        return np.trapezoid(result["R_V"].values[last], result["L"].values[last])

    below, above = put_in(0.99 * onset), put_in(1.01 * onset)
    assert below > 0 > above
    assert 0.99 + 0.02 * below / (below - above) == pytest.approx(1.0, abs=1e-3)


def test_a_soft_compensator_hides_over_compensation_until_motion_is_large():
    """The curve of largest level over amplitude; where it is finite, a cycle just balances."""
    for amplitude in (3e-4, 1e-3, 1e-2):
        level = largest_passive_level(coulomb_level=1, stiffness=1e4, amplitude=amplitude)
        if math.isfinite(level):
            assert dahl_loss(level, 1e4, amplitude) == pytest.approx(4 * amplitude, rel=1e-9)
    soft, stiff = (
        largest_passive_level(coulomb_level=1, stiffness=k, amplitude=1e-2) for k in (1e3, 1e5)
    )
    assert 1 < stiff < soft
    assert largest_passive_level(coulomb_level=1, stiffness=1e3, amplitude=1e-4) == math.inf


def test_viscous_damping_bounds_the_speed_of_self_motion():
    assert self_motion_speed(coulomb_level=1, compensator_level=1.5, damping=10) == 0.05
    assert self_motion_speed(coulomb_level=1, compensator_level=0.5, damping=0) == 0
    assert self_motion_speed(coulomb_level=1, compensator_level=2, damping=0) == math.inf


# --- true friction with presliding ------------------------------------------------------------


@pytest.mark.parametrize(
    ("level", "stiffness", "presliding_stiffness", "status"),
    [
        (0.9, 1e3, 2e3, "proved"),
        (1, 1e3, 2e3, "proved"),
        (1, 2e3, 2e3, "proved"),  # the same friction
        (0.25, 1e3, 2e3, "proved"),  # sigma_D^2/f_D = sigma_p^2/f_C
        (0.2499, 1e3, 2e3, "refuted"),
        (0.9, 2e3, 2e3, "refuted"),
        (0.9, 3e3, 2e3, "refuted"),
        (1.01, 1e3, 2e3, "refuted"),
        (1.01, 2e3, 2e3, "refuted"),
    ],
)
def test_presliding_asks_for_a_soft_compensator(level, stiffness, presliding_stiffness, status):
    """Passive iff f_D <= f_C and sigma_D^2/f_D <= sigma_p^2/f_C, equality included."""
    claim = compensated(level, stiffness, presliding_stiffness=presliding_stiffness)
    assert claim.status == status
    if status == "refuted":
        assert claim.record.replay() > 0


def test_less_level_at_the_same_stiffness_is_worse():
    """sigma_D^2/f_D grows: lowering f_D alone turns proof into refutation."""
    assert compensated(0.5, 1e3, presliding_stiffness=1.5e3).status == "proved"
    assert compensated(0.3, 1e3, presliding_stiffness=1.5e3).status == "refuted"


def test_the_region_is_the_wedge_of_the_formula():
    """(sigma_D/sigma_p)^2 <= f_D/f_C <= 1, at every point of a grid."""
    softness, share = np.array([0.2, 0.5, 0.9, 1.1]), np.array([0.1, 0.5, 0.85, 1.0, 1.1])
    plane = region(lambda x, y: compensated(y, 1e3 * x, presliding_stiffness=1e3), softness, share)
    expected = (softness[None, :] ** 2 <= share[:, None]) & (share[:, None] <= 1)
    assert np.array_equal(plane.status == "proved", expected)
    assert np.array_equal(plane.status == "refuted", ~expected)


@settings(max_examples=100)
@given(
    st.floats(0.05, 1.0),
    st.floats(0.05, 1.0),
    st.lists(st.floats(-3, 3), min_size=2, max_size=12),
)
def test_no_closed_path_takes_energy_out_inside_the_wedge(share, softness, points):
    """Random closed paths in bristle lengths: the storage function of the proof forbids it."""
    bristle_stiffness = 1e3
    stiffness = (
        bristle_stiffness * softness * math.sqrt(share)
    )  # inside: (sigma_D/sigma_p)^2 <= f_D/f_C
    path = tuple(1e-3 * x for x in points)
    cycle = Cycle(Dahl(share, stiffness), (Dahl(1.0, bristle_stiffness),), path, rounds=40)
    assert cycle.energy <= 1e-12


@settings(max_examples=60)
@given(
    st.lists(st.tuples(st.floats(-2, 2), st.floats(0.5, 0.8)), min_size=1, max_size=25),
    st.floats(0.05, 1.0),
)
def test_a_changing_level_never_gives_out_what_was_not_stored(legs, softness):
    """Level anywhere in 0.5 to 0.8 N, from rest; compensated for the lowest, soft for the highest.

    V starts at 0, so the supply stays >= 0 along any path.
    """
    bristle_stiffness, level = 1e3, 0.5
    stiffness = softness * bristle_stiffness * math.sqrt(level / 0.8)
    plant = helper = energy = 0.0
    for travel, now in legs:
        plant, lost = Dahl(now, bristle_stiffness).leg(plant, 1e-3 * travel)
        helper, given_out = Dahl(level, stiffness).leg(helper, 1e-3 * travel)
        energy += lost - given_out
    assert energy >= -1e-15


@pytest.mark.parametrize(("top", "status"), [(0.8, "proved"), (0.81, "refuted")])
def test_a_changing_level_asks_for_its_lowest_and_its_highest(top, status):
    """f_D <= F_min and sigma_D^2/f_D <= sigma_p^2/F_max: equality at 0.8 N."""
    claim = dahl_compensation(
        coulomb_level=0.5,
        highest_level=top,
        compensator_level=0.2,
        compensator_stiffness=1e3,
        presliding_stiffness=2e3,
    )
    assert claim.status == status


def test_the_storage_function_is_the_one_in_the_documentation():
    """V >= 0, and 0 only at rest: both bristles relaxed."""
    d, p, sigma_D, sigma_p = sp.symbols("d p sigma_D sigma_p")
    claim = compensated(0.9, 1e3, presliding_stiffness=2e3)
    storage = sp.sympify(
        claim.certificates[0].content["storage"],
        locals={x.name: x for x in (d, p, sigma_D, sigma_p)},
    )
    total, softer = sigma_p + sigma_D, sigma_p - sigma_D
    expected = (total * (p**2 / sigma_p + d**2 / sigma_D) / 2 - 2 * p * d) / softer
    assert sp.simplify(storage - expected) == 0


@pytest.mark.parametrize(
    "changes",
    [
        {"level": 0},
        {"level": -1},
        {"level": float("nan")},
        {"stiffness": 0},
        {"presliding_stiffness": 0},
        {"highest_level": 0.5},
    ],
)
def test_levels_that_make_no_sense_are_one_clear_line(changes):
    with pytest.raises(ModelError, match="level|stiffness|finite"):
        compensated(**({"level": 0.5} | changes))


# --- LuGre ------------------------------------------------------------------------------------


def lugre(viscous):
    return lugre_passivity(
        coulomb_level=0.5,
        static_level=0.6,
        stiffness=1e5,
        bristle_damping=20,
        viscous_damping=viscous,
        stribeck_velocity=0.005,
    )


@pytest.mark.parametrize(("viscous", "status"), [(4, "proved"), (5, "proved"), (3.9, "refuted")])
def test_lugre_needs_viscous_damping_for_its_bristle_damping(viscous, status):
    """s2 >= s1 (F_S/F_C - 1) = 4 N s/m, equality included."""
    claim = lugre(viscous)
    assert claim.status == status


def test_the_refutation_of_lugre_is_a_solution_of_its_equation(tmp_path):
    """The last round once more with small steps of the equation itself."""
    record = lugre(0.4).record
    write_record(record, tmp_path / "motion.json")
    assert read_record(tmp_path / "motion.json").replay() == pytest.approx(record.energy)
    y, given_out = 0.0, 0.0
    s1, s2 = record.dampings
    for _ in range(record.rounds):
        given_out = 0.0
        for velocity, travel in record.legs:
            n = 4000
            dt = travel / abs(velocity) / n
            for _ in range(n):
                rate = record.stiffness * (velocity - abs(velocity) * y / record.level(velocity))
                middle = y + rate * dt / 2
                rate = record.stiffness * (
                    velocity - abs(velocity) * middle / record.level(velocity)
                )
                force = middle + s1 * rate / record.stiffness + s2 * velocity
                given_out -= force * velocity * dt
                y += rate * dt
    assert given_out == pytest.approx(record.energy, rel=1e-3)


def test_without_bristle_damping_lugre_is_always_passive():
    claim = lugre_passivity(
        coulomb_level=0.5,
        static_level=0.9,
        stiffness=1e5,
        bristle_damping=0,
        viscous_damping=0,
        stribeck_velocity=0.01,
    )
    assert claim.status == "proved"


@settings(max_examples=200)
@given(
    u=st.floats(0.05, 4.0),
    points=st.lists(st.floats(-1.0, 1.0), min_size=2, max_size=12),
)
def test_closed_paths_give_out_nothing_and_one_off_motions_no_more_than_the_bristle_holds(
    u, points
):
    """At the ratio for closed paths, within u bristle lengths; 1e-12: rounding of the energies."""
    f_c, stiffness = 0.5, 1e4
    f_d = f_c * largest_ratio(u, motion="closed paths")
    path = tuple(x * u * f_d / stiffness for x in points)
    cycle = Cycle(Dahl(f_d, stiffness), (Coulomb(f_c),), path, rounds=400)
    size = f_d * sum(abs(b - a) for a, b in zip(path, path[1:], strict=False)) + 1e-30
    assert cycle.energy <= 1e-12 * size
    helps, force, here, out = Dahl(f_d, stiffness), 0.0, 0.0, 0.0
    for point in path:
        force, work = helps.leg(force, point - here)
        out, here = out + work - f_c * abs(point - here), point
    most = largest_one_off_energy(level=f_d, stiffness=stiffness, u=u)
    assert out <= most + 1e-12 * size
