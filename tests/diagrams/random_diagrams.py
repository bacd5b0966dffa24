"""Random wirings: any blocks and junctions on any signals, sensible or not."""

from hypothesis import strategies as st

from teleopdesign.blocks import Body, Value
from teleopdesign.controllers import controller, scheduled_force_feedback
from teleopdesign.diagrams import ANY, Attached, Control, Diagram, Junction, Moving
from teleopdesign.effects import EFFECTS

WEIGHTS = st.sampled_from((1, -1, 1, -1, 0.5, -2.25))
POSITIVE = st.floats(1e-6, 1e6)


@st.composite
def bodies(draw):
    """A body known by its name, or with effects and values, some of them known."""
    if draw(st.booleans()):
        return ANY
    names = draw(st.lists(st.sampled_from(("coulomb", "viscous", "spring")), unique=True))
    values = {"inertia": Value(draw(POSITIVE), draw(st.booleans()))}
    for name in names:
        for parameter in EFFECTS[name].parameters:
            values[f"{name}.{parameter}"] = Value(draw(POSITIVE), draw(st.booleans()))
    axis = draw(st.sampled_from(("prismatic", "revolute")))
    return Body(axis, values, tuple(EFFECTS[n] for n in names))


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
def diagrams(draw):
    counts = {k: draw(st.integers(low, high)) for k, (low, high) in _MOST.items()}
    made = {k: [f"{k}{i}" for i in range(n)] for k, n in counts.items()}
    signals = st.sampled_from([s for names in made.values() for s in names])
    terms = st.dictionaries(signals, WEIGHTS, max_size=5)
    outside = {s: draw(st.sampled_from(("force", "position"))) for s in made["o"]}
    blocks = [
        Moving(f"M{x}", draw(bodies()), x, draw(signals), draw(terms), draw(signals))
        for x in made["x"]
    ]
    blocks += [
        Attached(f"Z{f}", draw(bodies()), draw(signals), f, draw(st.sampled_from((1, -1))))
        for f in made["f"]
    ]
    blocks += [
        Control(f"C{u}", draw(controllers()), draw(signals), u, draw(signals), draw(st.booleans()))
        for u in made["u"]
    ]
    junctions = tuple(Junction(j, draw(terms)) for j in made["j"])
    measured = tuple(draw(st.lists(signals, unique=True, max_size=3)))
    texts = draw(st.dictionaries(signals, st.text(max_size=20), max_size=3))
    return Diagram("random", tuple(blocks), junctions, outside, measured, texts)


#: how many of each: from outside, motions, forces, control outputs, junctions
_MOST = {"o": (1, 3), "x": (0, 3), "f": (0, 2), "u": (0, 3), "j": (0, 5)}
