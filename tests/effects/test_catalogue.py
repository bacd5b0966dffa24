"""Every effect of the catalogue keeps what its file declares: text, symbols, bounds, claims."""

import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from effects.along import (
    KNOWN,
    NAMES,
    body_of,
    declaring,
    typical,
    with_needs,
)
from hypothesis import given, settings
from hypothesis import strategies as st

import teleopdesign.effects as folder
from teleopdesign.base.errors import ModelError
from teleopdesign.base.units import AXES, QUANTITIES, unit_of
from teleopdesign.effects import (
    BLOCK_EFFECTS,
    EFFECTS,
    ONLY_IN,
    SIGNALS,
    check_laws,
    load_effect,
    with_block_effects,
)
from teleopdesign.effects._effect import ROLES

HOME = Path(folder.__file__).parent
FILES = [p for p in (*HOME.glob("*.py"), *HOME.glob("of_blocks/*.py")) if p.name[0] != "_"]
CLAIMS = ("even in velocity", "non-negative")  # those that a test below checks


# text and names


def test_every_file_of_the_folder_is_one_effect_under_the_name_of_the_file():
    known = EFFECTS | BLOCK_EFFECTS
    assert sorted(p.stem for p in FILES) == sorted(known)
    assert all(known[name].name == name for name in known)


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
    text = (Path(folder.__file__).parent / "of_blocks" / "impact_damping.py").read_text()
    file = tmp_path / "own_damping.py"
    file.write_text(text.replace("from .._effect", "from teleopdesign.effects._effect"))
    assert "environment_stiffness" in str(load_effect(file).expression())
    file.write_text(
        file.read_text().replace('needs=frozenset({"environment"})', "needs=frozenset()")
    )
    with pytest.raises(ModelError, match="law uses environment_stiffness"):
        load_effect(file)


@pytest.mark.parametrize("file", FILES, ids=lambda p: p.stem)
def test_the_laws_use_only_signals_and_parameters_that_they_may_use(file):
    check_laws(with_block_effects()[file.stem], file)


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
    assert set(effect.counterparts) < set(AXES)
    assert set(effect.counterparts.values()) <= set(KNOWN) - {name}
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


# claims


LEVEL_SIGNALS = ("velocity", "direction", "position", "time", "acting_force", "carried_force")


@cache
def law_at_rest(name):
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
    law = law_at_rest(name)
    return float(
        law(
            velocity,
            np.sign(velocity),
            0.003,
            1.0,
            -0.7,
            0.4,
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


@pytest.mark.parametrize(
    ("name", "axis"), [(n, a) for n in NAMES for a in EFFECTS[n].counterparts], ids=str
)
def test_an_effect_on_an_axis_that_it_does_not_hold_on_is_refused_with_what_to_write(name, axis):
    other = EFFECTS[name].counterparts[axis]
    with pytest.raises(
        ModelError, match=f'"{name}" holds on no {axis} axis: there it is "{other}"'
    ):
        body_of(*with_needs(name), axis=axis)


def test_the_catalogue_is_loaded_without_numba():
    code = "import sys, teleopdesign.effects; print('numba' in sys.modules)"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "False"
