"""A wrong type is refused where it is given, in one line, by an error of the package's own.

Every public function and constructor is called with every kind of wrong value for each of its
parameters, the others as they should be. What a function does take (a list of numbers for an array)
it may take; what it does not take must never end in an AttributeError from inside.
"""

import inspect
from importlib import import_module

import example_objects as objects
import numpy as np
import pytest
import sympy as sp

import teleopdesign as td
from teleopdesign import passivity
from teleopdesign.base import arguments
from teleopdesign.base.errors import TeleopDesignError


class Stranger:
    """A class that the package has never seen."""


WRONG = {
    "nothing": None,
    "a truth value": True,
    "a text": "text",
    "not a number": float("nan"),
    "a number": 3.5,
    "a whole number": -2,
    "an object": object(),
    "a class": Stranger,
    "an empty list": [],
    "an empty mapping": {},
    "a list of texts": ["x"],
    "a mapping of texts": {"x": "y"},
    "a tuple of numbers": (1, 2, 3),
    "an array": np.zeros(3),
    "bytes": b"x",
    "a function": len,
}
FOLDERS = (
    "effects blocks controllers diagrams simulate frequency derive passivity design identify "
    "diagnose next_experiment measurement show show.report"
).split()
#: these write files, reach for the network, or are told where they look for it
LEFT_OUT = {"fetch", "save_figure", "write_record", "write_diagram", "write_reference"}
CONSTRUCTORS = [
    td.Body, td.Value, td.Parameter, td.Effect, td.State, td.Model, td.Diagram, td.Controller,
    td.Sampling, td.Assumptions, td.Certificate, td.diagrams.Moving, td.diagrams.Attached,
    td.diagrams.Linked, td.diagrams.Control, td.diagrams.Junction, td.diagrams.Kinematics,
    td.diagrams.Arm, td.controllers.Stage, td.controllers.ControlLaw,
    td.controllers.ControllerState,
    td.blocks.MatrixImpedance, td.simulate.Trajectory, passivity.Strokes, passivity.Dahl,
    passivity.Coulomb, passivity.Spring, passivity.DahlBehindSpring, passivity.Search,
]  # fmt: skip
METHODS = [
    (make, name)
    for make, names in (
        (
            lambda: td.Model.from_experiment(objects.experiment()),
            "with_effect without_effect with_values body unit declared",
        ),
        (lambda: objects.BODY, "with_effect without_effect with_values effect unit"),
        (lambda: objects.LAW, "then with_values"),
        (objects.diagram, "with_block with_values block signal position"),
    )
    for name in names.split()
]


def functions():
    """Every public function, its folder in front."""
    for name in (n for names in (*td.GROUPS.values(), *td.FURTHER.values()) for n in names):
        thing = getattr(td, name)
        if inspect.isfunction(thing) and name not in LEFT_OUT:
            yield pytest.param(thing, id=name)
    for folder in FOLDERS:
        module = import_module(f"teleopdesign.{folder}")
        for name in module.__all__:
            thing = getattr(module, name)
            if inspect.isfunction(thing) and name not in LEFT_OUT:
                yield pytest.param(thing, id=f"{folder}.{name}")


#: a right value for what an annotation names, first match wins
RIGHT = (
    ("Mapping[str, Simulation]", lambda: {"one": objects.simulation()}),
    ("Mapping[str, Trajectory]", lambda: {"L": td.sine(amplitude=0.01, frequency=1.0)}),
    ("Mapping[str, float]", dict),
    ("Sequence[Body]", lambda: (objects.BODY, objects.BODY)),
    ("np.random.Generator", lambda: np.random.default_rng(0)),
    ("Diagnosis", lambda: pytest.skip("a diagnosis takes long, and is checked by its class")),
    ("Simulation", objects.simulation),
    ("Experiment", objects.experiment),
    ("Record", lambda: objects.experiment().records[0]),
    ("Model", lambda: td.Model.from_experiment(objects.experiment())),
    ("Diagram", objects.diagram),
    ("Body", lambda: objects.BODY),
    ("Controller", lambda: objects.LAW),
    ("MatrixImpedance", lambda: td.blocks.matrix_impedance(mass=np.eye(2))),
    ("Strokes", lambda: passivity.Strokes((0.01, -0.01), 0.1)),
    ("Certificate", lambda: objects.QUICK["certificate"]()),
    ("Effect", lambda: td.EFFECTS["spring"]),
    ("sp.Expr", lambda: sp.Symbol("x")),
    ("ndarray", lambda: np.linspace(0.1, 1.0, 20)),
    ("Array", lambda: np.linspace(0.1, 1.0, 20)),
    ("Path", lambda: "no such file"),
    ("tuple[str", lambda: ("L", "R_V")),
    ("Sequence[str]", lambda: ("L",)),
    ("bool", lambda: False),
    ("str", lambda: "L"),
    ("int", lambda: 1),
    ("float", lambda: 1.0),
)


def right(parameter, wrong):
    """A right value for that parameter; the wrong one where nothing says what is right."""
    text = str(parameter.annotation)
    for words, make in RIGHT:
        if words in text:
            return make()
    return wrong


def refused_or_taken(call, arguments):
    """Call it; any error that is not one of the package's own fails the test."""
    try:
        call(**arguments)
    except TeleopDesignError as error:
        message = str(error)
        assert message and len(message.splitlines()) == 1
        assert " object at 0x" not in message and "<class" not in message, message


def checked_parameters(call):
    return [
        p
        for p in inspect.signature(call).parameters.values()
        if p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)
    ]


def try_all(call):
    """The call with each wrong value for each parameter that is not free to be anything."""
    parameters = checked_parameters(call)
    for one in parameters:
        for wrong in WRONG.values():
            values = {p.name: right(p, wrong) for p in parameters if p.default is p.empty}
            refused = refusal(call, one, wrong)
            if refused or str(one.annotation) in ("Any", "typing.Any"):
                refused_or_taken(call, {**values, one.name: wrong})


def refusal(call, parameter, wrong):
    """Whether the annotation refuses that value: what it takes may start a long computation."""
    function = inspect.unwrap(call if inspect.isfunction(call) else getattr(call, "__init__", call))
    names = vars(inspect.getmodule(function) or inspect.getmodule(call))
    annotation = arguments._resolve(parameter.annotation, {**names, "__name__": names["__name__"]})
    check = arguments.check_of(annotation)
    return check is not None and check(wrong) is not None


@pytest.mark.slow
@pytest.mark.parametrize("function", [*functions()])
def test_a_public_function_refuses_what_it_cannot_take(function):
    try_all(function)


@pytest.mark.parametrize("constructor", CONSTRUCTORS, ids=lambda c: c.__name__)
def test_a_constructor_refuses_what_it_cannot_take(constructor):
    refuse_each(constructor)


@pytest.mark.parametrize(("make", "name"), METHODS, ids=lambda x: x if isinstance(x, str) else "")
def test_a_method_refuses_what_it_cannot_take(make, name):
    refuse_each(getattr(make(), name))


def refuse_each(call):
    parameters = checked_parameters(call)
    for one in parameters:
        for wrong in WRONG.values():
            values = {p.name: right(p, wrong) for p in parameters if p.default is p.empty}
            refused_or_taken(call, {**values, one.name: wrong})


def test_every_public_function_is_checked():
    for case in functions():
        (function,) = case.values
        assert hasattr(function, "_is_checked"), case.id
        parameters = inspect.signature(function).parameters.values()
        assert all(p.annotation is not p.empty for p in parameters), case.id


def test_a_wrong_call_stays_a_type_error():
    with pytest.raises(TypeError, match="unexpected keyword"):
        td.sine(amplitude=1.0, frequency=1.0, phas=0.0)
    with pytest.raises(TypeError, match="missing"):
        td.haptic_interface.__wrapped__ and td.sine()
