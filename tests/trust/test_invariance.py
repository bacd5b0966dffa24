"""Changes that must not matter: the same answer, to the last bit where nothing is rounded anew."""

import gzip
from dataclasses import dataclass

import pytest

import teleopdesign as td
from teleopdesign.diagnose import cores

ROD = td.example("rod")
ROWS = 3001  # 3 s at 1 kHz
#: relative to a standard error: times of other digits, units converted: rounding, which a fit
#: that stops at 1e-6 of its squares may amplify
ROUNDED = 1e-3
#: standard errors: ends that filters cannot use cut other rows off, and half the rows hold other
#: noise. A difference of two estimates from independent noise is below 2.8 in 95 of 100
OTHER_ROWS = 3.0


@dataclass(frozen=True)
class Case:
    """An experiment as texts: its file, and its tables (file -> header -> cells)."""

    toml: str
    tables: dict


def as_recorded():
    toml = (ROD / "experiment.toml").read_text()
    toml = toml.replace("[channels]", "stribeck = {}\n[channels]")
    return Case(toml, {name: table(ROD / name) for name in ("fit.csv.gz", "check.csv.gz")})


def table(path):
    head, *lines = gzip.decompress(path.read_bytes()).decode().splitlines()[:ROWS]
    cells = zip(*(line.split(",") for line in lines), strict=True)
    return dict(zip(head.split(","), cells, strict=True))


def changed(case, change):
    tables = {
        name: {head: [change(head, cell) for cell in cells] for head, cells in table.items()}
        for name, table in case.tables.items()
    }
    return Case(case.toml, tables)


def negative(cell):
    return cell[1:] if cell.startswith("-") else f"-{cell}"


def turned_round(case):
    return changed(case, lambda head, cell: cell if head == "t" else negative(cell))


def other_columns(case):
    return Case(
        case.toml, {n: {h: t[h] for h in reversed(list(t))} for n, t in case.tables.items()}
    )


def other_order(case):
    toml = case.toml
    head, *records = toml.split("[[records]]")
    return Case("[[records]]".join([head, *reversed(records)]), case.tables)


def later(case):
    return changed(case, lambda head, cell: f"{float(cell) + 16:.3f}" if head == "t" else cell)


def in_millimetres(case):
    unit, resolution = '"x", unit = "m"', "resolution = 7.2e-06"
    toml = case.toml.replace(unit, '"x", unit = "mm"').replace(resolution, "resolution = 7.2e-03")
    assert unit not in toml and resolution not in toml
    tables = changed(case, lambda head, cell: f"{float(cell) * 1e3:.9g}" if head == "x" else cell)
    return Case(toml, tables.tables)


def split(case):
    """The record that is fitted as two, one after the other."""
    name, half = "fit.csv.gz", ROWS // 2
    whole = case.tables[name]
    parts = {
        "first.csv.gz": {head: cells[:half] for head, cells in whole.items()},
        "second.csv.gz": {head: cells[half:] for head, cells in whole.items()},
    }
    one = case.toml[case.toml.index("[[records]]") :].split("[[records]]")[1]
    two = "[[records]]".join(one.replace(name, part) for part in parts)
    assert one.count(name) == 1
    tables = {n: t for n, t in case.tables.items() if n != name}
    return Case(case.toml.replace(one, two), {**tables, **parts})


def half_as_often(case):
    return Case(
        case.toml,
        {n: {h: cells[::2] for h, cells in t.items()} for n, t in case.tables.items()},
    )


def written(case, folder):
    folder.mkdir()
    (folder / "experiment.toml").write_text(case.toml)
    for name, columns in case.tables.items():
        lines = [",".join(row) for row in zip(*columns.values(), strict=True)]
        with gzip.open(folder / name, "wt") as file:
            file.write("\n".join([",".join(columns), *lines, ""]))
    return folder


def parameters(case, folder):
    experiment = td.load_experiment(written(case, folder))
    model = td.fit(td.Model.from_experiment(experiment), experiment)
    return {name: (p.value, p.stderr) for name, p in model.parameters.items()}


@pytest.fixture(scope="module")
def before(tmp_path_factory):
    return parameters(as_recorded(), tmp_path_factory.mktemp("rod") / "rod")


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        other_columns,
        other_order,
        turned_round,
    ],
)
def test_a_fit_is_the_same_to_the_last_bit(change, before, tmp_path):
    assert parameters(change(as_recorded()), tmp_path / "rod") == before


@pytest.mark.slow
@pytest.mark.parametrize("change", [later, in_millimetres])
def test_a_fit_is_the_same_but_for_rounding(change, before, tmp_path):
    after = parameters(change(as_recorded()), tmp_path / "rod")
    assert list(after) == list(before)
    for name, (value, stderr) in before.items():
        assert abs(after[name][0] - value) <= ROUNDED * stderr, name
        assert abs(after[name][1] - stderr) <= ROUNDED * stderr, name


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, 3])
def test_a_fit_is_the_same_on_any_number_of_cores(count, before, tmp_path, monkeypatch):
    monkeypatch.setattr(cores, "can_copy", lambda: count > 1)
    monkeypatch.setattr(cores, "count_workers", lambda: count)
    assert parameters(as_recorded(), tmp_path / "rod") == before


@pytest.mark.slow
@pytest.mark.parametrize("change", [split, half_as_often])
def test_a_fit_of_other_rows_is_the_same_within_its_standard_errors(change, before, tmp_path):
    after = parameters(change(as_recorded()), tmp_path / "rod")
    assert list(after) == list(before)
    for name, (value, stderr) in before.items():
        distance = abs(after[name][0] - value) / max(stderr, after[name][1])
        assert distance <= OTHER_ROWS, (name, distance)
