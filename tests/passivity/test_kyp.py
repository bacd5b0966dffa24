"""The KYP inequality against the exact test, and storage functions in exact numbers."""

import pytest

from teleopdesign.passivity import damping_excess, kyp, storage_function
from teleopdesign.realise.lti import S


@pytest.fixture
def cvxpy():
    """The solver's front end, where it is installed."""
    return pytest.importorskip("cvxpy", reason="the extra `lmi` is not installed")


@pytest.mark.parametrize(
    "z",
    [
        0.15 * S + 4 + 300 / S,
        (S**2 + S + 1) / (S + 1) ** 2,
        (S**2 - 0.1 * S + 1) / (S + 1) ** 2,
        1 / (S + 1),
        S / (0.2 * S**2 + 3 * S + 100),
        (S**2 + 4) / (S * (S**2 + 9)),
        1e-6 * S + 1e6 + 1e6 / S,
        (S + 1) / (S - 2),
        -S,
        1 / S**2,
        7,
    ],
    ids=str,
)
def test_the_inequality_finds_the_exact_excess_of_damping(z, cvxpy):
    """Largest c with a storage function for Z - c; the solver stops at 1e-8 of the size of Z."""
    exact = float(damping_excess(z))
    assert kyp(z).damping_excess == pytest.approx(exact, rel=1e-5, abs=1e-7)


@pytest.mark.parametrize(
    "z",
    [
        0.15 * S + 4 + 300 / S,
        1 / (S + 1),
        1 / S,
        S / (0.2 * S**2 + 3 * S + 100),
        (S**2 + S + 1) / (S + 1) ** 2,
        (S**2 + 4) / (S * (S**2 + 9)),
    ],
    ids=str,
)
def test_a_storage_function_in_exact_numbers(z, cvxpy):
    """Improper, lossless and lossy; the checker verifies it as it does friction."""
    claim = storage_function(z)
    assert claim.status == "proved"
    (certificate,) = claim.certificates
    assert certificate.kind == "storage"
    certificate.check()
