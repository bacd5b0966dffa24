"""Four channels as one system of python-control: its two-port is that of its matrix."""

from dataclasses import replace

import control
import numpy as np
import pytest
from devices import body

from teleopdesign.derive import two_port_functions
from teleopdesign.diagrams import controller_parts, teleoperator

MASTER, SLAVE = (0.2, 2.0), (0.3, 3.0)
SIGNALS = ("X_m", "X_s", "F_m", "F_s")
#: motions and forces of both sides to both commands, one filter state for all
CHANNELS = control.ss(
    [[-50.0]],
    [[1.0, -1.0, 0.0, 0.25]],
    [[900.0], [-900.0]],
    [[-200.0, 200.0, 0.0, 0.5], [200.0, -200.0, 0.5, 0.0]],
)


def in_one_block():
    sides = (body(m, viscous__damping=b) for m, b in (MASTER, SLAVE))
    bare = teleoperator(*sides).without("P")
    controls, sums = controller_parts(
        CHANNELS, name="C", inputs=SIGNALS, outputs=("U_m", "U_s"), motion="", analog=True
    )
    kept = tuple(j for j in bare.junctions if j.output not in ("U_m", "U_s"))
    blocks, junctions = (*bare.blocks, *controls), (*kept, *sums)
    return replace(bare, blocks=blocks, junctions=junctions, measured=SIGNALS)


@pytest.mark.parametrize("s", [0.7j, 3.0 + 40.0j])
def test_impedances_and_hybrid_matrix_are_those_of_the_matrix(s):
    """Z X = F + C_X X + C_F F, so that F = (1 + C_F)^-1 (Z - C_X) X. 1e-12: rounding."""
    matrix = CHANNELS(s)
    bodies = np.diag([m * s**2 + b * s for m, b in (MASTER, SLAVE)])
    z = np.linalg.solve(np.eye(2) + matrix[:, 2:], bodies - matrix[:, :2])
    expected = {f"Z_{i}{j}": z["ms".index(i), "ms".index(j)] for i in "ms" for j in "ms"}
    expected |= {"h_21": -z[1, 0] / z[1, 1], "h_22": 1 / z[1, 1]}
    expected |= {"h_12": z[0, 1] / z[1, 1], "h_11": z[0, 0] - z[0, 1] * z[1, 0] / z[1, 1]}
    values = {f"C_{i + 1}_{j + 1}": matrix[i, j] for i in range(2) for j in range(4)}
    values |= {"Z_m": bodies[0, 0], "Z_s": bodies[1, 1]}
    functions = two_port_functions(in_one_block()).expressions
    assert set(functions) == set(expected)
    for name, expression in functions.items():
        assert "1.0" not in str(expression)
        numbers = {x: complex(values[x.name]) for x in expression.free_symbols}
        value = complex(expression.subs(numbers))
        assert value == pytest.approx(expected[name], rel=1e-12)
