"""Names are the user's: numbers do not depend on them, and no word is taken."""

from dataclasses import replace

import numpy as np
import pytest
from devices import CANCELLATION, FEEDBACK, LOOP, LUGRE, body
from diagrams.several_axes import two_rods
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.base.errors import ModelError, check_name
from teleopdesign.controllers import controller
from teleopdesign.diagrams import (
    Attached,
    Control,
    Diagram,
    Junction,
    Kinematics,
    Linked,
    Moving,
    haptic_interface,
    position_symbol,
)
from teleopdesign.simulate import simulate

#: words that generated code, Python, sympy or the package might want for itself
WORDS = (
    "a b c d e f g h i j k m n o p q r s t u v w x y z A B C D E I N O Q S e1 f0 k0 p0 s0 u0 x0 y0 "
    "row exp sin cos sqrt floor pi inf nan lambda_ range abs max min np math numba sympy njit phi "
    "weights rates slopes signals computer late_values before_rates after_steps run jitted self "
    "inputs sampled start held history out samples inner period lag parameters step worst now made "
    "values drive direction velocity position acceleration command level acting_force "
    "no_command joined_0 dt print exec eval __import__ __name__ __builtins__ _ s000_ b000_ d000_ "
    "s001__velocity x_velocity q_1 Gamma Max Min Piecewise control state_space mechanics"
).split()
_LETTERS = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_"
NAMES = st.sampled_from(WORDS) | st.text(_LETTERS + "0123456789", min_size=1, max_size=12)


def is_name(text):
    try:
        return check_name(text, where="") == text
    except ModelError:
        return False


def hybrid():
    return haptic_interface(
        body(**LUGRE),
        hand=body(0.5),
        cancellation=CANCELLATION,
        force_feedback=FEEDBACK,
        position_loop=LOOP,
    )


def behind_a_compliance():
    gap = {"tip_inertia": 0.05, "stiffness": 3e3, "damping": 1.5}
    device = body(0.15, **{f"transmission_compliance__{n}": v for n, v in gap.items()})
    spring = controller("spring_damper", {"stiffness": -50.0, "damping": -1.0})
    return haptic_interface(device, hand=body(0.2), cancellation=spring)


def renamed(diagram, names):
    """The diagram with other names for its signals and blocks."""
    symbols = {position_symbol(s): position_symbol(names[s]) for s in diagram.signals}

    def placed(weight):
        return weight.xreplace(symbols) if hasattr(weight, "xreplace") else weight

    def of(many):
        return tuple(names[s] for s in many)

    blocks = []
    for b in diagram.blocks:
        name = names[b.name]
        if isinstance(b, Moving):
            loads = {names[s]: g for s, g in b.loads.items()}
            wires = {"motion": names[b.motion], "command": names[b.command]}
            blocks.append(replace(b, name=name, loads=loads, driver=names[b.driver], **wires))
        elif isinstance(b, Attached):
            blocks.append(replace(b, name=name, motion=names[b.motion], force=names[b.force]))
        elif isinstance(b, Linked):
            blocks.append(replace(b, name=name, motions=of(b.motions), forces=of(b.forces)))
        else:
            assert isinstance(b, Control)
            wires = dict(
                zip(("input", "output", "motion"), of((b.input, b.output, b.motion)), strict=True)
            )
            blocks.append(replace(b, name=name, **wires))
    return Diagram(
        diagram.name,
        tuple(blocks),
        tuple(
            Junction(names[j.output], {names[s]: placed(w) for s, w in j.terms.items()})
            for j in diagram.junctions
        ),
        {names[s]: q for s, q in diagram.outside.items()},
        of(diagram.measured),
        {},
        tuple(Kinematics(names[k.output], placed(k.expression)) for k in diagram.kinematics),
        {names[s]: x for s, x in diagram.pose.items()},
    )


def push(t):
    return 2.0 * np.sin(30 * t)


DIAGRAMS = {"hybrid": hybrid(), "compliance": behind_a_compliance(), "rods": two_rods()}


def run(diagram, **more):
    first = next(iter(diagram.outside))
    made = {"duration": 0.02, "inputs": {first: push}, "jit": False} | more
    return simulate(diagram, **made).data


@pytest.fixture(scope="module")
def before():
    return {
        (name, mode): run(diagram, **({"computer": "continuous"} if mode else {}))
        for name, diagram in DIAGRAMS.items()
        for mode in (False, True)
    }


def other_names(draw, diagram):
    """A new name for each signal and block, none of which the package makes itself."""
    old = list(dict.fromkeys([*diagram.signals, *(b.name for b in diagram.blocks)]))
    usable = NAMES.filter(is_name).filter(lambda n: n != "time")
    new = draw(st.lists(usable, min_size=len(old), max_size=len(old), unique=True))
    return dict(zip(old, new, strict=True))


@pytest.mark.slow
@pytest.mark.parametrize("name", DIAGRAMS)
@pytest.mark.parametrize("continuous", [False, True], ids=["sampled", "continuous"])
@settings(max_examples=12)
@given(data=st.data())
def test_a_diagram_with_other_names_gives_the_same_numbers_to_the_last_bit(
    before, name, continuous, data
):
    diagram = DIAGRAMS[name]
    names = other_names(data.draw, diagram)
    try:
        simulation = run(
            renamed(diagram, names), **({"computer": "continuous"} if continuous else {})
        )
    except ModelError as error:  # "x" and "x_velocity": two signals of one name
        assert "call the signal otherwise" in str(error) or "is made by" in str(error)
        return
    for old, new in zip(
        before[name, continuous].data_vars.values(), simulation.values(), strict=True
    ):
        np.testing.assert_array_equal(old, new)


def test_no_word_is_taken(before):
    """Each is the name of the motion, which stands in every equation, or of another signal."""
    diagram, known = DIAGRAMS["hybrid"], before["hybrid", False]
    old = ["L", *(n for n in diagram.signals if n != "L"), *(b.name for b in diagram.blocks)]
    for k in range(0, len(WORDS), 12):
        names = {n: f"more_{i}" for i, n in enumerate(old)} | dict(
            zip(old, WORDS[k:], strict=False)
        )
        simulation = run(renamed(diagram, names))
        for quantity in ("", "_velocity"):
            np.testing.assert_array_equal(simulation[names["L"] + quantity], known["L" + quantity])


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("L_velocity", '"L_velocity" is the name of the signal and of the velocity of L: call'),
        ("L_acceleration", "of the signal and of the acceleration of L: call the signal other"),
        ("Z_M_friction", '"Z_M_friction" is the name of the signal and of the friction of Z_M'),
        ("Z_M_presliding_bristle", "the signal and of the presliding bristle of Z_M"),
        ("time", '"time" is the name of the signal and of the time: call the signal otherwise'),
    ],
)
def test_a_name_that_the_package_makes_itself_is_refused_in_one_line(name, words):
    diagram = DIAGRAMS["hybrid"]
    names = {n: n for n in (*diagram.signals, *(b.name for b in diagram.blocks))} | {"E": name}
    with pytest.raises(ModelError) as caught:
        run(renamed(diagram, names))
    assert words in str(caught.value)
