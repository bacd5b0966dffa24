"""Drawings of diagrams: everything is there once, and wires keep clear of what is not theirs."""

from itertools import combinations, pairwise
from xml.etree import ElementTree

import pytest
from diagrams.random_diagrams import diagrams
from diagrams.several_axes import two_armed_teleoperator, two_rods
from diagrams.test_wiring import pair
from hypothesis import Phase, given, settings

from teleopdesign.diagrams import (
    ANY,
    Diagram,
    Junction,
    Linked,
    Moving,
    haptic_interface,
)
from teleopdesign.diagrams.shipped.world_haptics_2005 import world_haptics_2005
from teleopdesign.show import draw_diagram
from teleopdesign.show.figures.block_diagram.shapes import Box, Circle, Text, Wire

SHOWN = {
    "figure 1": haptic_interface(hand=ANY),
    "figure 3": haptic_interface(hand=ANY, cancellation=ANY, force_feedback=ANY),
    "figure 4": haptic_interface(hand=ANY, cancellation=ANY, force_feedback=ANY, position_loop=ANY),
    "with laws": world_haptics_2005(position_loop=True),
    "two bodies": pair(ANY, ANY, ANY),
    "two rods": two_rods(),
    "two arms": two_armed_teleoperator(),
}
NO_ROOM = 1e-6  # points; places are rounded to 0.01


def of(drawing, kind):
    return [s for s in drawing.shapes if isinstance(s, kind)]


def pieces(drawing):
    """(signal, left, top, right, bottom) of every straight piece of wire."""
    for wire in of(drawing, Wire):
        for (x0, y0), (x1, y1) in pairwise(wire.points):
            assert (x0 == x1) != (y0 == y1), "a wire that is not at right angles"
            yield wire.signal, min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)


def outline(shape):
    if isinstance(shape, Text):
        return shape.bounds
    if isinstance(shape, Box):
        w, h = shape.width / 2, shape.height / 2
    else:
        w = h = shape.radius
    return shape.x - w, shape.y - h, shape.x + w, shape.y + h


def overlap(a, b):
    """Whether two rectangles share more than an edge."""
    wide = min(a[2], b[2]) - max(a[0], b[0])
    high = min(a[3], b[3]) - max(a[1], b[1])
    return wide > NO_ROOM and high > NO_ROOM


def runs_through(piece, shape):
    left, top, right, bottom = outline(shape)
    inside = (left + 0.02, top + 0.02, right - 0.02, bottom - 0.02)  # 0.02: twice the rounding
    _, x0, y0, x1, y1 = piece
    return x0 < inside[2] and x1 > inside[0] and y0 < inside[3] and y1 > inside[1]


def on_each_other(a, b):
    if a[0] == b[0]:
        return False
    horizontal = a[2] == a[4] and b[2] == b[4] and a[2] == b[2]
    vertical = a[1] == a[3] and b[1] == b[3] and a[1] == b[1]
    return (horizontal and min(a[3], b[3]) > max(a[1], b[1])) or (
        vertical and min(a[4], b[4]) > max(a[2], b[2])
    )


def names_on(drawing):
    texts = [t for t in of(drawing, Text) if t.role == "signal"]
    return sorted(name.replace(" ", "") for t in texts for name in t.plain.split(" = "))


def boxes_of(diagram):
    """Names of the boxes that a diagram needs: a matrix has one for each row."""
    for block in diagram.blocks:
        if isinstance(block, Linked):
            yield from (f"{block.name} row {i}" for i in range(1, block.body.size + 1))
        else:
            yield block.name
    yield from (k.name for k in diagram.kinematics)
    yield from (f"lever arms of {j.output}" for j in diagram.junctions if j.arms)


def check(diagram):
    drawing = draw_diagram(diagram)
    blocks = sorted(b.block for b in of(drawing, Box) if b.block)  # others are bars
    assert blocks == sorted(boxes_of(diagram))
    assert names_on(drawing) == sorted(s.replace("_", "") for s in diagram.signals)
    lines = list(pieces(drawing))
    bodies = [*of(drawing, Box), *of(drawing, Circle)]
    assert not [(p, s) for p in lines for s in bodies if runs_through(p, s)]
    assert not [pair for pair in combinations(lines, 2) if on_each_other(*pair)]
    assert not [p for p in combinations(bodies, 2) if overlap(*map(outline, p))]
    texts = of(drawing, Text)
    assert not [p for p in combinations(texts, 2) if overlap(*map(outline, p))]
    left, top, right, bottom = 0.0, 0.0, drawing.width, drawing.height
    for _, x0, y0, x1, y1 in lines:
        assert left <= x0 and x1 <= right and top <= y0 and y1 <= bottom
    return drawing


@pytest.mark.parametrize("name", SHOWN)
def test_a_known_diagram_is_drawn_with_every_text_in_the_clear(name):
    drawing = check(SHOWN[name])
    outer = [t for t in of(drawing, Text) if t.role in ("signal", "sign")]
    for text in outer:
        assert not [b for b in of(drawing, Box) if overlap(outline(text), outline(b))]
        assert not [p for p in pieces(drawing) if runs_through(p, text)], text.plain


# 12 wirings in about 3 s, no search for a smaller one
@pytest.mark.slow
@settings(max_examples=12, phases=[Phase.generate])
@given(diagrams(geometry=True))
def test_in_any_drawing_everything_is_there_once_and_wires_keep_clear(diagram):
    check(diagram)


def test_every_term_of_a_sum_has_its_sign_or_weight():
    signs = [t.plain for t in of(draw_diagram(SHOWN["figure 3"]), Text) if t.role == "sign"]
    # E: + -, R_A: + + +, forces on Z_M: + -, R_M: - -
    assert sorted(s.replace("\u2212", "-") for s in signs) == sorted("+-++++---")


def test_a_title_with_markup_is_escaped(tmp_path):
    odd = '<a & "b"$x$\x07'
    diagram = Diagram(
        odd,
        (Moving("M", ANY, "x", "u", {}, "u"),),
        (Junction("y", {"x": 0.5}),),
        {"u": "force"},
        measured=(),
    )
    drawing = draw_diagram(diagram)
    drawing.to_svg(tmp_path / "odd.svg")
    root = ElementTree.parse(tmp_path / "odd.svg").getroot()
    assert '<a & "b"$x$?' in "".join(root.itertext())
    drawing.plot().savefig(tmp_path / "odd.png")
    assert "0.5" in [t.plain for t in of(drawing, Text)]
