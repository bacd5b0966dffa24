"""Changes that must not matter to a simulation or a claim: names, order, units of every kind."""

from dataclasses import replace

import numpy as np
import pytest
from devices import body

from teleopdesign.blocks import hand
from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface, read_diagram, write_diagram
from teleopdesign.passivity import Search, diagram_claims
from teleopdesign.simulate import Sampling, simulate

#: the same sums in another order, over 2000 steps
ROUNDING = 1e-9
#: powers of two: nothing is rounded anew. m, N and s, each as so many of another unit
LENGTH, FORCE, TIME = 2.0**10, 2.0**-3, 2.0**5


def interface(*, length=1.0, force=1.0, time=1.0):
    """A held device with friction and its cancellation, in units of that many per m, N and s."""
    inertia, damping = force * time**2 / length, force * time / length
    stiffness, speed = force / length, length / time
    device = body(
        0.15 * inertia,
        coulomb__level=0.5 * force,
        stribeck__extra_static_level=0.1 * force,
        stribeck__stribeck_velocity=0.01 * speed,
        presliding__stiffness=2e4 * stiffness,
        viscous__damping=0.4 * damping,
    )
    held = hand(mass=0.1 * inertia, damping=2.0 * damping, stiffness=100.0 * stiffness)
    dahl = controller("dahl", {"level": 0.4 * force, "stiffness": 1e4 * stiffness})
    low_pass = controller("low_pass", {"bandwidth": 20.0 / time})
    return haptic_interface(device, hand=held, cancellation=dahl, force_feedback=low_pass)


def run(diagram, names=("R_D",), *, force=1.0, time=1.0, length=1.0):
    def push(t):
        return 2.0 * force * np.sin(30.0 / time * t)

    return simulate(
        diagram,
        duration=0.2 * time,
        inputs={names[0]: push},
        computer=Sampling(period=1e-3 * time, encoder_step=2.0**-17 * length),
        step=1e-4 * time,
        give=1e-5 * length,
    )


@pytest.fixture(scope="module")
def before():
    return run(interface())


def free_text(tmp_path):
    """The diagram's file with all of its wiring written out."""
    path = tmp_path / "before.toml"
    write_diagram(replace(interface(), name="bench"), path)
    return path.read_text()


def read_back(text, tmp_path):
    path = tmp_path / "after.toml"
    path.write_text(text)
    return read_diagram(path)


NEW_NAMES = {"Z_M": "alpha", "Z_H": "zeta", "R_M": "a_1", "R_A": "push", "L": "x", "R_D": "wish"}


def renamed(text):
    """Other names, in another alphabetical order."""
    import re

    for old, new in NEW_NAMES.items():
        text = re.sub(rf"\b{old}\b", new, text)
    return text


def other_order(text):
    """Blocks, and the lines of the junctions, in reverse."""
    head, *tables = text.split("\n[")
    blocks, rest, current = [], [], None
    for table in tables:
        if table.startswith("blocks."):
            name = table.split(".")[1].split("]")[0]
            if name != current:
                blocks.append([])
            current = name
            blocks[-1].append(table)
        elif table.startswith("junctions]"):
            first, *lines = table.strip("\n").split("\n")
            rest.append("\n".join([first, *reversed(lines), ""]))
        else:
            rest.append(table)
    # a series stands in the order in which its laws act: it is kept
    ordered = [t for block in reversed(blocks) for t in block]
    return "\n[".join([head, *rest, *ordered])


def test_the_order_of_blocks_and_junctions_changes_rounding_alone(before, tmp_path):
    text = free_text(tmp_path)
    assert other_order(text) != text
    after = run(read_back(other_order(text), tmp_path))
    for name in before.data:
        size = np.abs(before[str(name)].values).max()
        difference = np.abs(after[str(name)].values - before[str(name)].values).max()
        assert difference <= ROUNDING * size, name


@pytest.mark.parametrize(
    "units",
    [
        {"length": LENGTH},
        {"force": FORCE},
        {"time": TIME},
        {"length": LENGTH, "force": FORCE, "time": TIME},
    ],
    ids=["length", "force", "time", "all"],
)
def test_units_of_length_force_and_time_change_nothing_to_the_last_bit(before, units):
    """Positions, forces and times in other units by powers of two: the same binary digits."""
    after = run(interface(**units), **units)
    length, force = units.get("length", 1.0), units.get("force", 1.0)
    time = units.get("time", 1.0)
    for name, scale in {
        "L": length,
        "L_velocity": length / time,
        "R_M": force,
        "R_MBC": force,
    }.items():
        assert np.array_equal(after[name].values, scale * before[name].values), name


def statuses(diagram):
    made = diagram_claims(diagram, rng=np.random.default_rng(1), search=Search(tries=2))
    return sorted((c.topic.split()[0], c.claim.status) for c in made.claims)


def device_alone(**units):
    """Friction with its cancellation, which theorems settle."""
    made = interface(**units)
    return made.without("H")


def linear(*, length=1.0, force=1.0, time=1.0):
    """What is decided exactly: force feedback through a low-pass, proved at this damping."""
    device = body(0.15 * force * time**2 / length, viscous__damping=19.0 * force * time / length)
    low_pass = controller("low_pass", {"bandwidth": 20.0 / time})
    return haptic_interface(device, force_feedback=low_pass, analog=("H",))


@pytest.mark.slow
@pytest.mark.parametrize("made", [linear, device_alone])
def test_claims_have_the_same_status_in_other_units_and_under_other_names(made, tmp_path):
    expected = statuses(made())
    assert expected
    assert statuses(made(length=LENGTH, force=FORCE, time=TIME)) == expected
    path = tmp_path / "before.toml"
    write_diagram(replace(made(), name="bench"), path)
    for change in (renamed, other_order):
        other = read_back(change(path.read_text()), tmp_path)
        assert statuses(other) == expected, change.__name__
