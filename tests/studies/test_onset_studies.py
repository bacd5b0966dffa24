"""The studies of onset, run quickly, against the features that their figures must show."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.fixture(scope="module")
def study():
    """Name of a study -> its module, imported as the script it is."""
    patch = pytest.MonkeyPatch()
    patch.syspath_prepend(str(STUDIES))

    def load(name):
        spec = importlib.util.spec_from_file_location(name, STUDIES / f"{name}.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module

    yield load
    patch.undo()


def test_the_teleoperator_swings_up_only_beyond_the_passive_bound(study):
    module = study("teleoperator_onset")
    light = {"damping": 0.05, "contact": 0.25}
    assert module.growth(1.0, **light) < 0
    # 2 % on either side of the balance: the compensator's pull bends the swing by about one
    edge = module.balance(**light)
    assert module.growth(0.98 * edge, **light) < 0 < module.growth(1.02 * edge, **light)
    # what grows with a light damper is held by a strong one
    assert module.growth(2.0, **light) > 0 > module.growth(2.0, damping=5.0, contact=0.25)


@pytest.mark.slow
def test_simulated_onset_of_the_teleoperator_is_the_balance_of_energy(study):
    found = study("teleoperator_onset").run(quick=True)
    assert found.attrs["grown_within_bound"] == 0
    assert found.attrs["worst_difference"] < 0.05
    share = found["share"].values
    for name in ("damping", "contact"):
        grown = found[f"growth_over_{name}"].values > 0
        onset = found[f"onset_over_{name}"].values
        assert np.all(np.diff(onset[~np.isnan(onset)]) > 0)
        assert not grown[share < found.attrs["cycles"]].any()  # P40 alone, without the dampers
        assert np.all(np.diff(grown.astype(int), axis=0) >= 0)  # once it grows, more grows too


@pytest.mark.parametrize("kind", ["delay", "period"])
def test_a_late_coupling_swings_up_beyond_its_bound_and_not_below(study, kind):
    module = study("passive_delay_and_stiffness")
    late = 16 * module.TICK
    bound = module.limit(kind, late)
    claim = module.delayed if kind == "delay" else module.held
    assert claim(late, 0.999 * bound).status == "proved"
    assert claim(late, 1.001 * bound).status == "refuted"
    free, heavy = module.ends(kind)
    for masses in (free, heavy):
        assert not module.grows(kind, late, 0.99 * bound, masses)
    assert module.grows(kind, late, 1.01 * bound, heavy)
    assert module.grows(kind, late, 1.2 * bound, free)


@pytest.mark.slow
def test_proved_region_and_simulated_onset_of_late_couplings_agree(study):
    module = study("passive_delay_and_stiffness")
    found = module.run(quick=True)
    assert found.attrs["contradictions"] == 0
    stiffness = found["stiffness"].values
    for name in ("delay", "period"):
        limit = found[f"limit_over_{name}"].values
        expected = np.where(stiffness[:, None] <= limit, "proved", "refuted")
        assert np.array_equal(found[f"status_over_{name}"].values, expected)
        times = found[f"{name}_simulated"].values
        over = found[f"onset_over_{name}"].values / [module.limit(name, t) for t in times]
        # the last interval of seven bisections is 2.2 %
        assert np.all(over >= 1) and np.all(over[1] < 1.03) and np.all(over[0] < 1.2)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["teleoperator_onset", "passive_delay_and_stiffness"])
def test_a_study_of_onset_writes_its_figure_and_its_numbers(study, name, tmp_path, monkeypatch):
    monkeypatch.setattr("sys.argv", [name, "--quick", "--output", str(tmp_path)])
    module = study(name)
    plot = {n: f for n, f in vars(module).items() if n.startswith("plot_")}
    module.write_study(module.__file__, module.__doc__, module.run, *plot.values())
    assert {p.suffix for p in tmp_path.iterdir()} == {".pdf", ".svg", ".png", ".nc"}
