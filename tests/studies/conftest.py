"""Each file of tests is named after the study that it tests; the fixture `study` is its module."""

import importlib.util
import sys
from pathlib import Path

import pytest

STUDIES = Path(__file__).parents[2] / "studies"


@pytest.fixture(scope="module")
def study(request):
    name = Path(request.module.__file__).stem.removeprefix("test_")
    sys.path.insert(0, str(STUDIES))  # studies share modules of their own
    try:
        spec = importlib.util.spec_from_file_location(name, STUDIES / f"{name}.py")
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module  # its dataclasses look themselves up
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(STUDIES))
    yield module
    del sys.modules[name]
