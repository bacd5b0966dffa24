"""From a raw log to a second log with the compensation on, on devices of a simulator."""

import csv
from pathlib import Path

import pytest
from design.closed_loop_campaign import close_the_loop, keep_small, summary


@pytest.mark.slow
def test_the_second_log_lies_in_the_interval_and_nothing_is_named(tmp_path, monkeypatch):
    keep_small(monkeypatch.setattr)
    row = close_the_loop(1, tmp_path, among=("gravity", "spring", "cogging"))
    assert row["missing"] == "gravity" and row["holds"] and not row["named"]
    low, high, measured, without = (float(row[n]) for n in ("low", "high", "measured", "without"))
    assert high - low <= 0.3 * measured and measured < 0.8 * without


def test_the_rows_of_the_campaign_hold_and_are_narrow():
    table = (Path(__file__).parent / "closed_loop.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(table.splitlines()))
    held, of = (int(word) for word in summary(rows).split()[:3:2])
    assert of == len(rows) and held >= 53 / 60 * of
    for row in rows:
        low, high, measured = (float(row[n]) for n in ("low", "high", "measured"))
        assert (low <= measured <= high) == bool(int(row["holds"]))
