"""Forces planted in a residual, and what is said of them."""

from dataclasses import replace

from teleopdesign import load_effect
from teleopdesign.show.unexplained.sentences import sentence_for
from teleopdesign.unexplained.curve import curve_of
from teleopdesign.unexplained.dependence import contrasts, model_columns
from teleopdesign.unexplained.effect_file import write_effect
from teleopdesign.unexplained.formula import formula_for


def planted(rows, missing):
    """The rows with a force missing(along) that the model lacks, as the residual shows it."""
    return replace(rows, residual=rows.residual + rows.lowpassed(lambda a: missing(a)[None])[:, 0])


def sentence_on(rows, dependence, axis="prismatic"):
    """The sentence about a dependence, with its formula."""
    formula = formula_for(rows, model_columns(rows), dependence)
    left = rows.residual * rows.root
    sides = contrasts(rows, dependence, left)
    return sentence_for(dependence.shape, curve_of(rows, dependence), formula, sides, axis), formula


def written(tmp_path, name, dependence, prepared, described=None):
    part, largest = dependence.largest
    path = tmp_path / f"{name}.py"
    write_effect(path, part, described or largest, prepared)
    return load_effect(path)
