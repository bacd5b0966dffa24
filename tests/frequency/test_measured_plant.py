"""A plant that was measured: its responses, and the margin of a loop around it."""

import control
import numpy as np
import pytest
from devices import body

from teleopdesign.base.errors import UnstableLoop
from teleopdesign.controllers import from_control
from teleopdesign.diagrams import Control, Diagram, Junction, Moving, plant_parts
from teleopdesign.frequency import delay_margin, loop_gain, matrix_response
from teleopdesign.passivity import diagram_claims

W = np.geomspace(0.3, 3000.0, 400)
FREE = control.tf([1.0], [0.15, 2.0, 0.0])
RESONANT = control.tf([1.0, 8.0, 9e3], np.polymul([0.3, 4.0, 30.0], [1.0, 12.0, 2.5e4]))
MASS_ALONE = control.tf([1.0], [0.2, 0.0, 0.0])
LEAD = control.tf([-3.0, -60.0], [1e-3, 1.0])
INTEGRAL = control.tf([-2.0, -90.0, -40.0], [1e-3, 1.0, 0.0])


def closed(plant, law, **options):
    parts, sums = plant_parts(plant, name="P", motion="x", command="u", driver="f")
    block = Control("K", from_control(law), "x", "u", "x", True)
    return Diagram("measured", (*parts, block), sums, {"f": "force"}, ("x",), **options)


@pytest.mark.parametrize("plant", [FREE, RESONANT, MASS_ALONE])
@pytest.mark.parametrize("law", [LEAD, INTEGRAL])
def test_responses_and_margins_are_those_of_the_system_that_was_measured(plant, law):
    """Exact at the measured frequencies; the margin to 1 %: lines between 100 a decade."""
    known, response = closed(plant, law), closed(control.frd(plant, W), law)
    f = W[::7] / (2 * np.pi)
    matrices = [matrix_response(d, ["x"], ["f"], f).data.values.ravel() for d in (response, known)]
    np.testing.assert_allclose(*matrices, rtol=1e-9)
    loops = [loop_gain(d, controller="K") for d in (response, known)]
    np.testing.assert_allclose(loops[0](1j * W), loops[1](1j * W), rtol=1e-9)
    try:
        expected = delay_margin(loops[1])
    except UnstableLoop:
        with pytest.raises(UnstableLoop):
            delay_margin(loops[0])
    else:
        assert delay_margin(loops[0]) == pytest.approx(expected, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_a_measured_loop_is_stable_where_its_poles_say_so(seed):
    """60 random loops: stiff, loose, of the wrong sign, with a law that grows by itself."""
    rng, counts = np.random.default_rng(seed), {True: 0, False: 0}
    for _ in range(15):
        m, b, k = 0.2, 10 ** rng.uniform(-1, 1), rng.choice([0.0, 10 ** rng.uniform(0, 3)])
        sign = rng.choice([-1, -1, -1, 1])
        lag = 10 ** rng.uniform(-4, -1)
        gains = sign * 10 ** rng.uniform(-1, 1), sign * 10 ** rng.uniform(0, 3)
        law = control.tf(list(gains), np.polymul([lag, 1.0], [1e-3, 1.0]))
        plant = control.tf([1.0], [m, b, k])
        poles = np.roots(control.feedback(plant, -law).den[0][0])
        if sign > 0 and k < gains[1]:
            continue  # the static gain is below -1: what was not measured decides
        measured = np.geomspace(0.05, 3e4, 700)
        loop = loop_gain(closed(control.frd(plant, measured), law), controller="K")
        stable = bool((poles.real < 0).all())
        counts[stable] += 1
        if stable:
            assert delay_margin(loop) > 0
        else:
            with pytest.raises(UnstableLoop):
                delay_margin(loop)
    assert min(counts.values()) > 0


def test_nothing_is_proved_of_it_and_the_claim_says_why():
    claims = diagram_claims(closed(control.frd(FREE, W), LEAD), rng=np.random.default_rng(1))
    assert [one.claim.status for one in claims.claims] == ["unknown"]
    text = str(claims.claims[0].claim.verdict)
    assert "P_rest is a measured frequency response" in text and "right half plane" in text


HIDES = {g: control.ss(np.diag([-9.0, g]), [[1.0], [0.0]], [[1.0, 0.0]], [[2.0]]) for g in (-3, 3)}


@pytest.mark.parametrize("grows", [-3, 3])
@pytest.mark.parametrize("beside", ["what was measured", "two that sample"])
def test_a_loop_with_no_exact_form_has_no_margin_beside_a_hidden_mode_that_grows(grows, beside):
    """A law shows 2 + 1/(s + 9) and hides exp(3 t), in its own loop and beside other loops."""
    held = body(1.0, viscous__damping=1.0, spring__stiffness=50.0)
    blocks = [Moving("M", held, "x", "u", {"f": 1.0}, "f")]
    if beside == "what was measured":
        other = from_control(control.frd(control.tf([1.0], [1.0, 9.0]), W))
        blocks.append(Control("R", other, "x", "r"))
    else:
        other = from_control(control.tf([1.0], [1.0, -0.5], 0.01))
        blocks += [Control("R", other, "x", "r"), Control("Q", other, "x", "q")]
    blocks.append(Control("C", from_control(HIDES[grows]), "x", "c", analog=True))
    back = {b.output: -1.0 for b in blocks[1:]}
    diagram = Diagram("hidden", tuple(blocks), (Junction("u", back),), {"f": "force"}, ("x",))
    for name in ("R", "C"):
        loop = loop_gain(diagram, controller=name)
        if grows < 0:
            assert delay_margin(loop) > 0
            continue
        with pytest.raises(UnstableLoop, match="does not see grows"):
            delay_margin(loop)
