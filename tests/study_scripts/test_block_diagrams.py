"""The papers' diagrams as drawn: their wiring is the one that formulas come from."""

import block_diagrams as study

from teleopdesign.derive import block_symbol, proved_equal, transfer
from teleopdesign.diagrams import read_diagram, write_diagram


def test_friction_and_its_cancellation_are_one_element_of_the_motion():
    """Figure 8 of Mahvash, Okamura, ICRA 2006: the force for a motion is Z + (f_C - f_D)."""
    Z, f_C, f_D = map(block_symbol, ("Z", "f_C", "f_D"))
    needed = transfer(study.pair(), "F", ("X",), given="X")["X"]
    assert proved_equal(needed, Z + f_C - f_D)


def test_every_diagram_is_the_same_when_read_from_its_file(tmp_path):
    for name, diagram in study.run().items():
        path = tmp_path / f"{name}.toml"
        write_diagram(diagram, path)
        assert read_diagram(path) == diagram, name
