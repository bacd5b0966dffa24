"""A tone from outside on made records: its frequency, what it takes away, and what hides it."""

from types import SimpleNamespace

import numpy as np
import pytest
from diagnose.stand_ins import BLOCKS, SHAPE, fit

from teleopdesign.diagnose import outside_tone
from teleopdesign.diagnose.outside_tone import (
    Tone,
    _frequency,
    _remove_tone,
    _share,
    best_tone,
    is_of_mains,
)

RATE = 200.0


def stretch(seconds, *, every=4, velocity=None, body="device", start=3.0):
    """A record of a slow motion, of which each so many-th row counts."""
    time = start + np.arange(int(seconds * RATE)) / RATE
    motion = SimpleNamespace(
        time=time,
        sample_time=1.0 / RATE,
        velocity=np.sin(2.0 * time) if velocity is None else velocity(time),
        body=body,
    )
    return SimpleNamespace(motion=motion, keep=np.arange(5, len(time) - 5, every), weight=1.0)


def at_rows(one, force):
    return force(one.motion.time[one.keep])


def sine(frequency, size=1.0, phase=0.4):
    return lambda t: size * np.sin(2 * np.pi * frequency * t + phase)


def both(*forces):
    return lambda t: sum(f(t) for f in forces)


@pytest.mark.parametrize("frequency", [0.77, 5.3, 11.91, 24.2])
def test_a_tone_has_its_frequency_whatever_its_phase_on_records_of_any_length(frequency):
    records = [stretch(20.0), stretch(7.0, start=100.0), stretch(12.0, every=5)]
    parts = [(s, at_rows(s, sine(frequency, 0.2, phase=k))) for k, s in enumerate(records)]
    assert _frequency(parts[:2]) == pytest.approx(frequency, abs=1e-3)
    if frequency < 20.0:  # rows of the third are further apart
        assert _frequency(parts) == pytest.approx(frequency, abs=1e-3)


def test_the_frequency_is_the_one_that_takes_most_from_all_records_together():
    """Brute force over a fine grid, of two tones, one of them on one record only."""
    rng = np.random.default_rng(3)
    records = [stretch(9.0), stretch(6.0)]
    noise = [0.3 * rng.standard_normal(len(s.keep)) for s in records]
    parts = [
        (records[0], at_rows(records[0], both(sine(4.0, 0.9), sine(7.0, 1.0))) + noise[0]),
        (records[1], at_rows(records[1], sine(4.0, 0.9)) + noise[1]),
    ]

    def left(frequency):
        return sum(np.sum(_remove_tone(s, r, frequency) ** 2) for s, r in parts)

    grid = np.arange(0.5, 20.0, 0.02)
    best = grid[int(np.argmin([left(f) for f in grid]))]
    assert best == pytest.approx(4.0, abs=0.02)
    assert _frequency(parts) == pytest.approx(best, abs=0.011)
    assert left(_frequency(parts)) <= left(best) * (1 + 1e-6)
    assert _frequency(parts[:1]) == pytest.approx(7.0, abs=0.02)


def test_a_swing_of_the_whole_record_is_no_tone():
    """Less than two periods are a trend; the strongest that repeats is taken."""
    one = stretch(10.0)
    left = at_rows(one, both(sine(0.1, 0.6), sine(6.0, 0.5)))
    assert _frequency([(one, left)]) == pytest.approx(6.0, abs=0.01)


@pytest.mark.parametrize("size", [1e-9, 1e-4, 1e6])
def test_a_tone_in_any_unit_has_the_same_frequency(size):
    """Beside a swing of the whole record, which is larger and no tone."""
    one = stretch(10.0)
    left = at_rows(one, both(sine(6.0), sine(0.05, 3.0)))
    assert _frequency([(one, size * left)]) == pytest.approx(_frequency([(one, left)]), abs=1e-6)


def test_where_nothing_is_left_there_is_no_frequency():
    one = stretch(10.0)
    few = SimpleNamespace(motion=one.motion, keep=one.keep[:2])
    assert _frequency([(one, np.zeros(len(one.keep)))]) == 0.0
    assert _frequency([(few, np.ones(2))]) == 0.0 and _frequency([]) == 0.0
    left = at_rows(one, sine(6.0))
    assert _frequency([(few, np.ones(2)), (one, left)]) == pytest.approx(6.0, abs=0.01)


def test_what_a_tone_leaves_has_nothing_of_its_frequency():
    rng, one = np.random.default_rng(1), stretch(10.0)
    t = one.motion.time[one.keep]
    noise = rng.standard_normal(len(t))
    left = _remove_tone(one, noise + at_rows(one, sine(8.0, 3.0)), 8.0)
    for wave in (np.sin(16 * np.pi * t), np.cos(16 * np.pi * t)):
        assert abs(left @ wave) < 1e-8
    np.testing.assert_allclose(left, _remove_tone(one, noise, 8.0), atol=1e-9)
    few = SimpleNamespace(motion=one.motion, keep=one.keep[:2])
    np.testing.assert_array_equal(_remove_tone(few, noise[:2], 8.0), noise[:2])
    three = SimpleNamespace(motion=one.motion, keep=one.keep[:3])
    assert np.sum(_remove_tone(three, noise[:3], 8.0) ** 2) < np.sum(noise[:3] ** 2)


def test_a_motion_holds_its_frequency_and_harmonics_of_its_direction_and_size():
    one = stretch(40.0, velocity=sine(0.5))
    line = 1.0 / 40.0
    assert _share(one, 0.5) > 0.99 and _share(one, 0.5 + 2 * line) > 0.9
    assert _share(one, 0.5 + 5 * line) < 0.01 and _share(one, 0.5 - 5 * line) < 0.01
    # a square wave: a ninth of the squares at the third harmonic, of what the first has
    assert _share(one, 1.5) == pytest.approx((8 / np.pi**2) / 9, rel=0.05)
    # |sin|: squares of its harmonics, over those of all of them but the mean
    parts = np.array([1.0 / (4 * k * k - 1) ** 2 for k in range(1, 200)])
    for k in (1, 2):
        assert _share(one, 1.0 * k) == pytest.approx(parts[k - 1] / parts.sum(), rel=0.05)
    rest = stretch(10.0, velocity=np.zeros_like)
    assert _share(rest, 5.0) == 0.0


@pytest.mark.parametrize("mains", [50.0, 60.0, 100.0, 120.0])
def test_the_mains_are_within_four_parts_in_a_thousand(mains):
    assert is_of_mains(1.0039 * mains) and is_of_mains(0.9961 * mains)
    assert not is_of_mains(1.0041 * mains) and not is_of_mains(0.9959 * mains)


@pytest.mark.parametrize("size", [0.01, 1.0, 50.0])
def test_a_tone_is_beaten_by_three_standard_deviations(size):
    aside = np.roll(SHAPE, 1) - (np.roll(SHAPE, 1) @ SHAPE) * SHAPE
    aside /= np.linalg.norm(aside)
    products = (aside * SHAPE).reshape(-1, 10).sum(axis=1)
    one = fit(size)
    assert (np.diff(BLOCKS) >= 0).all()
    for score, beaten in [(2.99, False), (3.01, True)]:
        x = score * 2.0 * size * np.sqrt(products @ products)  # a gain of x^2
        assert Tone(size * SHAPE + x * aside).is_beaten_by(one) == beaten
    assert not Tone(0.5 * size * SHAPE).is_beaten_by(one)


def squares(values):
    return float(np.sum(np.concatenate(values) ** 2))


@pytest.fixture
def tone_of(monkeypatch):
    """The best tone of residuals by body; where one is fitted as a force it leaves `beside`."""

    def find(records, force, beside=None):
        left = {use: [at_rows(s, force(s)) for s in records[use]] for use in ("fit", "check")}
        one = SimpleNamespace(
            fit_residual=np.concatenate(left["fit"]), check_residual=np.concatenate(left["check"])
        )
        calls = []

        def fitted(fit, prepared, body, frequency):
            calls.append((body, frequency))
            return one.check_residual if beside is None else beside

        monkeypatch.setattr(outside_tone, "_fit_beside_tone", fitted)
        return best_tone(one, SimpleNamespace(of=records.__getitem__)), left["check"], calls

    return find


def test_a_tone_is_taken_off_the_body_on_which_it_acts(tone_of):
    """Each check record has a phase and an amplitude of its own; the other body keeps its own."""
    records = {
        use: [stretch(12.0), stretch(9.0, body="slave"), stretch(8.0, body="slave")]
        for use in ("fit", "check")
    }
    rng = np.random.default_rng(0)
    noise = lambda t: 0.1 * rng.standard_normal(len(t))  # noqa: E731

    def force(s):
        if s.motion.body == "device":
            return noise
        return both(noise, sine(9.0, rng.uniform(1, 2), rng.uniform(0, 6)))

    tone, left, calls = tone_of(records, force)
    assert [body for body, _ in calls] == ["slave"] and calls[0][1] == pytest.approx(9.0, abs=0.01)
    np.testing.assert_allclose(tone.residual[: len(left[0])], left[0])
    assert tone.squares == pytest.approx(0.01 * len(tone.residual), rel=0.15)


@pytest.mark.parametrize(("part", "fitted"), [(0.025, False), (0.035, True)])
def test_a_tone_is_fitted_as_a_force_where_it_explains_enough_to_matter(tone_of, part, fitted):
    """Off the residual it takes `part` of the squares; as a force it may take more."""
    records = {"fit": [stretch(20.0)], "check": [stretch(20.0)]}
    rng = np.random.default_rng(2)
    noise = rng.standard_normal(len(records["fit"][0].keep))
    one = records["fit"][0]
    noise = _remove_tone(one, noise, 9.0)
    noise /= np.sqrt(np.mean(noise**2))
    size = (2 * part / (1 - part)) ** 0.5
    nothing = np.zeros(len(noise))
    tone, left, calls = tone_of(
        records, lambda s: lambda t: noise + sine(9.0, size)(t), beside=nothing
    )
    assert bool(calls) == fitted
    assert tone.squares == (0.0 if fitted else pytest.approx((1 - part) * squares(left), rel=0.01))
    # as a force it may leave more: then it is taken off the residual
    tone, *_ = tone_of(records, lambda s: lambda t: noise + sine(9.0, size)(t), beside=9 + nothing)
    assert tone.squares == pytest.approx((1 - part) * squares(left), rel=0.01)


@pytest.mark.parametrize(
    ("frequency", "part", "outside"),
    [(8.5, 0.008, True), (8.5, 0.012, False), (50.0, 0.2, True), (50.0, 0.3, False)],
)
def test_a_tone_that_the_motion_holds_may_be_its_work_but_the_mains_move_it(
    tone_of, frequency, part, outside
):
    """On any record: a hundredth of its squares, of those of the mains a quarter."""
    held = both(sine(1.0), sine(frequency, (part / (1 - part)) ** 0.5))
    plain = {"velocity": sine(1.0), "every": 1}
    for use in ("fit", "check"):
        records = {"fit": [stretch(20.0, **plain)], "check": [stretch(20.0, **plain)]}
        records[use].append(stretch(20.0, every=1, velocity=held))
        tone, *_ = tone_of(records, lambda s: sine(frequency))
        assert (tone.residual is not None) == outside


def test_without_check_records_or_residuals_there_is_no_tone(tone_of):
    assert best_tone(None, SimpleNamespace(of=lambda use: [])) == Tone()
    records = {use: [stretch(9.0, velocity=sine(5.0))] for use in ("fit", "check")}
    tone, *_ = tone_of(records, lambda s: np.zeros_like)
    assert tone.residual is None and tone.squares == float("inf")
