"""Whatever a file holds, it is read or refused in one line: nothing else comes out."""

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from measurement.rod_example import write_rod

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement import Experiment, load_experiment


@pytest.fixture(scope="module")
def template(tmp_path_factory):
    return write_rod(tmp_path_factory.mktemp("mutations") / "rod")


@st.composite
def mutations(draw, text):
    """The text of a file with a part cut out, doubled, or replaced by something else."""
    lines = text.split("\n")
    kind = draw(st.sampled_from(["cut", "replace", "delete line", "double line", "swap values"]))
    if kind in ("delete line", "double line"):
        i = draw(st.integers(0, len(lines) - 1))
        return "\n".join(
            lines[:i] + lines[i : i + 1] * (0 if "delete" in kind else 2) + lines[i + 1 :]
        )
    start = draw(st.integers(0, len(text) - 1))
    stop = min(len(text), start + draw(st.integers(0, 12)))
    if kind == "cut":
        return text[:start] + text[stop:]
    if kind == "replace":
        return text[:start] + draw(st.text(max_size=8)) + text[stop:]
    values = [
        m.span() for m in re.finditer(r'"[^"]*"|\b[\d.]+(e-?\d+)?\b|\{[^{}]*\}|true|false', text)
    ]
    (a, b), (c, d) = draw(st.sampled_from(values)), draw(st.sampled_from(values))
    return text[:a] + text[c:d] + text[b:]


@given(data=st.data())
@settings(max_examples=100)
def test_any_change_of_the_toml_is_read_or_refused_in_one_line(template, data):
    original = (template / "experiment.toml").read_text()
    text = data.draw(mutations(original))
    try:
        (template / "experiment.toml").write_bytes(text.encode("utf-8", "surrogatepass"))
        assert isinstance(load_experiment(template), Experiment)
    except ExperimentError as error:
        assert str(error).isprintable()
        assert str(error).startswith("rod")
    finally:
        (template / "experiment.toml").write_text(original)


@given(data=st.data())
@settings(max_examples=50)
def test_any_change_of_a_table_is_read_or_refused_in_one_line(template, data):
    original = (template / "fit.csv").read_text()
    text = data.draw(mutations(original))
    try:
        (template / "fit.csv").write_bytes(text.encode("utf-8", "surrogatepass"))
        assert isinstance(load_experiment(template), Experiment)
    except ExperimentError as error:
        assert str(error).isprintable()
        assert str(error).startswith("rod/")
    finally:
        (template / "fit.csv").write_text(original)
