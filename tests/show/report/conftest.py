"""The page of the shipped experiment's diagnosis, for all tests here."""

import pytest

from teleopdesign.show.report.page import page_of


@pytest.fixture(scope="session")
def diagnosis(rod_diagnosis):
    return rod_diagnosis


@pytest.fixture(scope="session")
def page(diagnosis):
    return page_of(diagnosis)
