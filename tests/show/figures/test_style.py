"""Names in any language: fonts of the machine behind those of the house style, boxes said."""

import warnings

import matplotlib.pyplot as plt
import pytest

from teleopdesign.show.figures.style import house_style

#: Arabic: in DejaVu Sans, which comes with matplotlib, and in no font of the house style
ARABIC = "قوة (N)"


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
