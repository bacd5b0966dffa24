"""What a user holds pickles, copies, compares by value, and prints in a few lines."""

import copy
import dataclasses
import inspect
import pickle
import subprocess
import sys
from collections.abc import Mapping
from xml.etree import ElementTree

import pytest
from example_objects import BODY, LAW, QUICK, SLOW

import teleopdesign as td
from teleopdesign.base.frozen import Frozen, is_same

EVERY = [
    *(pytest.param(make, id=name) for name, make in QUICK.items()),
    *(pytest.param(make, id=name, marks=pytest.mark.slow) for name, make in SLOW.items()),
]


@pytest.mark.parametrize("make", EVERY)
def test_a_copy_is_equal_and_it_prints_in_a_few_lines_and_in_a_notebook(make):
    thing = make()
    text, copied = repr(thing), copy.deepcopy(thing)
    assert copied == thing == pickle.loads(pickle.dumps(thing)) and repr(copied) == text
    # a design says its reasons and predictions: a page of sentences, everything else is a table
    # of which the ranking's has a line for each effect of the catalogue
    most = 6000 if isinstance(thing, td.Design) else 3500
    assert 0 < len(text) < most and len(text.splitlines()) < most / 50
    assert "array(" not in text and " object at 0x" not in text
    if has_a_hash(thing):
        assert hash(pickle.loads(pickle.dumps(thing))) == hash(thing)
    shown = getattr(thing, "_repr_html_", lambda: None)()
    if shown is not None:
        ElementTree.fromstring(shown.replace("<br>", "<br/>"))
        assert len(shown) < 15_000


def has_a_hash(thing):
    """What holds a mapping that can be changed has none."""
    try:
        hash(thing)
    except TypeError:
        return False
    return True


SOURCE = '''"""Own drag."""

from teleopdesign import Effect, Parameter


def law(now, p):
    return p.drag * now.velocity


EFFECT = Effect(
    role="force",
    law=law,
    parameters={"drag": Parameter("damping", "any")},
    absent={"drag": 0.0},
)
'''


def test_an_effect_file_pickles_by_its_path_and_is_refused_when_it_has_changed(tmp_path):
    file = tmp_path / "own.py"
    file.write_text(SOURCE)
    effect = td.load_effect(file)
    assert td.load_effect(file) is effect
    data = pickle.dumps(BODY.with_effect(effect, {"drag": 1.0}))
    assert pickle.loads(data).effect("own") is effect
    code = "import pickle, sys; print(pickle.load(sys.stdin.buffer).parameters['own.drag'].value)"
    run = subprocess.run([sys.executable, "-c", code], input=data, capture_output=True, check=True)
    assert run.stdout.split() == [b"1.0"]
    file.write_text(SOURCE.replace("now.velocity", "now.position"))
    changed = td.load_effect(file)
    assert changed is not effect and changed != effect
    with pytest.raises(td.ModelError, match="own.py: the file has changed"):
        pickle.loads(data)


def a_law(now, p):
    return p.drag * now.velocity


def test_a_frozen_mapping_cannot_be_changed_and_equals_a_dictionary():
    frozen = Frozen({"a": 1})
    assert frozen == {"a": 1} and {"a": 1} == frozen and hash(frozen) == hash(Frozen({"a": 1}))
    assert frozen | {"b": 2} == {"a": 1, "b": 2} == {"b": 2} | frozen
    with pytest.raises(TypeError):
        frozen["a"] = 2
    with pytest.raises(TypeError):
        frozen.other = 2
    with pytest.raises(KeyError):
        frozen["b"]


def test_names_are_escaped_in_notebooks():
    bad = "<script>alert('x')</script> & co"
    effect = td.Effect(
        role="force",
        law=a_law,
        parameters={"drag": td.Parameter("damping", bad)},
        absent={"drag": 0.0},
        source=bad,
    ).named(bad, bad)
    diagram = td.haptic_interface(BODY, cancellation=LAW)
    simulation = QUICK["simulation"]()
    named = simulation.data.assign_attrs(scheme=bad).rename({"R_A": bad})
    shown = [
        effect,
        td.Model({bad: BODY}),
        BODY.with_effect(effect),
        td.Diagram(bad, diagram.blocks, diagram.junctions, diagram.outside, diagram.measured),
        td.Simulation(simulation.diagram, named),
        td.Claim(bad, td.passivity.Unknown(bad)),
    ]
    for thing in shown:
        assert "<script>" not in thing._repr_html_() and "&lt;script&gt;" in thing._repr_html_()


#: made by a diagnosis, a design, a proposal or a search that takes seconds, or a part of its result
DEAR = set(
    """
    HorizonError RecordedLoop SimulationComparison ArmPaths DeterminedParameter
    Proposal Workbench Reference Remedy Rival Separation SimulatedDiagnosis
    ForceDisplacement Loop BlockDiagnosis Verification
    CoulombLevel LargestStiffness LevelAtSpeed Line SteadyRun MarginMap
    PassivityControlled Region SecondOpinion SimulatedMotion Given SimulationFit Tuned CheckedLimit
    ParetoFront Point PointOutcome Progress TunedControllers Setup BodyEquation ControllerEquation
    RecordFacts EnvironmentDescription ExperimentError ModelError TeleopDesignError
    Arm DahlBehindSpring Linked Reading Unknown Amount
    BodyResidual CasePrediction Comparison DescribedDependence Design Diagnosis LadderRow
    FeedbackLoop Fit Prediction ProposedController Ranked Ranking Reason ResidualDescription
    ResidualFriction Rung CheckedRecording RecordingCheck
""".split()
)


def reached(things):
    """Every dataclass among these and what they hold, one of each class."""
    classes, kept, ahead = {}, {}, list(things)
    while ahead:
        thing = ahead.pop()
        if isinstance(thing, Mapping):
            ahead += thing.values()
        elif isinstance(thing, list | tuple):
            ahead += thing[:50]
        elif dataclasses.is_dataclass(thing) and not isinstance(thing, type):
            classes.setdefault(type(thing), thing)
            if id(thing) not in kept:
                kept[id(thing)] = thing  # kept: no other object then has this number
                ahead += [getattr(thing, f.name) for f in dataclasses.fields(thing)]
    return classes


def public_classes():
    for folder in sorted(n for n in dir(td) if inspect.ismodule(getattr(td, n))):
        module = getattr(td, folder)
        for name in getattr(module, "__all__", ()):
            if inspect.isclass(getattr(module, name)):
                yield getattr(module, name)


@pytest.mark.slow
def test_every_public_class_pickles_copies_and_prints():
    """Those of the examples, and what they hold; a new class needs an example, or a reason."""
    classes = reached(make() for make in QUICK.values())
    public = {c for c in public_classes() if dataclasses.is_dataclass(c)}
    for kind in public & classes.keys():
        thing = classes[kind]
        # a state holds code: the effect or the law that it belongs to pickles, by its name
        if kind not in (td.State, td.controllers.ControllerState):
            for again in (pickle.loads(pickle.dumps(thing)), copy.deepcopy(thing)):
                assert is_same(again, thing) and again == thing, type(thing).__name__
            text = repr(thing)
            assert len(text) < 2500 and "array(" not in text and " object at 0x" not in text
    assert {c.__name__ for c in public - classes.keys()} - DEAR == set()


def test_a_function_of_a_script_that_names_the_package_or_a_folder_can_be_sent():
    """As a measure of a study does, once it is run in other processes."""
    cloudpickle = pytest.importorskip("cloudpickle")
    from teleopdesign import passivity

    for module in (td, passivity, td.simulate):
        assert pickle.loads(pickle.dumps(module)) is module
    place = {"td": td, "passivity": passivity}
    exec("def measure(x):\n    return td.Value(x), passivity.Dahl(x, 1.0).level", place)
    sent = pickle.loads(cloudpickle.dumps(place["measure"]))
    assert sent(2.0) == (td.Value(2.0), 2.0)
