"""A matrix impedance from a table of a TOML file."""

from __future__ import annotations

import math

from ..base.errors import ExperimentError
from ..base.toml import Table, describe_toml_value
from ..blocks import MatrixImpedance, matrix_impedance

#: keys of the matrices, each a list of rows (SI)
MATRICES = ("mass", "damping", "stiffness")


def read_matrices(table: Table, size: int) -> MatrixImpedance:
    """The impedance between `size` motions; an absent matrix is zero.

    raises ExperimentError: a matrix of another size, or an entry that is no finite number
    """
    if not size:
        raise ExperimentError(f"{table.where('motions')}: found none, expected one or more")
    matrices = {key: _matrix(table, key, size) for key in MATRICES if key in table.content}
    return matrix_impedance(**{"mass": [[0.0] * size] * size, **matrices})


def _matrix(table: Table, key: str, size: int) -> list[list[float]]:
    rows = table.content[key]
    if isinstance(rows, list) and all(isinstance(row, list) for row in rows):
        if any(len(line) != size for line in (rows, *rows)):
            wrong = f"{len(rows)} rows of {' and '.join(sorted({str(len(r)) for r in rows}))}"
        elif all(_is_finite(x) for row in rows for x in row):
            return [[float(x) for x in row] for row in rows]
        else:
            wrong = next(describe_toml_value(x) for row in rows for x in row if not _is_finite(x))
    else:
        wrong = describe_toml_value(rows)
    raise ExperimentError(
        f"{table.where(key)}: found {wrong}, expected {size} rows of {size} finite numbers, one "
        "for each motion"
    )


def _is_finite(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # a whole number beyond all floats
        return False
