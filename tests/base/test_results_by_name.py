"""Results whose parts are got by name answer as a dict does."""

from importlib import import_module
from pathlib import Path

import pytest

import teleopdesign as td
from teleopdesign.diagrams import ANY

ROOT = Path(td.__file__).parent
WIRING = td.haptic_interface(hand=ANY, cancellation=ANY)
LOOP = td.haptic_interface(td.Body("prismatic", {"inertia": 0.2}))


def simulated():
    return td.simulate_diagram(LOOP, duration=2e-3, inputs={"R_D": 1.0}, jit=False)


def studied():
    axes, rms = {"Z_M.inertia": [0.1, 0.2]}, td.measure("rms", signal="E")
    return td.study(LOOP, axes, measures=rms, duration=2e-3)


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda: td.derive_transfers(WIRING), "T_MBC"),
        (lambda: td.transfer_functions(WIRING), "T_o"),
        (simulated, "L_velocity"),
        (studied, "rms_E"),
    ],
)
def test_a_name_is_in_its_result(make, name):
    """`"L" in simulation` ended in: no signal "0"."""
    result = make()
    assert name in result
    assert "0" not in result
    assert 0 not in result
    assert name in list(result)
    for each in result:
        result[each]


def test_every_result_that_is_indexed_by_a_name_can_be_asked_for_its_names():
    """A new class with `result[name]` alone would raise the same error about "0"."""
    lacking = []
    for path in ROOT.rglob("*.py"):
        if "def __getitem__(self, name: str)" not in path.read_text(encoding="utf-8"):
            continue
        parts = path.relative_to(ROOT.parent).with_suffix("").parts
        for kind in vars(import_module(".".join(parts))).values():
            if isinstance(kind, type) and hasattr(kind, "__getitem__"):
                if kind.__module__ == ".".join(parts) and not hasattr(kind, "__contains__"):
                    lacking.append(kind.__name__)
    assert not lacking
