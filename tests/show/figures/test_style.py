"""Names in any language: fonts of the machine behind those of the house style, boxes said."""

import warnings

import matplotlib.pyplot as plt
import pytest
from matplotlib.figure import Figure

from teleopdesign.show.figures import style
from teleopdesign.show.figures.style import explain_boxes, further_fonts, house_style
from teleopdesign.show.report.figures import picture

#: Arabic: in DejaVu Sans, which comes with matplotlib, and in no font of the house style
ARABIC = "قوة (N)"
#: of a script that no font of the list has
CUNEIFORM = "\U00012000"


@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
def test_a_letter_that_the_house_style_lacks_comes_from_another_font(tmp_path, suffix):
    with plt.style.context(house_style()):
        figure, axes = plt.subplots()
        axes.set_ylabel(ARABIC)
        axes.set_xlabel("velocity (m/s)")
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # "Glyph 1602 missing from font(s) STIXGeneral"
        figure.savefig(tmp_path / f"figure.{suffix}")
    plt.close(figure)


def test_fonts_that_are_not_here_are_not_asked_for(caplog):
    """Matplotlib logs a line for each family that it does not find."""
    with plt.style.context(house_style()):
        figure, axes = plt.subplots()
        axes.set_ylabel("force (N)")
        figure.canvas.draw()
    plt.close(figure)
    assert not caplog.records


def test_letters_without_a_font_are_reported_in_one_line_with_what_helps():
    line = explain_boxes(["time (s)", f"{CUNEIFORM} (deg)"])
    assert CUNEIFORM in line and "install" in line and "\n" not in line
    assert explain_boxes(["Zeit (µs)", "Händkraft", ARABIC]) == ""


def test_a_font_that_is_here_is_used(monkeypatch):
    further_fonts.cache_clear()
    monkeypatch.setattr(style, "MANY_LETTERS", ("No Such Font", "DejaVu Sans Mono"))
    assert further_fonts() == ("DejaVu Sans Mono",)
    further_fonts.cache_clear()


def test_a_picture_of_a_page_keeps_letters_that_no_font_here_has():
    def draw(figure: Figure) -> None:
        figure.subplots().set_title(CUNEIFORM)

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert picture(draw, size=(2.0, 1.0), alt="a name")
