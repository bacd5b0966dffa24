"""Random wirings: any blocks and junctions on any signals, sensible or not."""

import math

import sympy as sp
from hypothesis import assume
from hypothesis import strategies as st

from teleopdesign.blocks import BLOCK_EFFECTS, Body, Value, matrix_impedance
from teleopdesign.controllers import controller, scheduled_force_feedback
from teleopdesign.diagrams import (
    ANY,
    Attached,
    Control,
    Diagram,
    Junction,
    Kinematics,
    Linked,
    Moving,
    position_symbol,
)
from teleopdesign.effects import EFFECTS

WEIGHTS = st.sampled_from((1, -1, 1, -1, 0.5, -2.25))
POSITIVE = st.floats(1e-6, 1e6)


@st.composite
def bodies(draw, axis):
    """A body known by its name, or with effects and values, some of them known."""
    if draw(st.booleans()):
        return ANY
    effects = EFFECTS | BLOCK_EFFECTS
    names = draw(st.lists(st.sampled_from(("coulomb", "viscous", "spring", "arm")), unique=True))
    names += draw(st.sampled_from(((), (), ("environment",), ("environment", "impact_damping"))))
    values = {"inertia": Value(draw(POSITIVE), draw(st.booleans()))}
    for name in names:
        for parameter in effects[name].parameters:
            values[f"{name}.{parameter}"] = Value(draw(POSITIVE), draw(st.booleans()))
    return Body(axis, values, tuple(effects[n] for n in names))


@st.composite
def matrices(draw, size):
    entries = st.sampled_from((0.0, 0.0, 1.5, -0.25, 1e3))
    rows = st.lists(st.lists(entries, min_size=size, max_size=size), min_size=size, max_size=size)
    return matrix_impedance(mass=draw(rows), damping=draw(rows), stiffness=draw(rows))


@st.composite
def expressions(draw, signals):
    """What geometry may be: sums, products, powers and functions of positions and numbers."""
    positions = signals.map(position_symbol)
    numbers = st.floats(-10, 10).map(sp.Float) | st.integers(-5, 5).map(sp.Integer)
    numbers |= st.sampled_from((sp.pi, sp.Rational(1, 3)))
    ones = st.sampled_from((sp.sin, sp.cos, sp.tan, sp.asin, sp.atan, sp.sqrt, sp.exp))

    def larger(inside):
        two = st.sampled_from((sp.Add, sp.Mul, lambda a, b: a / b, sp.atan2))
        pairs = st.builds(lambda f, a, b: f(a, b), two, inside, inside)
        powers = st.builds(sp.Pow, inside, st.integers(-3, 3))
        return pairs | powers | st.builds(lambda f, a: f(a), ones, inside)

    try:
        expression = draw(st.recursive(positions | numbers, larger, max_leaves=6))
    except (ZeroDivisionError, TypeError):  # sympy on what has no value
        assume(False)
    allowed = (sp.Add, sp.Mul, sp.Pow, sp.sin, sp.cos, sp.tan, sp.asin, sp.acos, sp.atan, sp.exp)
    allowed += (sp.atan2, sp.Abs, sp.sign, sp.cot, sp.sec, sp.csc, sp.Symbol, sp.Number)
    allowed += (type(sp.pi), type(sp.E))
    nodes = list(sp.preorder_traversal(expression))
    assume(all(isinstance(n, allowed) and not n.has(sp.zoo, sp.nan, sp.oo, sp.I) for n in nodes))
    assume(not any(n.is_number and n.is_real is False for n in nodes))
    assume(all(sp.Float(float(n)) == n for n in nodes if n.is_Float))  # 1e-442 is none of Python
    assume(all(math.isfinite(n) for n in nodes if n.is_number))  # 9e307 pi is none either
    return expression


@st.composite
def controllers(draw):
    kind = draw(st.integers(0, 2))
    if kind == 0:
        return ANY
    if kind == 1:
        values = {"level": draw(POSITIVE), "smoothing_velocity": draw(POSITIVE)}
        return controller("smoothed_coulomb", values)
    return scheduled_force_feedback(
        gain=draw(POSITIVE),
        scheduling_velocity=draw(POSITIVE),
        bandwidth=draw(POSITIVE),
        schedule=draw(st.sampled_from(("before", "after"))),
    )


@st.composite
def diagrams(draw, *, geometry=False):
    """Blocks and junctions; geometry: also kinematics, matrices and weights of positions."""
    most = _MOST | (_GEOMETRY if geometry else {"k": (0, 0)})
    counts = {k: draw(st.integers(low, high)) for k, (low, high) in most.items()}
    made = {k: [f"{k}{i}" for i in range(n)] for k, n in counts.items()}
    joined = [
        f"g{i}{n}" for i, size in enumerate(draw(_SIZES) if geometry else ()) for n in range(size)
    ]
    signals = st.sampled_from([*(s for names in made.values() for s in names), *joined])
    terms = st.dictionaries(signals, WEIGHTS, max_size=5)
    weights = WEIGHTS | WEIGHTS | expressions(signals) if geometry else WEIGHTS
    weighted = st.dictionaries(signals, weights, max_size=5)
    outside = {s: draw(st.sampled_from(("force", "position"))) for s in made["o"]}
    axis = draw(st.sampled_from(("prismatic", "revolute")))  # of all: others are refused
    blocks = [
        Moving(f"M{x}", draw(bodies(axis)), x, draw(signals), draw(terms), draw(signals))
        for x in made["x"]
    ]
    blocks += [
        Attached(f"Z{f}", draw(bodies(axis)), draw(signals), f, draw(st.sampled_from((1, -1))))
        for f in made["f"]
    ]
    blocks += [
        Control(f"C{u}", draw(controllers()), draw(signals), u, draw(signals), draw(st.booleans()))
        for u in made["u"]
    ]
    for i in sorted({g[1] for g in joined}):
        forces = tuple(g for g in joined if g[1] == i)
        size = len(forces)
        motions = tuple(draw(st.lists(signals, min_size=size, max_size=size)))
        sign = draw(st.sampled_from((1, -1)))
        blocks.append(Linked(f"Z{i}", draw(matrices(size)), motions, forces, sign))
    junctions = tuple(Junction(j, draw(weighted)) for j in made["j"])
    kinematics = tuple(Kinematics(k, draw(expressions(signals)), axis) for k in made["k"])
    pose = draw(st.dictionaries(signals, st.floats(-5, 5), max_size=2)) if geometry else {}
    measured = tuple(draw(st.lists(signals, unique=True, max_size=3)))
    texts = draw(st.dictionaries(signals, st.text(max_size=20), max_size=3))
    return Diagram("random", tuple(blocks), junctions, outside, measured, texts, kinematics, pose)


#: how many of each: from outside, motions, forces, control outputs, junctions
_MOST = {"o": (1, 3), "x": (0, 3), "f": (0, 2), "u": (0, 3), "j": (0, 5)}
_GEOMETRY = {"k": (0, 2)}  # kinematics
#: of impedances between several motions
_SIZES = st.lists(st.integers(1, 3), max_size=2)
