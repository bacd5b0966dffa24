"""A note on the band of a comparison leaves the rest of a check as it is."""

from dataclasses import replace

import pytest

from teleopdesign import example, load_experiment
from teleopdesign.fitted_checks import bandwidth, check_experiment


@pytest.fixture(scope="module")
def turned():
    """The rod that ships, with its position turned round."""
    rod = load_experiment(example("rod"))
    name = "device.position"
    records = [replace(r, signals={**r.signals, name: -r.signals[name]}) for r in rod.records]
    return replace(rod, records=tuple(records))


def test_a_wrong_sign_is_reported_where_the_motion_goes_on_beyond_the_band(turned, monkeypatch):
    """ "Not checked: first choose a bandwidth" stood in place of the warning of the sign."""
    monkeypatch.setattr(bandwidth, "motion_beyond", lambda experiment, chosen: 2.0 * chosen)
    concerns = {f.topic: f.concern for f in check_experiment(turned)}
    assert concerns["motion beyond the bandwidth"] == "note"
    assert concerns["signs"] == "warning"
