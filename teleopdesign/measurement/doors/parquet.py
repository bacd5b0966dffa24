"""Parquet files: a table with typed columns."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ._log import Log, optional, refuse_damage, refuse_size
from .shapes._table import MOST_ROWS

_KIND = "parquet file"


def open_parquet(path: Path, file: str) -> Log:
    """Open a parquet file; raises ExperimentError: a damaged file, or pyarrow is missing."""
    parquet = optional("pyarrow.parquet", file)
    with refuse_damage(_KIND, file):
        schema = parquet.read_schema(path)
        names = tuple(schema.names)
        # dates and durations are read in seconds, whatever their names say: "time_ms"
        timed = [n for n, kind in zip(names, map(str, schema.types), strict=True)
                 if kind.startswith(("timestamp", "duration", "time32", "time64"))]  # fmt: skip
        content = parquet.ParquetFile(path)
        refuse_size(content.metadata.num_rows, file)
        first = next(content.iter_batches(MOST_ROWS), None)
        columns = dict(zip(names, first.columns, strict=True)) if first is not None else {}
        sample = {n: c.to_numpy(zero_copy_only=False) for n, c in columns.items()}

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        with refuse_damage(_KIND, file):
            table = parquet.read_table(path, columns=list(wanted))
            return {name: table.column(name).to_numpy() for name in wanted}

    return Log(names, read, dict.fromkeys(timed, "s"), sample=sample)
