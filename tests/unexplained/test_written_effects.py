"""What a model leaves, written as an effect file: it loads, and explains what was left."""

from dataclasses import replace

import pytest
from unexplained.planting import written

from teleopdesign import example, load_effect
from teleopdesign.base.errors import ModelError
from teleopdesign.cli import main
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.identifiability import is_identifiable
from teleopdesign.diagnose.search import estimate_from_starts
from teleopdesign.unexplained.effect_file import effect_text, write_effect
from teleopdesign.unexplained.shapes import (
    SHAPES,
)


def test_a_written_effect_loads_and_its_fit_reaches_the_noise_floor(
    tmp_path, rod, lacking, adequate, failure
):
    effect = written(tmp_path, "low_speed", failure, rod)
    assert effect.role == "friction_level"
    fitted = estimate_from_starts(lacking.model.with_effect(effect, at="device"), rod, lacking)
    # the formula is the catalogue's own, so its error must be that of the model that is right
    assert fitted.check_error == pytest.approx(adequate.check_error, rel=0.02)
    assert is_identifiable(fitted, lacking)


def test_without_a_formula_the_curve_itself_is_written(tmp_path, rod, lacking, adequate, failure):
    part, largest = failure.largest
    effect = written(tmp_path, "curve", failure, rod, replace(largest, formula=None))
    assert list(effect.parameters) == ["strength"]
    fitted = estimate(lacking.model.with_effect(effect, at="device"), rod)
    # straight between 16 knots, learnt to first order: a third more than the noise
    assert fitted.check_error < 1.33 * adequate.check_error


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: s.name)
def test_every_dependence_is_an_effect_file_that_loads_or_says_why_not(
    tmp_path, rod, rows, floor_squares, failure, shape
):
    part, largest = failure.largest
    one = next((t for t in part.tests if t.shape == shape), None)
    if one is None:
        pytest.skip("the rod tells nothing of it")
    described = replace(largest, dependence=one, formula=None)
    name = None if shape.variable is None else shape.variable.name
    if shape.is_wave:
        pytest.skip("a sinusoid has a formula")
    if name in ("since_reversal", "travel") or shape.carrier.name == "lateness":
        with pytest.raises(ModelError, match="cannot be written"):
            effect_text(part, described, rod)
        return
    path = tmp_path / "made.py"
    write_effect(path, part, described, rod)
    text = path.read_text()
    assert max(map(len, text.splitlines())) <= 100
    effect = load_effect(path)
    assert effect.is_absent({s: 0.0 for s in effect.symbols().values()})


@pytest.mark.slow
def test_the_command_says_where_it_fails_and_writes_what_is_asked(tmp_path, capsys):
    wanted = {n: tmp_path / n for n in ("f.png", "f.json", "low_speed.py")}
    arguments = ["--figure", "f.png", "--json", "f.json", "--effect-file", "low_speed.py"]
    arguments = [str(wanted.get(a, a)) for a in arguments]
    assert main(["describe", str(example("rod")), "--as-is", *arguments]) == 0
    printed = capsys.readouterr().out
    assert "in both directions" in printed and "teleopdesign diagnose" in printed
    assert all(path.stat().st_size > 500 for path in wanted.values())


def test_bad_files_are_refused_before_the_work(tmp_path, capsys):
    folder = str(example("rod"))
    for option, name in (("--effect-file", "a-b.py"), ("--json", "x.txt"), ("--figure", "x.doc")):
        assert main(["describe", folder, option, str(tmp_path / name)]) == 2
        assert capsys.readouterr().err.count("\n") == 1
