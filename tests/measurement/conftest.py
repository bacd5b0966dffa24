import numpy as np
import pytest
from measurement.rod_example import COUNT, PAIR, rows, write_rod
from shared_data import shared_folder


@pytest.fixture
def rod(tmp_path):
    """A good experiment with one body: the folder."""
    return write_rod(tmp_path / "rod")


@pytest.fixture
def pair(tmp_path):
    """A good experiment with two bodies of different axes and an environment: the folder."""
    folder = tmp_path / "pair"
    folder.mkdir()
    (folder / "experiment.toml").write_text(PAIR)
    columns = {name: np.arange(COUNT) for name in ("x_m", "u_m", "x_s", "u_s")}
    (folder / "fit.csv").write_text(rows(columns))
    return folder


@pytest.fixture
def edit():
    """edit(file, old, new): replace a text that must be there."""

    def replace(file, old, new):
        text = file.read_text()
        assert old in text
        file.write_text(text.replace(old, new, 1))

    return replace


@pytest.fixture(scope="session")
def shared():
    """Folder of measurements outside the package; without it tests of them are skipped."""
    return shared_folder("data").parent
