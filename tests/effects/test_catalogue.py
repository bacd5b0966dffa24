"""Every effect of the catalogue keeps what it declares: text, units, bounds, claims, absence."""

import re
import subprocess
import sys
from dataclasses import fields, replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from effects.along import (
    INERTIA,
    KNOWN,
    NAMES,
    body_of,
    declaring,
    encoded,
    motion_along,
    signals,
    typical,
    unled,
    with_needs,
)
from hypothesis import given, settings
from hypothesis import strategies as st

import teleopdesign.effects as folder
from teleopdesign.effects import (
    BLOCK_EFFECTS,
    EFFECTS,
    ONLY_IN,
    SIGNALS,
    FitSearch,
    catalogue,
    find_effect,
    load_effect,
    with_block_effects,
)
from teleopdesign.effects._effect import ROLES
from teleopdesign.errors import ModelError
from teleopdesign.quantity import AXES, QUANTITIES, unit_of
from teleopdesign.realise.along_motion import residual_along

FILES = sorted(p for p in Path(folder.__file__).parent.glob("*.py") if p.name[0] != "_")
CLAIMS = ("even in velocity", "non-negative")  # those that a test below checks
S = sp.Symbol("s")


# text and names


def test_every_file_of_the_folder_is_one_effect_under_its_own_name():
    known = EFFECTS | BLOCK_EFFECTS
    assert [p.stem for p in FILES] == sorted(known)
    assert all(known[name].name == name for name in known)


def test_what_belongs_to_a_block_says_so_and_is_apart_from_the_candidates():
    assert not set(EFFECTS) & set(BLOCK_EFFECTS)
    assert {e.block for e in BLOCK_EFFECTS.values()} == {"hand", "environment"}
    assert {e.block for e in EFFECTS.values()} == {""}
    assert set(with_block_effects()) == {*EFFECTS, *BLOCK_EFFECTS}


@pytest.mark.parametrize("signal", sorted(ONLY_IN))
def test_a_law_may_not_use_a_signal_that_its_role_does_not_know(signal, tmp_path):
    path = tmp_path / "odd_force.py"
    path.write_text(
        "from teleopdesign import Effect, Parameter\n"
        f"EFFECT = Effect(role='force', law=lambda now, p: p.part * now.{signal},\n"
        "    parameters={'part': Parameter('dimensionless', 'part')}, absent={'part': 0.0})\n"
    )
    with pytest.raises(ModelError, match=f"now.{signal}, which only the role"):
        load_effect(path)


def test_a_law_may_use_parameters_of_effects_that_it_needs_and_of_no_others(tmp_path):
    text = (Path(folder.__file__).parent / "impact_damping.py").read_text()
    file = tmp_path / "own_damping.py"
    file.write_text(text.replace("from ._effect", "from teleopdesign.effects._effect"))
    assert "environment_stiffness" in str(load_effect(file).expression())
    file.write_text(
        file.read_text().replace('needs=frozenset({"environment"})', "needs=frozenset()")
    )
    with pytest.raises(ModelError, match="law uses environment_stiffness"):
        load_effect(file)


@pytest.mark.parametrize("file", FILES, ids=lambda p: p.stem)
def test_an_effect_file_reads_on_one_page(file):
    assert len(file.read_text().splitlines()) < 60


@pytest.mark.parametrize("name", NAMES)
def test_the_text_opens_with_a_title_and_shows_the_equation(name):
    effect = EFFECTS[name]
    assert re.fullmatch(r"[A-Z].{10,95}\.", effect.title)
    assert effect.text.split("\n")[1].strip() == ""
    indented = [line for line in effect.text.split("\n") if line.startswith("    ")]
    assert any("=" in line for line in indented), "an indented equation"
    assert len(effect.source) > 10


@pytest.mark.parametrize("name", NAMES)
def test_parameters_have_a_known_quantity_a_meaning_and_ordered_bounds(name):
    for parameter, declared in EFFECTS[name].parameters.items():
        assert parameter.isidentifier()
        assert declared.quantity in QUANTITIES
        assert declared.meaning
        assert declared.lower < declared.upper
        assert declared.search.starts and np.all(np.isfinite(declared.search.starts))
        assert all(unit_of(declared.quantity, axis) for axis in ("prismatic", "revolute"))


@pytest.mark.parametrize("name", NAMES)
def test_what_an_effect_names_exists(name):
    effect = EFFECTS[name]
    assert effect.role in ROLES
    assert effect.needs <= set(KNOWN) - {name}
    assert set(effect.elsewhere) < set(AXES)
    assert set(effect.elsewhere.values()) <= set(KNOWN) - {name}
    assert effect.always <= set(CLAIMS), "a claim that no test checks"
    assert effect.absent, "without absent values an effect cannot be added at no change"
    for parameter, value in effect.absent.items():
        declared = effect.parameters[parameter]
        assert declared.lower <= value <= declared.upper
    for state in effect.states.values():
        assert state.quantity in QUANTITIES


@pytest.mark.parametrize("name", NAMES)
def test_symbols_carry_the_effects_name_and_every_parameter_is_used(name):
    effect = EFFECTS[name]
    symbols = effect.symbols()
    assert {p: s.name for p, s in symbols.items()} == {p: f"{name}_{p}" for p in effect.parameters}
    used = effect.expression().free_symbols.union(
        *(r.free_symbols for r in effect.rates().values())
    )
    assert set(symbols.values()) <= used
    needed = {s for need in effect.needs for s in KNOWN[need].symbols().values()}
    assert used <= {*SIGNALS.values(), *symbols.values(), *effect.state_symbols().values()} | needed


def test_no_two_effects_share_a_symbol():
    every = [
        s for e in EFFECTS.values() for s in (*e.symbols().values(), *e.state_symbols().values())
    ]
    assert len(every) == len(set(every))


# claims


LEVEL_SIGNALS = ("velocity", "direction", "position", "time", "acting_force")


@cache
def settled_law(name):
    """The law as a function of signals and parameters, hidden states where they come to rest."""
    effect = EFFECTS[name]
    law, rates, states = effect.expression(), effect.rates(), effect.state_symbols()
    if rates:
        law = law.subs(sp.solve(list(rates.values()), *states.values()))
    return sp.lambdify(
        [*(SIGNALS[n] for n in LEVEL_SIGNALS), *effect.symbols().values()], law, "math"
    )


def level_at(name, velocity, values):
    """What the effect makes of the friction level at that velocity, elsewhere held."""
    law = settled_law(name)
    return float(
        law(
            velocity,
            np.sign(velocity),
            0.003,
            1.0,
            -0.7,
            *(values[n] for n in EFFECTS[name].parameters),
        )
    )


def positive(effect):
    """Values of all parameters over three decades about the typical, within their bounds."""
    return st.fixed_dictionaries(
        {
            name: st.floats(-1.5, 1.5).map(
                lambda d, n=name, q=p: float(
                    np.clip(typical(effect.name, n) * 10**d, q.lower, q.upper)
                )
            )
            for name, p in effect.parameters.items()
        }
    )


@pytest.mark.parametrize("name", declaring("even in velocity"))
@settings(max_examples=40)
@given(data=st.data(), velocity=st.floats(1e-6, 2.0))
def test_the_level_is_the_same_in_both_directions(name, data, velocity):
    values = data.draw(positive(EFFECTS[name]))
    assert level_at(name, velocity, values) == level_at(name, -velocity, values)


@pytest.mark.parametrize("name", declaring("non-negative"))
@settings(max_examples=40)
@given(data=st.data(), velocity=st.floats(-2.0, 2.0))
def test_the_level_is_never_below_zero(name, data, velocity):
    values = data.draw(positive(EFFECTS[name]))
    assert level_at(name, velocity, values) >= 0.0


# composition


@pytest.mark.parametrize("factor", ["friction_drift", "position_dependent_friction"])
def test_a_factor_scales_the_coulomb_level_and_not_what_others_add(factor):
    plain, whole = body_of("coulomb", "stribeck"), body_of("coulomb", "stribeck", factor)
    own = EFFECTS[factor].expression()
    coulomb = EFFECTS["coulomb"].expression()
    assert sp.simplify(whole.level() - plain.level() - coulomb * (own - 1)) == 0


def test_a_users_factor_that_needs_no_effect_scales_the_whole_level():
    scaled = replace(EFFECTS["friction_drift"], needs=frozenset())
    whole = body_of("coulomb", "stribeck").with_effect(scaled)
    plain = body_of("coulomb", "stribeck").level()
    assert sp.simplify(whole.level() - plain * scaled.expression()) == 0


# absence


@pytest.mark.parametrize("name", NAMES)
def test_an_effect_at_its_absent_values_changes_nothing_along_a_motion(name):
    x, u, f = signals()
    motion = motion_along(encoded(x), u, f, resolution=1e-6)
    around = [n for n in ("coulomb", "viscous", *with_needs(name)) if n != name]
    around = list(dict.fromkeys(around))
    without = residual_along(body_of(*around), motion).residual.value
    there = residual_along(body_of(*around, name, absent=(name,)), motion).residual.value
    # the order of sums may differ by rounding, nothing else
    np.testing.assert_allclose(there, without, rtol=0, atol=1e-13 * np.abs(without).max())
    full = residual_along(body_of(*around, name), motion).residual.value
    assert np.abs(full - without).max() > 1e-3 * np.abs(without).max(), "at typical values it shows"


def in_time(name):
    """False where a hidden state is sampled: it lags a sample, however small its parameters."""
    return not EFFECTS[name].states or EFFECTS[name].role == "actuation"


@pytest.mark.parametrize(
    "name", [n for n in NAMES if all(v == 0 for v in EFFECTS[n].absent.values()) if in_time(n)]
)
def test_a_trace_of_an_effect_changes_a_trace(name):
    """No jump between absent and present: a model can be improved from an effect at zero."""
    x, u, f = signals()
    motion = motion_along(encoded(x), u, f, resolution=1e-6)
    effect, names = EFFECTS[name], with_needs(name)
    around = [n for n in names if n != name]
    trace = {f"{name}.{p}": 1e-6 * typical(name, p) for p in effect.absent}
    without = residual_along(body_of(*around), motion).residual.value
    little = residual_along(body_of(*names, values=trace), motion).residual.value
    # 1e-6 of a typical strength; a hundredfold margin for what changes faster than in proportion
    assert np.abs(little - without).max() < 1e-4 * np.abs(without).max()


# axes


@pytest.mark.parametrize(
    ("name", "axis"), [(n, a) for n in NAMES for a in EFFECTS[n].elsewhere], ids=str
)
def test_an_effect_on_an_axis_that_it_does_not_hold_on_is_refused_with_what_to_write(name, axis):
    other = EFFECTS[name].elsewhere[axis]
    with pytest.raises(
        ModelError, match=f'"{name}" holds on no {axis} axis: there it is "{other}"'
    ):
        body_of(*with_needs(name), axis=axis)


# linear effects


@pytest.mark.parametrize("name", [n for n in NAMES if EFFECTS[n].linear])
@settings(max_examples=10)
@given(a=st.floats(-3, 3), b=st.floats(-3, 3))
def test_a_linear_effect_superposes(name, a, b):
    names = with_needs(name)

    def left(*given):
        return residual_along(body_of(*names), motion_along(*given)).residual.value

    one, other = signals(1), signals(2)
    both = left(*(a * p + b * q for p, q in zip(one, other, strict=True)))
    apart = a * left(*one) + b * left(*other)
    size = np.abs(left(*one)).max() + np.abs(left(*other)).max()
    np.testing.assert_allclose(both, apart, rtol=0, atol=1e-9 * size)


@pytest.mark.parametrize("name", NAMES)
def test_the_linear_form_is_declared_or_none(name):
    form = EFFECTS[name].linear_form(S)
    assert (form is not None) == EFFECTS[name].linear
    if form is not None:
        assert form.free_symbols <= {S, *EFFECTS[name].symbols().values()}


@pytest.mark.parametrize("frequency", [2.0, 7.0, 15.0])
@pytest.mark.parametrize("name", [n for n in NAMES if EFFECTS[n].linear])
def test_the_linear_form_is_the_law_along_a_sine(name, frequency):
    """Residual along x = sin(wt), command = sin(wt): G u - (m s^2 + Z) x at s = jw."""
    effect = EFFECTS[name]
    body = unled(body_of(*with_needs(name)))
    t = np.arange(4000) * 1e-3
    wave = np.exp(2j * np.pi * frequency * t)
    motion = motion_along(0.01 * wave.imag, wave.imag)
    along = residual_along(body, motion)
    numbers = {s: typical(name, n) for n, s in effect.symbols().items()}
    form = complex(effect.linear_form(S).subs({**numbers, S: 2j * sp.pi * frequency}).evalf())
    impedance = -INERTIA * (2 * np.pi * frequency) ** 2
    transfer = 1.0 + 0j
    if effect.role == "actuation":
        transfer = form
    else:
        impedance = impedance + form
    hold = np.sinc(frequency * 1e-3) * np.exp(-1j * np.pi * frequency * 1e-3)
    expected = ((transfer * hold - 0.01 * impedance) * wave).imag
    most = 3e-3 if effect.role == "structure" else 1e-3
    inside = slice(700, -700)  # s; ends feel the continuation of the record
    # a staircase has images about the sample rate, of relative size (w h)^2/12 < 1e-3 at 15 Hz; a
    # tip's drive is linear between rows, and its resonance near by triples that
    np.testing.assert_allclose(
        along.residual.value[inside], expected[inside], rtol=0, atol=most * np.abs(expected).max()
    )


# units


def factors(force, position, time):
    """What each quantity is multiplied with when its units are."""
    return {
        "force": force,
        "position": position,
        "time": time,
        "velocity": position / time,
        "acceleration": position / time**2,
        "inertia": force * time**2 / position,
        "damping": force * time / position,
        "stiffness": force / position,
        "drag": force * time**2 / position**2,
        "cubic_stiffness": force / position**3,
        "frequency": 1.0 / time,
        "angle": 1.0,
        "dimensionless": 1.0,
        "temperature": 1.0,
        "temperature_coefficient": 1.0,
    }


@pytest.mark.parametrize("time", [1.0, 0.25])  # s; down only: see the number of samples below
@pytest.mark.parametrize(("force", "position"), [(8.0, 1.0), (1.0, 2.0**10), (0.5, 2.0**-7)])
@pytest.mark.parametrize("name", NAMES)
def test_an_effect_gives_the_same_answer_in_other_units(name, force, position, time):
    """Every parameter has the quantity that its law needs: the residual scales like a force."""
    if EFFECTS[name].elsewhere:
        position = 1.0  # an angle has no other unit
    if name == "shear_thinning":
        position = time  # a force at the unit of speed, whatever that is
    # 0.4 s: shorter than the continuation at the ends, which is a fixed time
    x, u, f = signals(samples=400)
    step = 1e-6
    names = with_needs(name)
    by = factors(force, position, time)
    body = body_of(*names)
    values = {n: v.value * by[body.parameter(n).quantity] for n, v in body.parameters.items()}
    one = residual_along(body, motion_along(encoded(x, step), u, f, resolution=step))
    other = residual_along(
        body.with_values(values),
        motion_along(
            position * encoded(x, step),
            force * u,
            force * f,
            sample_time=1e-3 * time,
            bandwidth=60.0 / time,
            resolution=position * step,
        ),
    )
    np.testing.assert_array_equal(one.motion.direction, other.motion.direction)
    expected = force * one.residual.value
    # rounding, through exponentials of arguments of the order of a hundred
    np.testing.assert_allclose(
        other.residual.value, expected, rtol=0, atol=1e-9 * np.abs(expected).max()
    )


# a user's own effect

OWN = '''"""Own drag: a force in proportion to the square of velocity.

    F = D v abs(v)
"""

from teleopdesign import Effect, Parameter


def law(now, p):
    return p.drag * now.velocity * abs(now.velocity)


EFFECT = Effect(
    role="force",
    law=law,
    parameters={"drag": Parameter("drag", "D: force per velocity squared")},
    absent={"drag": 0.0},
    source="made for a test",
)
'''


@pytest.fixture
def own(tmp_path):
    file = tmp_path / "own_drag.py"
    file.write_text(OWN)
    return file


def test_a_users_file_becomes_an_effect_under_the_files_name(own):
    known = catalogue([own])
    assert set(known) == {*EFFECTS, "own_drag"}
    effect = known["own_drag"]
    assert effect.title == "Own drag: a force in proportion to the square of velocity."
    v, drag = SIGNALS["velocity"], effect.symbols()["drag"]
    assert effect.expression() == drag * v * sp.Abs(v)


def test_a_users_effect_takes_part_in_the_residual(own):
    x, u, f = signals()
    motion = motion_along(x, u, f)
    bare = body_of()
    body = bare.with_effect(load_effect(own), {"drag": 3.0})
    force = (
        residual_along(bare, motion).residual.value - residual_along(body, motion).residual.value
    )
    np.testing.assert_allclose(force, 3.0 * motion.velocity * abs(motion.velocity), atol=1e-12)


def test_a_users_effect_takes_the_place_of_one_of_the_same_name(tmp_path):
    file = tmp_path / "viscous.py"
    file.write_text(OWN)
    assert "drag" in catalogue([file])["viscous"].parameters
    assert "damping" in EFFECTS["viscous"].parameters, "the package's own stays"


BAD = {
    "no EFFECT": ("EFFECT = Effect(", "OTHER = Effect(", "found no EFFECT"),
    "wrong role": (
        'role="force"',
        'role="forse"',
        'role: found the text "forse", expected one of .*mean "force"',
    ),
    "unknown signal": ("now.velocity *", "now.velocty *", "velocty"),
    "unknown parameter": ("p.drag", "p.dragg", "dragg"),
    "a symbol of its own": (
        "return p.drag",
        "import sympy\n    return sympy.Symbol('mystery') * p.drag",
        "law uses mystery",
    ),
    "syntax": ("def law(now, p):", "def law(now, p)", "SyntaxError"),
    "import": ("from teleopdesign import Effect", "from teleopdesign import Efect", "Efect"),
    "failure of its own": ("def law", "1 / 0\n\n\ndef law", "ZeroDivisionError"),
    "absent names no parameter": ('absent={"drag"', 'absent={"drg"', 'absent: no parameter "drg"'),
    "argument left out": ('    absent={"drag": 0.0},\n', "", "absent"),
}


@pytest.mark.parametrize("mistake", BAD)
def test_a_mistake_in_an_effect_file_is_one_line(own, mistake):
    old, new, expected = BAD[mistake]
    text = own.read_text()
    assert old in text
    own.write_text(text.replace(old, new, 1))
    with pytest.raises(ModelError) as caught:
        load_effect(own)
    message = str(caught.value)
    assert message.startswith(f"{own}: ")
    assert len(message.splitlines()) == 1
    assert re.search(expected, message), message


@pytest.mark.parametrize("field", [f.name for f in fields(FitSearch)])
def test_an_older_file_is_told_what_to_write_instead(own, field):
    text = own.read_text()
    older = re.sub(r"(Parameter\([^)]*)\)", rf"\1, {field}=0)", text)
    assert older != text
    own.write_text(older)
    with pytest.raises(ModelError, match=rf"search=FitSearch\({field}=") as refusal:
        load_effect(own)
    assert "\n" not in str(refusal.value)


def test_an_effect_file_that_is_not_there_or_has_no_name_is_one_line(tmp_path):
    with pytest.raises(ModelError, match="no such effect file"):
        load_effect(tmp_path / "nothing.py")
    file = tmp_path / "my-effect.py"
    file.write_text(OWN)
    with pytest.raises(ModelError, match='"my-effect" must be a name such as my_effect.py'):
        load_effect(file)


def test_an_unknown_effect_is_answered_with_the_nearest_name():
    with pytest.raises(ModelError, match=r'here: no effect "stribek"; did you mean "stribeck"\?'):
        find_effect("stribek", where="here")


def test_the_catalogue_cannot_be_changed_in_place():
    with pytest.raises(TypeError):
        EFFECTS["new"] = EFFECTS["coulomb"]


def test_the_catalogue_is_loaded_without_numba():
    code = "import sys, teleopdesign.effects; print('numba' in sys.modules)"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "False"
