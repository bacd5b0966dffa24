"""The page with a recording of two bodies."""

import gzip

import numpy as np
import pytest
from app.browser import CHROMIUM, WHY, opened, picture, press
from cases import make_case, write_case

#: two bodies with the whole catalogue, and whole records, take minutes
FEW = ["--only", "stribeck", "presliding", "spring", "coulomb_asymmetry"]
PART = 0.5


@pytest.fixture
def teleoperator(served):
    """(address, folder) of a page whose folder holds a teleoperator that lacks stribeck."""
    address, folder = served
    rng = np.random.default_rng(5)
    case = make_case(rng, "clear", effects=["stribeck"], kind="teleoperator")
    place = folder / "pair"
    write_case(case, place)
    for path in place.glob("*.csv.gz"):
        lines = gzip.decompress(path.read_bytes()).splitlines(keepends=True)
        path.write_bytes(gzip.compress(b"".join(lines[: 1 + int(PART * len(lines))])))
    return address, folder


@pytest.mark.slow
@pytest.mark.parametrize("served", [FEW], indirect=True)
@pytest.mark.skipif(CHROMIUM is None, reason=WHY)
def test_each_side_of_a_teleoperator_is_shown_and_gets_separate_effects(teleoperator):
    address, folder = teleoperator
    with opened(address, patience=900) as page:
        press(page, "Open")
        page.get_by_text("noise floor").first.wait_for()
        page.locator("canvas, svg.marks").first.wait_for()
        bodies = page.get_by_label("Body")
        assert bodies.locator("option").all_inner_texts() == ["master", "slave"]
        picture(page, folder, "teleoperator")
        bodies.select_option("slave")
        page.locator("canvas, svg.marks").first.wait_for()

        chosen = page.get_by_label("Candidate")
        chosen.wait_for()
        press(page, "Add")
        added = page.get_by_text("+ ", exact=False).filter(has_text=" at ").first
        added.wait_for()
        page.get_by_role("tab", name="Compare").click()
        page.get_by_role("cell", name="master.inertia").wait_for()
        page.get_by_role("cell", name="slave.inertia").wait_for()
        picture(page, folder, "teleoperator_compare")
        press(page, "Take back")
        compare = page.get_by_role("tabpanel", name="Compare")
        compare.get_by_text("Choose two models of the ladder").wait_for()
