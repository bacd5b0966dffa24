"""Cases in the threads of a GPU, which numba simulates: the numbers that each case has alone."""

import os
import subprocess
import sys
from pathlib import Path

import gpu_cases
import numpy as np
import pytest
from gpu_cases import NO_SIMULATOR, SETUPS, cases_of, reductions_of, start_of, with_bristles

from teleopdesign.base.errors import ModelError
from teleopdesign.realise.kernel import execute
from teleopdesign.simulate import simulate_many

# the simulator of a GPU is a process of its own, which takes 3 s
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def on_simulated_gpu(tmp_path_factory):
    path = tmp_path_factory.mktemp("gpu") / "results.npz"
    paths = [str(Path(gpu_cases.__file__).parent), *sys.path]
    environment = os.environ | {"NUMBA_ENABLE_CUDASIM": "1", "PYTHONPATH": os.pathsep.join(paths)}
    command = [sys.executable, gpu_cases.__file__, str(path)]
    run = subprocess.run(command, env=environment, capture_output=True, text=True)
    if run.returncode == NO_SIMULATOR:
        pytest.skip("this numba has no simulator of a GPU: needs numba-cuda")
    assert run.returncode == 0, run.stderr
    with np.load(path) as arrays:
        return dict(arrays)


def reduced_by_hand(rows, setup, period):
    """The reductions of each kind, from the rows of one case after the first."""
    numbers = []
    for reduction in reductions_of(setup):
        y, v = rows[1:, reduction.column], rows[1:, reduction.other]
        numbers.append(
            {
                "final": y[-1],
                "maximum": y.max(),
                "minimum": y.min(),
                "peak": np.abs(y).max(),
                "mean": y.mean(),
                "rms": np.sqrt(np.mean(y**2)),
                "energy": period * np.trapezoid(y * v),
            }[reduction.kind]
        )
    return numbers


@pytest.mark.parametrize("name", SETUPS)
def test_a_thread_has_the_numbers_that_its_case_has_alone(name, on_simulated_gpu):
    setup = SETUPS[name]()
    timing = setup.timing(setup.inner())
    arguments = setup.arguments(timing) | {"start": start_of(setup), "every_step": False}
    for case, row in enumerate(cases_of(setup)):
        values = dict(zip(setup.program.layout.parameters, row, strict=True))
        rows, worst = execute(setup.program, values, timing, **arguments)
        kept, reduced, largest, is_finite = (
            on_simulated_gpu[f"{name}.{key}"][case]
            for key in ("kept", "reduced", "worst", "is_finite")
        )
        assert is_finite and np.ptp(rows, axis=0).any()
        assert np.all(np.abs(kept - rows) <= 1e-9 * np.abs(rows).max(axis=0))
        assert largest == pytest.approx(worst, rel=1e-9)
        np.testing.assert_allclose(
            reduced, reduced_by_hand(rows, setup, timing.period), rtol=1e-9, atol=1e-15
        )


def test_a_case_beyond_all_numbers_is_marked_and_spoils_no_other(on_simulated_gpu):
    assert on_simulated_gpu["spoiled.is_finite"].tolist() == [True, True, False]
    others = (on_simulated_gpu[f"{name}.kept"][:2] for name in ("spoiled", "bristles"))
    np.testing.assert_array_equal(*others)


def test_cases_that_exceed_the_memory_of_the_gpu_run_one_part_after_the_other(on_simulated_gpu):
    np.testing.assert_array_equal(on_simulated_gpu["two parts"], on_simulated_gpu["bristles.kept"])


def test_a_case_that_alone_exceeds_the_memory_is_refused_in_one_line(on_simulated_gpu):
    message = str(on_simulated_gpu["no room"])
    assert "a simulation of 30 steps needs" in message and "\n" not in message


@pytest.mark.parametrize("label", ["cuda", "both"])
def test_the_gpu_refuses_and_refines_the_cases_that_the_cores_do(label, on_simulated_gpu):
    """A stiff bristle, friction that is absent, and a mass so small that no step suffices."""
    of = on_simulated_gpu
    assert of[f"{label}.reason"].tolist() == of["cpu.reason"].tolist()
    assert [bool(reason) for reason in of[f"{label}.reason"]] == [False, False, True]
    np.testing.assert_array_equal(of[f"{label}.step"], of["cpu.step"])
    assert of[f"{label}.step"][1] < of[f"{label}.step"][0]
    for name in ("end", "drawn"):
        assert np.all(of[f"cpu.{name}"][:2] != 0.0)
        np.testing.assert_allclose(of[f"{label}.{name}"], of[f"cpu.{name}"], rtol=1e-9)


def test_without_a_gpu_one_line_says_what_is_missing():
    cuda = pytest.importorskip("numba.cuda", reason="this numba has no part for GPUs")
    if cuda.is_available():
        pytest.skip("there is a GPU")
    expected = "expected an NVIDIA GPU|pip install 'teleopdesign\\[cuda\\]'"
    with pytest.raises(ModelError, match=expected) as refused:
        levels = {"Z_m.coulomb.level": [0.5, 0.6]}
        simulate_many(with_bristles(), levels, duration=1e-3, device="cuda")
    assert "\n" not in str(refused.value)
