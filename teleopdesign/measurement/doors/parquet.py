"""Parquet files: a table with typed columns."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...errors import ExperimentError
from ._log import Log, optional, refuse_size


def open_parquet(path: Path, file: str) -> Log:
    """A parquet file; raises ExperimentError: none, or without pyarrow."""
    parquet = optional("pyarrow.parquet", file)
    arrow = optional("pyarrow", file)
    try:
        names = tuple(parquet.read_schema(path).names)
        refuse_size(parquet.read_metadata(path).num_rows, file)
    except arrow.lib.ArrowException as problem:
        raise ExperimentError(f"{file}: not a readable parquet file: {problem}") from None

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        try:
            table = parquet.read_table(path, columns=list(wanted))
        except arrow.lib.ArrowException as problem:
            raise ExperimentError(f"{file}: not a readable parquet file: {problem}") from None
        return {name: table.column(name).to_numpy() for name in wanted}

    return Log(names, read)
