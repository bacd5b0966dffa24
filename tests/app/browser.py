"""A real browser for tests of the page, and where its pictures go."""

import os
import shutil
from contextlib import contextmanager
from pathlib import Path

import pytest

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
WHY = "needs Chromium, which is not installed"
#: s that a step may take on a machine that does other things as well
PATIENCE = 240
FLAGS = (
    "--no-sandbox --disable-gpu --disable-background-networking --disable-component-update "
    "--disable-sync --no-first-run --disable-quic"
)
#: folder into which pictures of the page go too: those of the docs, where it is docs/_static
PICTURES = "TELEOPDESIGN_PICTURES"


@contextmanager
def opened(address, *, patience=PATIENCE):
    """The page at an address, in a browser that is closed in the end."""
    api = pytest.importorskip("playwright.sync_api", reason="needs playwright")
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS.split())
        page = browser.new_page(viewport={"width": 1200, "height": 1400})
        page.set_default_timeout(1000 * patience)
        page.goto(address)
        yield page
        browser.close()


def press(page, name):
    """Press a button by keyboard alone."""
    button = page.get_by_role("button", name=name, exact=True)
    button.focus()
    page.keyboard.press("Enter")


def picture(page, folder, name, settle=0, **options):
    """Take a picture of the page into the test's folder, and where `PICTURES` says.

    settle: ms in which a page that is for the docs may come to rest
    """
    if os.environ.get(PICTURES):
        page.wait_for_timeout(settle)
    path = folder / f"{name}.png"
    page.screenshot(path=path, **options)
    assert path.stat().st_size > 20_000, "the page is empty"
    if os.environ.get(PICTURES):
        shutil.copy(path, Path(os.environ[PICTURES]) / f"app_{name}.png")
