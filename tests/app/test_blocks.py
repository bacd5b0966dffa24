"""A whole diagram on the page: picture, candidates of each block, verdict, and files."""

import json

import matplotlib.figure
import numpy as np
import pytest
from app.browser import CHROMIUM, WHY, opened, picture, press
from block_cuts.interface_simulator import draw_interface, write_case

import teleopdesign as td
from teleopdesign.app import blocks


@pytest.fixture(scope="module")
def diagnosis(tmp_path_factory):
    """The computer's cut of a simulated interface of which the force feedback is late."""
    place = tmp_path_factory.mktemp("app") / "interface"
    write_late_interface(place)
    return td.find_missing(td.load_experiment(place), at=["R_A"])


def write_late_interface(place):
    random = np.random.default_rng(4)
    interface = draw_interface(random)
    interface.hidden["delay", "H"] = 0.006
    write_case(interface, place, random, durations=(4.0, 2.5))


def test_candidates_are_listed_by_block_with_the_answer_of_the_diagnosis(diagnosis):
    assert blocks.places(diagnosis) == (blocks.EVERY, "H", "C", "computer")
    rows = blocks.candidate_rows(diagnosis)
    answer = diagnosis.answer()["candidates"]
    assert [(r["effect"], r["at"]) for r in rows] == [(c["effect"], c["at"]) for c in answer]
    missing = {(r["effect"], r["at"]) for r in rows if r["verdict"] == "missing"}
    assert missing == {*diagnosis.missing} == {("delay", "H")}
    assert {r["at"] for r in blocks.candidate_rows(diagnosis, "C")} == {"C"}
    assert "delay" in blocks.verdict(diagnosis)


def test_what_is_written_is_read_again(diagnosis, tmp_path):
    line = blocks.write_all(diagnosis, tmp_path)
    written = tmp_path / "results" / diagnosis.experiment.folder.name
    assert {p.name for p in written.iterdir()} == {"report.html", "answer.json", "blocks.svg"}
    assert all(p.name in line for p in written.iterdir())
    assert json.loads((written / "answer.json").read_text())["verdict"] == diagnosis.verdict
    figures = blocks.residual_figures(diagnosis)
    assert all(isinstance(f, matplotlib.figure.Figure) for f in figures.values())


@pytest.mark.slow
@pytest.mark.parametrize("served", [["--only", "spring", "bias"]], indirect=True)
@pytest.mark.skipif(CHROMIUM is None, reason=WHY)
def test_the_page_shows_the_diagram_with_its_errors_and_candidates(served):
    address, folder = served
    write_late_interface(folder / "interface")
    with opened(address, patience=900) as page:
        page.set_viewport_size({"width": 1200, "height": 1900})
        press(page, "Open")
        page.get_by_text("delay at H").first.wait_for()
        page.get_by_label("Block").select_option("H")
        page.get_by_role("cell", name="missing", exact=True).wait_for()
        picture(page, folder, "blocks")
