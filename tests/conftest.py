"""What all tests share: how examples are drawn, one diagnosis of the shipped rod, two test devices.

Under CI the property-based tests draw the same examples each time; elsewhere new ones: thirty where
a test says no other number. None has a deadline: on a loaded machine it would measure the load.
The truth simulator of tests/hidden can be imported everywhere.
"""

import gc
import gzip
import os
import shutil
import sys
from collections import defaultdict
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from devices import CANCELLATION, FEEDBACK, LOOP, LUGRE, body
from few_effects import FEW
from hypothesis import HealthCheck, settings

from teleopdesign.diagrams import haptic_interface

sys.path.insert(0, str(Path(__file__).parent / "hidden"))

# what one process has compiled to bytecode, the others and the next run need not compile again:
# half of the time of collecting the tests
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

# objects between two looks for garbage. Python's own 700 suit a small heap: here looking took two
# thirds of the time of parsing the package, and a tenth of symbolic work
gc.set_threshold(50_000, 20, 20)

#: both would measure the load of the machine: a time for each example, and for drawing the first
TIMELESS = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("ci", derandomize=True, max_examples=30, **TIMELESS)
settings.register_profile("here", max_examples=30, **TIMELESS)
settings.load_profile("ci" if os.environ.get("CI") else "here")

#: steps of one structure that a test simulates in plain Python
SHORT = 10_000

#: folder or file of tests -> what it shares with others and costs seconds: they stay together
TOGETHER = {
    "diagnose": "a diagnosis of a simulated case",
    "next_experiment": "a diagnosis of a simulated case",
    "design": "a diagnosis of the rod",
    "report": "a diagnosis of the rod",
    "unexplained": "a fit of the rod",
    "test_export_command": "a diagnosis of the short rod",
    "test_first_screen": "a diagnosis of the short rod",
    "test_report_command": "a diagnosis of the short rod",
    "test_simulate_command": "a diagnosis of the short rod",
    "test_dependencies": "syntax trees",
    "test_function_names": "syntax trees",
    "test_import_circles": "syntax trees",
    "test_imports": "syntax trees",
    "test_python_control": "syntax trees",
    "test_registry": "syntax trees",
    "test_words_and_sizes": "syntax trees",
    "test_writing": "syntax trees",
}


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Tests of one file go to one worker, so that no fixture is made twice; those of some folders.

    Slow tests are single pieces of work: the worker that has none left takes from the other.
    """
    from xdist.scheduler import LoadScopeScheduling, WorkStealingScheduling

    if config.option.markexpr == "slow":
        return WorkStealingScheduling(config, log)

    class ByFile(LoadScopeScheduling):
        def _split_scope(self, nodeid):
            file = nodeid.partition("::")[0]
            path = Path(file)
            return TOGETHER.get(path.parent.name) or TOGETHER.get(path.stem, file)

    return ByFile(config, log)


@pytest.hookimpl(wrapper=True)
def pytest_collection(session):
    """What is collected stays: the collector of garbage need not look at it again and again."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


@pytest.fixture(scope="session", autouse=True)
def all_trees():
    """How many trees the black box has; in tests it has few, for it only goes along with most.

    With all of them it takes half a second of each diagnosis, and seconds without check records.
    """
    from teleopdesign.diagnose import learnable

    with pytest.MonkeyPatch.context() as patch:
        every = learnable.TREES
        patch.setattr(learnable, "TREES", 5)
        yield every


@pytest.fixture(scope="session")
def plain_simulations():
    """The first `SHORT` steps of a structure in each test run in plain Python: the same source.

    To compile a structure takes 1 to 4 s, to load its machine code 0.1 s; 10 000 steps in plain
    Python take a third of a second. Yields the steps that are left, by structure.
    """
    from teleopdesign.realise import program, side_by_side

    compiled, left = program.loop_of, defaultdict(lambda: SHORT)

    @lru_cache(maxsize=256)
    def loop_of(laws, lanes):
        source = program.module_source(laws, jit=False, lanes=lanes)
        plain = program._entries(program._execute(source), lanes)

        def run(steps, function, *arguments):
            left[laws] -= steps * lanes
            loop = plain if left[laws] >= 0 else compiled(laws, lanes)
            with np.errstate(all="ignore"):  # plain Python warns where compiled code returns inf
                getattr(loop, function)(*arguments)

        return program.CompiledLoop(
            lanes,
            lambda samples, inner, *rest: run(samples * inner, "run", samples, inner, *rest),
            lambda *arguments: run(len(arguments[-1]), "follow", *arguments),
            lambda *arguments: run(0, "differentiate_at_rest", *arguments),
        )

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(program, "loop_of", loop_of)
        patch.setattr(side_by_side, "loop_of", loop_of)
        yield left


@pytest.fixture
def compiled_simulations(plain_simulations, monkeypatch):
    """No step of a simulation runs in plain Python."""
    monkeypatch.setattr(plain_simulations, "default_factory", lambda: -1)
    plain_simulations.clear()
    yield
    plain_simulations.clear()


@pytest.fixture(autouse=True)
def short_simulations(plain_simulations):
    """Each test has separate steps; those of `realise` have none (see there)."""
    plain_simulations.clear()


@pytest.fixture(scope="session", autouse=True)
def no_picture():
    """`teleopdesign new` draws no picture, which is a third of its time; `picture` has it drawn."""
    from teleopdesign.show.figures import log

    drawn = {name: getattr(log, name) for name in ("draw_survey", "save_survey")}
    with pytest.MonkeyPatch.context() as patch:
        for name in drawn:
            patch.setattr(log, name, lambda *arguments: None)
        yield drawn


@pytest.fixture
def picture(no_picture, monkeypatch):
    """`teleopdesign new` draws its picture."""
    for name, draw in no_picture.items():
        monkeypatch.setattr(f"teleopdesign.show.figures.log.{name}", draw)


@pytest.fixture
def hybrid():
    """LuGre device, 0.5 kg in place of the hand, hybrid compensation, position loop."""
    return haptic_interface(
        body(**LUGRE),
        hand=body(0.5),
        cancellation=CANCELLATION,
        force_feedback=FEEDBACK,
        position_loop=LOOP,
    )


@pytest.fixture
def choose_from(monkeypatch):
    """choose_from(names): from here on the commands choose from these effects and a user's own."""
    from teleopdesign import effects

    known = effects.catalogue

    def limit(names):
        monkeypatch.setattr(
            effects,
            "catalogue",
            lambda extra=(): {
                n: e for n, e in known(extra).items() if n in names or n not in effects.EFFECTS
            },
        )

    return limit


@pytest.fixture
def few(choose_from):
    """The commands choose from `FEW`: a diagnosis takes a second or two."""
    choose_from(FEW)


@pytest.fixture(scope="session")
def short_rod(tmp_path_factory):
    """The shipped rod with the first third of each record: enough for its missing effect."""
    from teleopdesign import example

    folder = Path(shutil.copytree(example("rod"), tmp_path_factory.mktemp("short") / "rod"))
    for name in ("fit.csv.gz", "check.csv.gz"):
        path = folder / name
        lines = gzip.decompress(path.read_bytes()).decode().splitlines(keepends=True)
        path.write_bytes(gzip.compress("".join(lines[: 1 + len(lines) // 3]).encode(), mtime=0))
    return folder


@pytest.fixture(scope="session")
def rod_diagnosis():
    """The shipped experiment, diagnosed among few effects."""
    from teleopdesign import EFFECTS, Model, example, find_missing, load_experiment

    experiment = load_experiment(example("rod"))
    known = {n: EFFECTS[n] for n in FEW}
    return find_missing(experiment, Model.from_experiment(experiment, known))


@pytest.fixture(scope="session")
def rod_answer(rod_diagnosis, tmp_path_factory):
    """The answer file of that diagnosis."""
    from teleopdesign.diagnose.answer import write_answer

    path = tmp_path_factory.mktemp("rod") / "answer.json"
    write_answer(rod_diagnosis, path)
    return path
