"""What draws itself says on its axes what is drawn, and in which unit."""

import re

import matplotlib.pyplot as plt
import pytest
from example_objects import QUICK

#: a quantity, then its unit in brackets at the end
WITH_UNIT = re.compile(r".*\S \([^()]+\)$", re.DOTALL)
PLOTTED = (
    "simulation",
    "force over velocity",
    "frequency response",
    "port energy",
    "study",
)


@pytest.mark.parametrize("name", PLOTTED)
def test_every_label_of_an_axis_ends_with_a_unit(name):
    figure = QUICK[name]().plot()
    try:
        labels = [t for a in figure.axes for t in (a.get_xlabel(), a.get_ylabel()) if t]
        labels += [t for t in (figure.get_supxlabel(), figure.get_supylabel()) if t]
        assert len(labels) >= 2, "one axis across, one up"
        assert [t for t in labels if not WITH_UNIT.match(t)] == []
    finally:
        plt.close(figure)
