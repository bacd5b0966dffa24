"""The page in a real browser, from a folder to the exported report."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request

import pytest

from teleopdesign import example
from teleopdesign.app.settings import FOLDER

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
WHY = "needs Chromium, which is not installed"
#: s that a step may take on a machine that does other things as well
PATIENCE = 240
FLAGS = (
    "--no-sandbox --disable-gpu --disable-background-networking --disable-component-update "
    "--disable-sync --no-first-run --disable-quic"
)


@pytest.fixture
def served(tmp_path):
    """(address with its token, folder) of a page that is served until the test ends."""
    pytest.importorskip("marimo", reason="needs the extra app")
    tmp_path = tmp_path / "laboratory"
    tmp_path.mkdir()
    process = subprocess.Popen(
        [sys.executable, "-m", "teleopdesign.cli", "app", str(tmp_path), "--no-browser"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={k: v for k, v in os.environ.items() if k != FOLDER} | {"PYTHONUNBUFFERED": "1"},
    )
    try:
        assert process.stdout is not None
        line = process.stdout.readline()
        address = re.search(r"http\S+", line)
        assert address, line
        yield address.group(), tmp_path
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(30)
        process.stdout.close()


def status(address):
    for _ in range(50):  # the address is printed before the first request is taken
        try:
            with urllib.request.urlopen(address, timeout=10) as reply:
                return reply.status, reply.url
        except urllib.error.HTTPError as error:
            return error.code, address
        except urllib.error.URLError:
            time.sleep(0.2)
    raise AssertionError(f"no reply from {address}")


def test_the_page_is_for_this_machine_and_for_whoever_has_the_token(served):
    address, _ = served
    assert address.startswith("http://127.0.0.1:")
    assert status(address)[0] == 200
    code, url = status(address.partition("?")[0])
    assert code in (401, 403) or "login" in url  # a page that asks for the token, and no more
    code, url = status(address.partition("?")[0] + "?access_token=wrong")
    assert code in (401, 403) or "login" in url


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason=WHY)
def test_from_a_dropped_log_to_the_exported_report(served, tmp_path):
    address, folder = served
    api = pytest.importorskip("playwright.sync_api", reason="needs playwright")
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS.split())
        page = browser.new_page(viewport={"width": 1200, "height": 1400})
        page.set_default_timeout(1000 * PATIENCE)
        page.goto(address)

        def press(name):
            """By keyboard alone."""
            button = page.get_by_role("button", name=name, exact=True)
            button.focus()
            page.keyboard.press("Enter")

        page.get_by_text("Bring a log of your own").click()
        log = shutil.copy(example("rod") / "fit.csv.gz", tmp_path / "swing.csv.gz")
        page.locator("input[type=file]").set_input_files(log)
        page.get_by_role("cell", name="actuator_force").wait_for()
        page.get_by_label("hand force").select_option("f_h")
        page.get_by_role("cell", name="interaction_force").wait_for()
        page.screenshot(path=folder / "log.png", full_page=True)
        press("Make the experiment")
        page.get_by_text("swing_experiment is made").wait_for()
        press("Open")
        page.get_by_text("noise floor").first.wait_for()
        page.locator("canvas, svg.marks").first.wait_for()  # the charts are drawn
        page.screenshot(path=folder / "opened.png")
        assert page.get_by_role("button", name="Take back", exact=True).is_disabled()

        press("Add")
        page.get_by_text("+ stribeck at device").first.wait_for()
        press("Take back")
        page.get_by_text("+ stribeck at device").first.wait_for(state="detached")
        press("Add")
        page.get_by_text("+ stribeck at device").first.wait_for()
        page.get_by_role("tab", name="Parameters").click()
        page.get_by_role("columnheader", name="as estimated").wait_for()
        page.get_by_role("tab", name="Export").click()
        press("Write report, answer, model and script")
        page.get_by_text("written to results/swing_experiment").first.wait_for()
        page.screenshot(path=folder / "exported.png")
        browser.close()
    results = folder / "results" / "swing_experiment"
    assert {p.name for p in results.iterdir()} == {
        "report.html",
        "answer.json",
        "figure.svg",
        "script.py",
    }
    assert "stribeck" in (results / "answer.json").read_text()
    assert "with_effect('stribeck', at='device')" in (results / "script.py").read_text()
