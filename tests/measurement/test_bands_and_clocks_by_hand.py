"""The band of a record and hum, by spectra that are written here."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from teleopdesign.measurement import bandwidth
from teleopdesign.measurement.hum import hum_of, tone_at, without_hum

# the band


def known(spectra, monkeypatch, *, resolution=0.0, rates=None, stated=None):
    """An experiment of bodies and one record, of which the spectra are these."""
    names = [f"{body}.position" for body in spectra]
    record = SimpleNamespace(rate_of=lambda n: (rates or {}).get(n, 100.0))
    channels = {n: SimpleNamespace(resolution=resolution) for n in names}

    def of(_, name, *, even_out=False):
        density = np.asarray(spectra[name.removesuffix(".position")], dtype=float)
        return np.arange(float(len(density))), density, 1.0

    monkeypatch.setattr(bandwidth, "_spectrum", of)
    monkeypatch.setattr(bandwidth, "_rounding", lambda *_: resolution)
    return SimpleNamespace(
        bodies=list(spectra), records=[record], channels=channels, bandwidth=stated
    )


def test_the_band_is_halved_while_it_hides_the_motion(monkeypatch):
    monkeypatch.setattr(bandwidth, "_highest_acceleration", lambda _: 40.0)
    monkeypatch.setattr(bandwidth, "hides_motion", lambda _, body, f: body == "b" and f > 12.0)
    assert bandwidth.default_bandwidth(SimpleNamespace(bodies=["a", "b"])) == 10.0
    assert bandwidth.default_bandwidth(SimpleNamespace(bodies=["a"])) == 40.0


@pytest.mark.parametrize(
    ("band", "wide", "hides"), [(4.0, 0.39, True), (4.0, 0.41, False), (3.9, 0.0, False)]
)
def test_a_band_hides_the_motion_where_half_of_that_two_octaves_lower_is_left(
    monkeypatch, band, wide, hides
):
    shares = {band / 4.0: 0.8, band: wide}
    monkeypatch.setattr(bandwidth, "share_in_motion", lambda _, body, f: shares[f])
    assert bandwidth.hides_motion(None, "a", band) == hides


@pytest.mark.parametrize(
    ("spectra", "rates", "band"),
    [
        # up to a tenth of the rate; a fiftieth of it where nothing is above the noise
        ({"a": [0, *[50.0] * 20]}, {}, 10.0),
        ({"a": [0, *[50.0] * 6, *[1.0] * 14]}, {}, 6.0),
        ({"a": [0, *[1.0] * 20]}, {}, 2.0),
        ({"a": [0, *[1.0] * 20]}, {"a.position": 60.0}, 1.2),
        ({"a": [0, *[1.0] * 20]}, {"a.position": 20.0}, 1.0),
        # the lowest of both bodies, but no lower than twice the motion of either, up to its limit
        ({"a": [0, *[50.0] * 20], "b": [0, *[50.0] * 4, *[1.0] * 16]}, {}, 10.0),
        ({"a": [0, 1e9, *[50.0] * 19], "b": [0, *[50.0] * 4, *[1.0] * 16]}, {}, 4.0),
        ({"a": [0, 1, 1, 1e9, *[50.0] * 17], "b": [0, *[50.0] * 4, *[1.0] * 16]}, {}, 6.0),
    ],
)
def test_the_band_follows_from_spectra(monkeypatch, spectra, rates, band):
    experiment = known(spectra, monkeypatch, rates=rates)
    assert bandwidth._highest_acceleration(experiment) == pytest.approx(band)


def test_the_motion_is_where_nine_tenths_of_the_squared_velocity_are(monkeypatch):
    """Densities less the noise of 1, times the square of the frequency: 905 and 95, or 895, 105."""
    for first, second, motion in ((905.0, 95.0, 1.0), (895.0, 105.0, 2.0)):
        experiment = known({"a": [0, 1 + first, 1 + second / 4, 1, 1]}, monkeypatch)
        record = experiment.records[0]
        assert bandwidth._frequency_of_motion(record, "a.position") == motion
    experiment = known({"a": [0, 9.0, 9.0]}, monkeypatch)
    assert bandwidth._frequency_of_motion(experiment.records[0], "a.position") == 0.0


def test_lines_are_no_motion_where_they_hold_no_more_than_rounding(monkeypatch):
    """A line at 18 of 41 frequencies (80 samples): its mean square is (81 - 1) 16 / 3 / 80^2."""
    density = np.ones(41)
    density[1:5], density[18] = 50.0, 81.0
    line = 80.0 * 16 / 3 / 80**2
    for rounding, band in ((0.99 * line, 18.0), (1.01 * line, 4.0)):
        rates = {"a.position": 200.0}
        experiment = known({"a": density}, monkeypatch, resolution=rounding, rates=rates)
        assert bandwidth._highest_acceleration(experiment) == band


def test_dense_frequencies_are_counted_in_the_third_of_an_octave_below():
    above = np.random.default_rng(1).random(60) < 0.5
    frequency = np.arange(60.0)
    share = bandwidth._share_below(above, frequency)
    for k in range(1, 60):
        inside = [above[j] for j in range(60) if k / 2 ** (1 / 3) <= j <= k]
        assert share[k] == pytest.approx(np.mean(inside))


@pytest.mark.parametrize(
    ("more", "stated", "highest"), [(13.0, None, 14.0), (12.0, None, None), (13.0, 20.0, None)]
)
def test_motion_goes_on_beyond_a_band_where_most_of_its_acceleration_lies_there(
    monkeypatch, more, stated, highest
):
    """Less the noise, times the fourth power of the frequency: 49 x 10^4 and more x 14^4."""
    density = np.ones(41)
    density[10], density[14] = 1 + 49.0, 1 + more
    assert (more * 14.0**4 > 49.0 * 10.0**4) == (more == 13.0)
    experiment = known({"a": density}, monkeypatch, resolution=1e-9, stated=stated)
    monkeypatch.setattr(bandwidth, "hides_motion", lambda *_: False)
    assert bandwidth.motion_beyond(experiment, 10.0) == highest
    if highest is not None:
        monkeypatch.setattr(bandwidth, "hides_motion", lambda *_: True)
        assert bandwidth.motion_beyond(experiment, 10.0) is None
        power = more * 16 / 3 / 80**2
        for rounding, result in ((0.99 * power, highest), (1.01 * power, None)):
            experiment = known({"a": density}, monkeypatch, resolution=rounding)
            monkeypatch.setattr(bandwidth, "hides_motion", lambda *_: False)
            assert bandwidth.motion_beyond(experiment, 10.0) == result


def record_with(x, h=0.01, rate=100.0):
    parts = (slice(0, len(x)),)
    return SimpleNamespace(signals={"x": x}, segments=parts, sample_time=h, rate_of=lambda _: rate)


def test_the_spectrum_holds_the_power_of_a_sine_in_windows_that_overlap_by_half():
    """Two windows, from 0 and from 2048: in the second one the sine ends amid the window."""
    t = 0.01 * np.arange(6144)
    x = 7.0 + np.where(np.arange(6144) < 4096, 3.0 * np.sin(2 * np.pi * 12.5 * t), 0.0)
    frequency, density, _ = bandwidth._spectrum(record_with(x), "x")
    assert len(frequency) == 2049 and frequency[-1] == 50.0
    power = bandwidth._mean_square(density, len(frequency)).sum()
    assert power == pytest.approx(0.75 * 4.5, rel=0.01)
    assert bandwidth._spectrum(record_with(5.0 * t), "x", even_out=True)[1].max() < 1e-9
    whole = SimpleNamespace(channels={"x": SimpleNamespace(resolution=0.12)})
    assert bandwidth._rounding(whole, "x", record_with(x)) == pytest.approx(0.0012)


def test_the_noise_of_readings_is_that_from_three_to_five_tenths_of_their_rate():
    n = 16_384
    x = 0.01 * np.random.default_rng(2).standard_normal(n)
    white = bandwidth._spectrum(record_with(x), "x")[2]
    whole = bandwidth._mean_square(2048 * np.array([white]), 2049)[0]
    assert whole == pytest.approx(1e-4, rel=0.15)
    other = np.fft.rfft(np.random.default_rng(3).standard_normal(n))
    f = np.fft.rfftfreq(n, 0.01)
    beside = np.fft.irfft(other * ((f > 21.0) | (f < 11.0)), n)
    assert bandwidth._spectrum(record_with(x + beside, rate=40.0), "x")[2] < 1.3 * white


# hum


@pytest.mark.parametrize("mean", [0.0, 30.0])
@pytest.mark.parametrize(("mains", "off"), [(50.0, 0.1), (60.0, -0.2)])
def test_hum_is_measured_with_frequency_and_rms_and_subtracted(mean, mains, off):
    n, h = 4000, 1e-3
    t = h * np.arange(n)
    noise = 0.02 * np.random.default_rng(1).standard_normal(n)
    tone = 0.5 * np.sin(2 * np.pi * (mains + off) * t + 0.4)
    hum = hum_of(mean + tone + noise, [], h)
    assert hum.mains == mains and hum.frequency == pytest.approx(mains + off, abs=0.01)
    assert hum.rms == pytest.approx(0.5 / math.sqrt(2), rel=0.15)
    assert without_hum(mean + tone + noise, hum, h) == pytest.approx(mean + noise, abs=0.02)
    assert hum_of(mean + tone + noise, [tone], h) is None and hum_of(mean + noise, [], h) is None
    over, rms = tone_at(mean + 0.5 * np.sin(2 * np.pi * 50.0 * t), h, 50.0)
    assert over > 1e3 and rms == pytest.approx(0.5 / math.sqrt(2), rel=1e-3)
