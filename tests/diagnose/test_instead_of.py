"""An effect of the user's model that only imitates another gives way to it, and the answer says so.

Inertia, Coulomb and viscous friction is what nearly everyone starts with. Below break-away a
bristle turns each loop with a force that leads the position, as a damper's does.
"""

import json
from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
from diagnose.contract import violations
from diagnose.made_records import dahl, write_made
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign import Body, Model, find_missing, load_experiment
from teleopdesign.base.errors import ModelError
from teleopdesign.diagnose.answer import answer, load_answer, write_answer
from teleopdesign.diagnose.candidates import Candidate, candidates
from teleopdesign.diagnose.decision import find_superfluous_effect
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.identifiability import OpenWidths
from teleopdesign.diagnose.rung import Rung, restore_replaced
from teleopdesign.diagnose.search import estimate_from_starts
from teleopdesign.diagnose.statements import OpenRival
from teleopdesign.effects import EFFECTS
from teleopdesign.next_experiment.rivals import rival_instead
from teleopdesign.show.diagnose.text import ladder_text
from teleopdesign.show.report.parameter_table import parameter_rows

pytestmark = pytest.mark.slow  # diagnoses of whole cases

KNOWN = {n: EFFECTS[n] for n in ("coulomb", "viscous", "presliding", "spring", "bias", "stribeck")}
MODEL = """coulomb = { level = { value = 1.0, unit = "N*m" } }
viscous = { damping = { value = 30.0, unit = "N*m*s/rad" } }
"""


def loops(seed):
    """A slow motion within a few bristle lengths (0.2 mrad): sines below 1 Hz, small on large."""
    rng = np.random.default_rng(seed)
    f = rng.uniform(0.15, 0.8, 5)
    a = rng.uniform(0.3, 1.0, 5) * 2.5e-4
    p = rng.uniform(0, 6, 5)

    def position(t):
        return np.sum(a[:, None] * np.sin(2 * np.pi * np.outer(f, t) + p[:, None]), axis=0)

    return position


def write_bristle(folder, viscous=0.0):
    def force(t, x, v):
        return dahl(x, stiffness=4e3, level=0.8) + viscous * v

    return write_made(
        folder,
        {"fit": [(30.0, loops(1))], "check": [(20.0, loops(2))]},
        force,
        effects=MODEL,
        step=2e-6,
        noise=2e-3,
    )


@pytest.fixture(scope="module")
def search(tmp_path_factory):
    folder = write_bristle(tmp_path_factory.mktemp("bristle") / "case")
    experiment = load_experiment(folder)
    return experiment, find_missing(experiment, Model.from_experiment(experiment, KNOWN))


def test_a_damper_that_stood_in_for_hysteresis_gives_way_to_the_bristle(search):
    _, diagnosis = search
    before = diagnosis.before.model.parameters["device.viscous.damping"]
    assert before.value > 5 * before.stderr, "the damper of the user's model is surely there"
    assert [str(c) for c in diagnosis.missing] == ["presliding at device"]
    assert diagnosis.rungs[1].instead_of == "viscous"
    assert not diagnosis.model.body("device").has("viscous")
    assert diagnosis.after.check_error < 0.3 * diagnosis.before.check_error
    stiffness = diagnosis.model.parameters["device.presliding.stiffness"]
    assert stiffness.value == pytest.approx(4e3, rel=0.1)


def test_the_table_of_parameters_holds_what_gave_way(search):
    _, diagnosis = search
    rows = {r.name: r for r in parameter_rows(diagnosis)}
    assert set(diagnosis.before.model.parameters) <= set(rows)
    gone = rows["device.viscous.damping"]
    assert gone.gave_way_to == "presliding" and gone.after is None
    assert gone.before == diagnosis.before.model.parameters["device.viscous.damping"].value
    assert [r.name for r in rows.values() if r.gave_way_to] == ["device.viscous.damping"]


def test_a_rival_of_what_took_another_place_has_that_other_back(search):
    """Unless the rival, too, was compared without it."""
    _, diagnosis = search
    added, before = diagnosis.rungs[1].added, diagnosis.before.model
    beside = before.with_effect("spring", at="device", values={"stiffness": 1.0})
    spring = OpenRival(Candidate(EFFECTS["spring"], "device"), beside)
    fit = rival_instead(diagnosis, added, spring)
    assert [e.name for e in fit.model.body("device").effects] == ["coulomb", "viscous", "spring"]
    alone = estimate(beside, diagnosis.prepared)
    assert fit.check_error == pytest.approx(alone.check_error, rel=0.01)
    without = replace(spring, model=beside.without_effect("viscous", at="device"))
    fit = rival_instead(diagnosis, added, without)
    assert not fit.model.body("device").has("viscous")


def test_the_answer_says_what_it_takes_the_place_of(search):
    _, diagnosis = search
    document = answer(diagnosis)
    assert document["missing"] == [
        {"effect": "presliding", "at": "device", "instead_of": "viscous"}
    ]
    assert [row["instead_of"] for row in document["ladder"]] == [None, "viscous"]
    assert not [n for n in document["model_parameters"] if "viscous" in n]
    assert not violations(document)
    text = ladder_text(diagnosis)
    assert "+ presliding at device instead of viscous" in text
    assert "effects_missing: presliding at device instead of viscous." in text


def test_an_answer_read_back_knows_it_too(search, tmp_path):
    experiment, diagnosis = search
    write_answer(diagnosis, tmp_path / "answer.json")
    back = load_answer(tmp_path / "answer.json", KNOWN, experiment=experiment)
    assert back == diagnosis and repr(back) == repr(diagnosis)
    assert json.loads((tmp_path / "answer.json").read_text())["missing"][0]["instead_of"]


def test_a_damper_that_is_there_stays_beside_the_bristle(tmp_path):
    experiment = load_experiment(write_bristle(tmp_path / "case", viscous=300.0))
    diagnosis = find_missing(experiment, Model.from_experiment(experiment, KNOWN))
    assert [str(c) for c in diagnosis.missing] == ["presliding at device"]
    assert diagnosis.rungs[1].instead_of is None
    damping = diagnosis.model.parameters["device.viscous.damping"]
    assert damping.value == pytest.approx(300.0, rel=0.1)


def test_what_ends_at_its_absence_gives_way_before_what_is_only_open(search):
    """Two are no longer told beside a candidate; one of them is gone."""
    names = ("device.coulomb.level", "device.viscous.damping")
    fit, candidate = search[1].fit(search[1].before.model), search[1].rungs[1].added
    sure, unsure = (
        fit.model.with_values(
            {n: replace(fit.model.parameters[n], value=1.0, stderr=e) for n in names}
        )
        for e in (0.01, 2.0)
    )
    base = replace(fit, model=sure, at_bound=())
    open_now = replace(fit, model=unsure, at_bound=())
    assert find_superfluous_effect(base, open_now, candidate) is None, "either may be the one"
    gone = unsure.with_values({names[1]: replace(unsure.parameters[names[1]], value=0.0)})
    ended = replace(fit, model=gone, at_bound=(names[1],))
    assert find_superfluous_effect(base, ended, candidate).effect.name == "viscous"


#: the module: the folder has a function of the same name
rank = import_module("teleopdesign.diagnose.rank")


def ranked_beside_discredited(search, monkeypatch, name):
    """The bristle as a candidate, where an effect of the model loses its name beside it."""
    experiment, diagnosis = search
    monkeypatch.setattr(rank, "find_superfluous_effect", lambda *_, **__: None)
    monkeypatch.setattr(
        rank,
        "implausible_effects",
        lambda model, _: (
            {(name, "device"): "it stands for something else"}
            if model.body("device").has("presliding") and model.body("device").has(name)
            else {}
        ),
    )
    base = diagnosis.fit(diagnosis.before.model)
    candidate = Candidate(EFFECTS["presliding"], "device")
    added = base.model.with_effect("presliding", at="device")
    records = diagnosis.prepared
    fit = estimate_from_starts(added, records, base)
    return rank._ranked_best(base, (candidate, fit), OpenWidths(records))


def test_a_candidate_that_needs_what_loses_its_name_is_refused(search, monkeypatch):
    ranked = ranked_beside_discredited(search, monkeypatch, "coulomb")
    assert ranked.instead_of is None
    assert ranked.implausible == "with it, coulomb is implausible: it stands for something else"


#: an effect that another can count as -> its parameter
STRENGTH = {"viscous": "damping"}


def chains():
    """(stands in, is replaced, rests on either) of the catalogue, by `counts_as` and `needs`."""
    return [
        (new, old, other.name)
        for new, effect in EFFECTS.items()
        if not effect.free  # no step of a search adds it
        for old in effect.counts_as
        for other in EFFECTS.values()
        if old in other.needs and old not in other.parameters_of_others()
    ]


@pytest.mark.parametrize(("new", "old", "other"), chains())
def test_what_rests_on_either_stays_while_one_gives_way_to_the_other(new, old, other):
    """Each order of the two rungs can be taken back: no effect is left without what it needs."""
    axis = "prismatic"
    plain = Model(
        {"device": Body(axis, {"inertia": 1.0, f"{old}.{STRENGTH[old]}": 2.0}, (EFFECTS[old],))}
    )
    before = plain.with_effect(other)
    gave_way = restore_replaced(Candidate(EFFECTS[old], "device"), before)
    model = Model({"device": Body(axis, {"inertia": 1.0}, ())}).with_effect(new).with_effect(other)
    rung = Rung(Candidate(EFFECTS[new], "device"), None, replaced=gave_way)
    back = rung.undo_addition(model)
    assert {n for n, _ in back.effects} == {old, other}
    assert back.parameters[f"device.{old}.{STRENGTH[old]}"].value == 2.0


def test_a_shape_of_friction_that_comes_back_takes_the_place_of_the_other():
    body = Body("prismatic", {"inertia": 1.0, "coulomb.level": 1.0}, (EFFECTS["coulomb"],))
    plain = Model({"device": body})
    before, after = plain.with_effect("presliding"), plain.with_effect("maxwell_slip")
    gave_way = restore_replaced(Candidate(EFFECTS["presliding"], "device"), before)
    rung = Rung(Candidate(EFFECTS["maxwell_slip"], "device"), None, replaced=gave_way)
    assert {n for n, _ in rung.undo_addition(after).effects} == {"coulomb", "presliding"}


@settings(max_examples=15, deadline=None)
@given(axis=st.sampled_from(["prismatic", "revolute"]), data=st.data())
def test_whatever_gave_way_to_whatever_comes_back(axis, data):
    """Over models of any effects: a candidate in the place of one that the others can spare."""
    model = Model({"device": Body(axis, {"inertia": 1.0}, ())})
    for _ in range(data.draw(st.integers(1, 7))):
        new = data.draw(st.sampled_from(candidates(model)))
        model = model.with_effect(new.effect, at=new.at)
    for new in candidates(model):
        beside = model.with_effect(new.effect, at=new.at)
        for old in model.body("device").effects:
            try:
                instead = beside.without_effect(old.name, at="device")
            except ModelError:
                continue  # another effect needs it
            gave_way = restore_replaced(Candidate(old, "device"), model)
            back = Rung(new, None, replaced=gave_way).undo_addition(instead)
            assert set(back.effects) == set(model.effects)
