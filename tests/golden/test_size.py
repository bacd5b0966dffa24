"""The figures of `make size`, on a small package whose figures are known."""

import importlib.util
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

FILES = {
    "__init__.py": "from .effects import EFFECTS\n",
    "effects/__init__.py": "from . import drag\nEFFECTS = {'drag': drag.EFFECT}\n",
    "effects/drag.py": "EFFECT = 3.0\nNAME = 'drag'\n",
    "effects/_helper.py": "HALF = 1 / 2\n",
    "house/one.py": '''"""A module about drag."""

from ..effects._helper import HALF
from . import two

LIMIT: float = 0.25
BOTH, TEXT = (1.0, -2e3), "drag"
SIZES = {"small": 1, "large": 10}
FLAG = True


class Tall:
    height: float = 1.8
    name = "drag.coefficient"

    def grows(self, x):
        return 0 < x <= 3.5 * self.height and x != -1


def steep(x, y):
    import teleopdesign.house.three

    return x > HALF or y[7] == 2 or abs(y) < max(5, 6) - 4
''',
    "house/two.py": "from teleopdesign.house import three\n\n",
    "house/three.py": "",
    "house/page.jinja": "<p>\n</p>\n",
    "house/table.csv.gz": "\n\n\n",
    "house/__pycache__/one.pyc": "\n\n\n",
}


@pytest.fixture(scope="module")
def size():
    path = ROOT / "golden" / "size.py"
    spec = importlib.util.spec_from_file_location("golden_size", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def package(tmp_path):
    for name, text in FILES.items():
        path = tmp_path / "teleopdesign" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path / "teleopdesign"


def test_lines_and_files_are_those_of_text(size, package):
    house = sum(FILES[f"house/{n}"].count("\n") for n in ("one.py", "two.py", "page.jinja"))
    assert size.text_lines(package) == {".": 1, "effects": 5, "house": house}
    assert size.number_of_files(package) == 8


def test_thresholds_are_constants_fields_and_numbers_of_comparisons(size, package):
    counts = size.thresholds(package)
    # EFFECT and HALF; LIMIT and SIZES (BOTH is set beside a text); 3.5 and 4, but no 0, -1 and 2
    assert counts["effects"] == {"constants": 2, "fields": 0, "comparisons": 0}
    assert counts["house"] == {"constants": 2, "fields": 1, "comparisons": 2}
    assert counts["."] == {"constants": 0, "fields": 0, "comparisons": 0}


def test_every_way_of_importing_is_counted(size, package):
    counts = size.importers(package)
    assert counts["teleopdesign.effects.drag"] == {"teleopdesign.effects"}
    assert counts["teleopdesign.house.three"] == {
        "teleopdesign.house.one",
        "teleopdesign.house.two",
    }
    assert size.single_importers(package) == {
        "teleopdesign.effects._helper": "teleopdesign.house.one",
        "teleopdesign.effects.drag": "teleopdesign.effects",
        "teleopdesign.house.two": "teleopdesign.house.one",
    }


def test_names_of_effects_are_counted_where_they_are_texts(size, package):
    """The texts "drag" and "drag.coefficient", but no word of a sentence and no effect's file."""
    assert size.effect_names(package) == {"house/one.py": 2}


def test_tests_count_as_lines_and_their_data_in_kilobytes(size, tmp_path):
    (tmp_path / "test_a.py").write_text("a\nb\n")
    (tmp_path / "log.csv").write_text("1,2\n" * 500)
    assert size.test_lines(tmp_path) == {"lines": 2, "data_files": 1, "data_kB": 2}


def test_a_bode_plot_loads_the_folders_that_it_needs(size):
    loaded = size.modules_of_a_bode_plot()
    assert "teleopdesign.diagrams" in loaded and "teleopdesign.frequency" in loaded
    assert not [m for m in loaded if m.startswith(("teleopdesign.app", "teleopdesign.report"))]
