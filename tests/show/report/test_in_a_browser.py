"""The report in a real browser: figures open, grow and are saved; the page prints on A4."""

import base64
import hashlib
import re
import zlib
from xml.etree import ElementTree

import pytest
from app.browser import CHROMIUM, FLAGS, WHY

from teleopdesign.show.report import write_report


@pytest.fixture(scope="module")
def path(diagnosis, tmp_path_factory):
    file = tmp_path_factory.mktemp("page") / "report.html"
    write_report(diagnosis, file)
    return file


def test_the_policy_of_the_page_allows_the_script_of_the_page_alone(path):
    text = path.read_text(encoding="utf-8")
    script = re.search(r"<script>(.*?)</script>", text, re.DOTALL)[1]
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)[1]
    assert policy.startswith("default-src 'none'; img-src data:;")
    assert policy.endswith(f"script-src 'sha256-{digest}'")


@pytest.fixture
def browser():
    api = pytest.importorskip("playwright.sync_api", reason="needs playwright")
    if CHROMIUM is None:
        pytest.skip(WHY)
    with api.sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS.split())
        yield chromium
        chromium.close()


@pytest.mark.slow
def test_a_figure_opens_grows_and_is_saved_as_svg(browser, path, tmp_path):
    page = browser.new_page(viewport={"width": 1200, "height": 900}, accept_downloads=True)
    complaints = []
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(path.as_uri())
    figure = page.locator("figure img").first
    figure.focus()
    page.keyboard.press("Enter")
    dialog = page.get_by_role("dialog")
    dialog.wait_for()
    large = dialog.locator("img")
    before = large.bounding_box()["width"]
    page.keyboard.press("+")
    assert large.bounding_box()["width"] == pytest.approx(1.5 * before, rel=0.01)
    page.screenshot(path=tmp_path / "zoomed.png")
    dialog.get_by_role("button", name="Whole").click()
    assert large.bounding_box()["width"] == pytest.approx(before, rel=0.01)
    with page.expect_download() as download:
        dialog.get_by_role("button", name="Save as SVG").click()
    assert download.value.suggested_filename.endswith(".svg")
    download.value.save_as(tmp_path / "figure.svg")
    assert ElementTree.parse(tmp_path / "figure.svg").getroot().tag.endswith("svg")
    page.keyboard.press("Escape")
    dialog.wait_for(state="hidden")
    assert complaints == [], "the page's policy refuses nothing of its own"


@pytest.mark.slow
def test_the_page_prints_on_a4(browser, path, tmp_path):
    page = browser.new_page()
    page.goto(path.as_uri())
    printed = page.pdf(path=tmp_path / "report.pdf", prefer_css_page_size=True)
    boxes = re.findall(rb"/MediaBox\s*\[([^\]]*)\]", printed + _unpacked(printed))
    assert boxes
    for box in boxes:
        # A4 in points
        assert [float(x) for x in box.split()] == pytest.approx([0, 0, 595, 842], abs=1.5)


def _unpacked(pdf):
    """Streams of a PDF that hold objects, unpacked."""
    parts = []
    for stream in re.findall(rb"stream\r?\n(.*?)endstream", pdf, re.DOTALL):
        try:
            parts.append(zlib.decompress(stream))
        except zlib.error:
            continue
    return b"".join(parts)
