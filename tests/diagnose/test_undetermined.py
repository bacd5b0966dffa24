"""Parameters that records do not determine are named, and doubtful effects leave the model."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from diagnose.stub_models import Table
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.diagnose import undetermined as undetermined_module
from teleopdesign.diagnose.answer import answer, load_answer, write_answer
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.conclusion import find_doubtful_rung
from teleopdesign.diagnose.identifiability import doubt, explains_most, is_identifiable
from teleopdesign.diagnose.products import Product, best_product
from teleopdesign.diagnose.statements import SetAside, Undetermined
from teleopdesign.diagnose.undetermined import alike_on_records, find_undetermined, known_together
from teleopdesign.effects import EFFECTS
from teleopdesign.show.diagnose.text import ladder_text


@given(power=st.floats(0.3, 3.0), noise=st.floats(1e-4, 1e-2))
def test_the_product_that_a_record_tells_is_detected(power, noise):
    """Columns that are alike up to a little: one combination is told, the other hardly."""
    rng = np.random.default_rng(1)
    one, little = rng.standard_normal(500), noise * rng.standard_normal(500)
    columns = np.column_stack([one, power * one + little])
    covariance = np.linalg.inv(columns.T @ columns)
    powers, known = best_product(columns, np.sqrt(np.diag(covariance)))
    expected = np.array([1.0, power]) / max(1.0, power)
    np.testing.assert_allclose(powers, expected, rtol=0.05)
    assert known < 0.1 * np.sqrt(np.diag(covariance)).min()


def stribeck_of(end):
    return next(r.added for r in end.rungs if r.added is not None)


def with_errors(fit, times):
    """The fit with standard errors of `stribeck` so many times its values."""
    values = {
        n: replace(v, stderr=times * abs(v.value))
        for n, v in fit.model.parameters.items()
        if ".stribeck." in n
    }
    return replace(fit, model=fit.model.with_values(values))


def test_parameters_that_are_well_known_are_not_called_open(end):
    assert known_together(with_errors(end.after, 0.01), stribeck_of(end)) == ""


def test_an_effect_whose_strength_no_error_tells_from_absence_is_doubtful(end, prepared_case):
    added, fit = stribeck_of(end), end.after
    assert doubt(with_errors(fit, 0.3), added) == ""
    assert "extra_static_level" in doubt(with_errors(fit, 1.5), added)
    rungs = end.rungs
    assert find_doubtful_rung(rungs, prepared_case, fit) is None
    last = replace(rungs[-1], fit=with_errors(fit, 1.5))
    rung, why = find_doubtful_rung((little_more_left(rungs[0], fit), last), prepared_case, fit)
    assert rung.added == added and "the effect may be absent" in why


def little_more_left(rung, fit):
    """The rung before, as if it left 1.2 times what the fit leaves."""
    more = {n: 1.2 * getattr(fit, n) for n in ("fit_residual", "check_residual")}
    return replace(rung, fit=replace(rung.fit, **more))


def test_most_is_explained_where_half_of_the_squares_of_both_uses_is(end):
    first, last = end.rungs[0], end.rungs[-1]
    assert explains_most(first.fit, last.fit)
    little = little_more_left(first, last.fit).fit
    assert not explains_most(little, last.fit)
    one_use = replace(little, fit_residual=first.fit.fit_residual)
    assert not explains_most(one_use, last.fit)


def test_an_effect_that_explains_most_is_doubtful_where_nothing_of_it_is_known(end, prepared_case):
    """A period of 11 +- 79 rad explains a sweep that is seen once, and is nothing."""
    first, last = end.rungs[0], end.rungs[-1]
    open_fit = with_errors(last.fit, 30.0)
    assert explains_most(first.fit, open_fit)
    rung, _ = find_doubtful_rung((first, replace(last, fit=open_fit)), prepared_case, open_fit)
    assert rung.added == stribeck_of(end)
    assert not is_identifiable(open_fit, first.fit)


def test_simulated_readings_leave_an_effect_that_explains_most_and_is_known_by_the_records(
    end, prepared_case
):
    """At half a log's rate a simulated motor slid half as long: `stribeck` was set aside."""
    first, last = end.rungs[0], end.rungs[-1]
    estimated = in_a_valley(with_errors(last.fit, 1.2), 0.01)
    wide = in_a_valley(with_errors(last.fit, 30.0), 0.01)
    assert "extra_static_level" in doubt(wide, stribeck_of(end))
    assert doubt(wide, stribeck_of(end), most=estimated) == ""
    assert find_doubtful_rung((first, replace(last, fit=wide)), prepared_case, estimated) is None
    little = (little_more_left(first, last.fit), replace(last, fit=wide))
    assert find_doubtful_rung(little, prepared_case, estimated) is not None, "explains too little"


def in_a_valley(fit, little):
    """The fit with both parameters of `stribeck` alike in the residual, up to a little."""
    level, speed = (fit.free.index(f"device.stribeck.{n}") for n in PAIR)
    values = [fit.model.parameters[fit.free[i]].value for i in (level, speed)]
    noise = np.random.default_rng(3).standard_normal(len(fit.jacobian))
    column = fit.jacobian[:, level] * values[0] / fit.scale[level]
    other = 0.5 * column + little * np.linalg.norm(column) / np.linalg.norm(noise) * noise
    jacobian = fit.jacobian.copy()
    jacobian[:, speed] = other * fit.scale[speed] / values[1]
    return replace(fit, jacobian=jacobian)


PAIR = ("extra_static_level", "stribeck_velocity")


def test_an_effect_whose_product_is_sure_is_there_though_each_parameter_is_open(end):
    added, base = stribeck_of(end), end.before
    fit = in_a_valley(with_errors(end.after, 1.2), 0.01)
    assert doubt(fit, added) == ""
    assert is_identifiable(fit, base)
    assert "extra_static_level" in known_together(fit, added)
    wide = in_a_valley(with_errors(end.after, 1.2), 0.5)
    assert "extra_static_level" in doubt(wide, added), "no product is sure there"
    assert not is_identifiable(wide, little_more_left(end.rungs[0], wide).fit)


def test_what_was_set_aside_or_is_undetermined_stands_in_text_and_answer(
    diagnosis, experiment, tmp_path
):
    added, gone = stribeck_of(diagnosis), Candidate(EFFECTS["backlash"], "device")
    whole = replace(
        diagnosis,
        undetermined=(Undetermined(added, "the level at rest is not told"),),
        set_aside=(SetAside(gone, 0.03, "gap = 0.1 +- 0.2 m is not told from absence"),),
    )
    text = ladder_text(whole)
    assert "not determined: the level at rest" in text
    assert "set aside: backlash at device (3.00 %): gap" in text
    content = answer(whole)
    assert content["cannot_tell"][0]["effect"] == "stribeck"
    assert content["set_aside"][0]["reason"].startswith("gap")
    write_answer(whole, tmp_path / "answer.json")
    assert load_answer(tmp_path / "answer.json", experiment=experiment) == whole


@pytest.fixture(scope="module")
def prepared_case(experiment):
    from teleopdesign.measurement.prepare import prepare

    return prepare(experiment)


def product(*errors, known):
    names = tuple(f"device.stribeck.{n}" for n in ("a", "b", "c")[: len(errors)])
    return Product(names, (1.0,) * len(errors), errors, known)


@pytest.mark.parametrize(
    ("product", "message"),
    [
        (
            product(0.51, 0.3, known=0.149),
            "a * b is known within 15 %, each factor only within 51 %, 30 %",
        ),
        (product(0.51, 0.3, known=0.151), ""),  # as well as the better of the two, nearly
        (product(0.49, 0.4, known=0.01), ""),  # each is known well enough
        (product(0.3, 0.51, 0.4, known=0.1), "a * b * c is known within 10 %"),
        (
            product(3.0, 2.0, known=0.9),
            "a * b is known within 90 %, each factor only within 3e+02 %, 2e+02 %",
        ),
        (None, ""),
    ],
)
def test_a_product_is_reported_where_one_factor_is_open_and_the_product_is_known_twice_as_well(
    monkeypatch, product, message
):
    monkeypatch.setattr(undetermined_module, "product_of", lambda fit, effect: product)
    sentence = known_together(None, Candidate(EFFECTS["stribeck"], "device"))
    assert sentence.startswith(message) and bool(sentence) == bool(message)


def test_what_is_undetermined_is_reported_for_each_effect_of_the_last_model_in_order(monkeypatch):
    table = Table(lambda names: 1.0)
    rungs = table.rungs("bias", "spring", "viscous")
    by_effect = {"bias": "a level at rest", "viscous": None, "spring": None}
    together = {"bias": "", "spring": "a * b", "viscous": "a * c"}
    calls = []

    def of_effect(effect, at, model, prepared):
        calls.append(model)
        return by_effect[effect.name]

    monkeypatch.setattr(undetermined_module, "undetermined_of", of_effect)
    monkeypatch.setattr(undetermined_module, "alike_on_records", lambda fit, c, prepared: "")
    monkeypatch.setattr(
        undetermined_module, "known_together", lambda fit, c: together[c.effect.name]
    )
    sentences = [
        (one.candidate.effect.name, one.sentence) for one in find_undetermined(rungs, None)
    ]
    assert sentences == [("bias", "a level at rest"), ("spring", "a * b"), ("viscous", "a * c")]
    assert all(model is rungs[-1].fit.model for model in calls)
    together["bias"] = "b * c"
    assert [one.sentence for one in find_undetermined(rungs, None)][:2] == [
        "a level at rest",
        "b * c",
    ]
    # what others made superfluous has nothing to tell
    last = replace(rungs[-1], fit=table.fit("spring"))
    assert [one.sentence for one in find_undetermined((*rungs[:-1], last), None)] == ["a * b"]
    assert find_undetermined(rungs[:1], None) == ()


def alike(monkeypatch, named, *there, errors, arm=False, axis="revolute"):
    """What is said of a named effect, where each set of effects leaves a stated error."""
    table = Table(lambda names: errors[frozenset(names)])
    last = table.fit(named, *there)
    known = {n: EFFECTS[n] for n in ("spring", "gravity", "bias", "cogging")}
    last.model = replace(last.model, known=known, axis=axis)
    monkeypatch.setattr(undetermined_module, "estimate", table.estimate)
    prepared = SimpleNamespace(is_linked=arm)
    return alike_on_records(last, Candidate(EFFECTS[named], "device"), prepared)


LINE = {
    frozenset({"gravity"}): 0.25,
    frozenset({"spring"}): 0.25,
    frozenset({"spring", "bias"}): 0.2501,
    frozenset({"gravity", "bias"}): 0.25,
}


def test_gravity_is_reported_to_look_like_a_spring_with_its_rest_position(monkeypatch):
    sentence = alike(monkeypatch, "gravity", errors=LINE)
    assert "from `spring` and `bias`" in sentence and "25 %" in sentence
    beside = alike(monkeypatch, "gravity", "bias", errors=LINE)
    assert "from `spring`, " in beside, "the constant is there already"
    assert "from `gravity`, " in alike(monkeypatch, "spring", errors=LINE)


def test_effects_that_the_records_distinguish_are_not_reported_to_look_alike(monkeypatch):
    far = {**LINE, frozenset({"spring", "bias"}): 0.4}
    assert alike(monkeypatch, "gravity", errors=far) == ""
    assert alike(monkeypatch, "cogging", errors={frozenset({"cogging"}): 0.25}) == ""
    both = {frozenset({"gravity", "spring"}): 0.25}
    assert alike(monkeypatch, "gravity", "spring", errors=both) == "", "the model has both"


def test_where_gravity_is_no_torque_of_the_axis_a_spring_looks_like_nothing_else(monkeypatch):
    assert alike(monkeypatch, "spring", errors=LINE, axis="prismatic") == ""
    assert alike(monkeypatch, "spring", errors=LINE, arm=True) == "", "the links have it"
