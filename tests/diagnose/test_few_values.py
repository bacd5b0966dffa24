"""Too few independent values where a model fails: any effect with as many parameters fits them."""

from importlib import import_module
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from teleopdesign.diagnose.criteria import CRITERIA
from teleopdesign.diagnose.few_values import explain_few_values, independent_values
from teleopdesign.measurement.prepare import Stretch

#: the module, not the function of its name
rank = import_module("teleopdesign.diagnose.rank")

RATE, BANDWIDTH, SECONDS = 20.0, 2.0, 100.0
ROWS = round(RATE * SECONDS)


def records(weight=1.0):
    stretch = SimpleNamespace(
        keep=np.arange(ROWS), weight=weight, motion=SimpleNamespace(sample_time=1 / RATE / weight)
    )
    stretch.counted_time = Stretch.counted_time.fget(stretch)
    return SimpleNamespace(of=lambda use: [stretch] * (use == "fit"), bandwidth=BANDWIDTH)


def at_moments(count):
    """A residual that is zero but for so many pulses, each as short as the bandwidth allows."""
    residual = np.zeros(ROWS)
    residual[np.linspace(100, ROWS - 100, count).astype(int)] = 1.0
    return sosfiltfilt(butter(4, BANDWIDTH, fs=RATE, output="sos"), residual)


def fits(residual, parameters):
    model = SimpleNamespace()
    base = SimpleNamespace(fit_residual=residual, model=model)
    return base, SimpleNamespace(free=("p",) * parameters, model=model)


@pytest.mark.parametrize("weight", [1.0, 4.0])
def test_noise_below_the_bandwidth_holds_two_values_a_second_and_hertz(weight):
    noise = np.random.default_rng(1).standard_normal(ROWS)
    assert independent_values(noise, records(weight)) == pytest.approx(400, rel=0.1)
    low = sosfiltfilt(butter(4, BANDWIDTH, fs=RATE, output="sos"), noise)
    assert independent_values(1e-9 * low, records(weight)) == pytest.approx(400, rel=0.2)
    constant = independent_values(np.ones(ROWS), records(weight))
    assert constant == pytest.approx(400), "no more than the records hold"


@pytest.mark.parametrize("count", [3, 12])
def test_each_moment_that_alone_fails_counts_for_a_few_values(count):
    values = independent_values(at_moments(count), records())
    assert count < values < 4 * count
    assert values / count == pytest.approx(independent_values(at_moments(1), records()), rel=0.1)


def test_without_a_residual_nothing_is_few():
    assert independent_values(np.zeros(ROWS), records()) == np.inf
    assert independent_values(np.zeros(0), records()) == np.inf
    assert explain_few_values(*fits(np.zeros(ROWS), 50), records()) == ""


def test_two_values_for_each_parameter_are_enough(monkeypatch):
    residual = at_moments(3)
    values = independent_values(residual, records())
    enough = int(values / CRITERIA.for_each)
    assert explain_few_values(*fits(residual, enough), records()) == ""
    base, fit = fits(residual, enough + 1)
    sentence = explain_few_values(base, fit, records())
    assert sentence == (
        f"the model fails at only about {values:.0f} independent values of the fit records, and "
        f"has {enough + 1} parameters with this effect: any effect could describe them"
    )
    # what an effect's own file says of its values comes first
    says = {}
    monkeypatch.setattr(rank, "implausible_effects", lambda model, prepared: dict(says))
    one = SimpleNamespace(key=("spring", "device"))
    assert rank._implausible(base, one, fit, records()) == sentence
    says["spring", "device"] = "its rest lies beyond the travel"
    assert rank._implausible(base, one, fit, records()) == "its rest lies beyond the travel"
