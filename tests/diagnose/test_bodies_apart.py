"""The residual of one body does not depend on parameters of another, and is not computed anew."""

from dataclasses import replace

import numpy as np
import pytest
from cases import make_case, write_case

from teleopdesign import Model, load_experiment
from teleopdesign.diagnose import bodies_apart
from teleopdesign.diagnose.bodies_apart import BodyByBody, select_bodies, separate_bodies
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.effort import EFFORTS
from teleopdesign.diagnose.fit import estimate, fit_squares
from teleopdesign.diagnose.promise import Promises
from teleopdesign.diagnose.rank import rank_candidates
from teleopdesign.effects import EFFECTS
from teleopdesign.measurement.prepare import prepare


@pytest.fixture(scope="module")
def two_bodies(tmp_path_factory):
    """Prepared records of a teleoperator from which nothing is missing, and the user's model."""
    folder = tmp_path_factory.mktemp("apart") / "case"
    write_case(make_case(np.random.default_rng(3), "null", kind="teleoperator"), folder)
    experiment = load_experiment(folder)
    return prepare(experiment), Model.from_experiment(experiment)


def test_what_one_body_leaves_does_not_depend_on_the_parameters_of_another(two_bodies):
    prepared, model = two_bodies
    stretches = prepared.of("fit")
    names = tuple(n for n, v in model.parameters.items() if not v.fixed)
    whole = select_bodies(stretches, ("master", "slave")).relative(model, names)
    assert sorted(r for part in separate_bodies(stretches) for r in part.rows) == list(
        range(len(whole[0]))
    )
    for part in separate_bodies(stretches):
        (body,) = part.bodies
        mine = [i for i, n in enumerate(names) if model.locate(n)[0] == body]
        left, slopes = part.relative(model, [names[i] for i in mine])
        assert left == pytest.approx(whole[0][part.rows], rel=1e-12)
        assert slopes == pytest.approx(whole[1][np.ix_(part.rows, mine)], rel=1e-9, abs=1e-12)
        others = np.delete(whole[1][part.rows], mine, axis=1)
        assert others.size and not others.any()


def test_a_fit_that_follows_tangents_ends_where_one_that_computes_all_again_does(
    two_bodies, monkeypatch
):
    prepared, stated = two_bodies
    there = estimate(stated, prepared).model
    values = {n: 1.2 * v.value for n, v in there.parameters.items() if not v.fixed}
    moved = there.with_values({n: v for n, v in values.items() if n.startswith("slave.")})
    computed = []
    relative = bodies_apart.Apart.relative

    def counted(part, *arguments):
        computed.extend(part.bodies)
        return relative(part, *arguments)

    monkeypatch.setattr(bodies_apart.Apart, "relative", counted)
    for effort in (EFFORTS.rough, EFFORTS.fine):
        computed.clear()
        followed = estimate(moved, prepared, effort=effort)
        assert computed.count("master") < computed.count("slave")
        with monkeypatch.context() as patch:
            patch.setattr(bodies_apart, "EFFORTS", replace(EFFORTS, followed=0.0))
            again = estimate(moved, prepared, effort=effort)
        for name in followed.free:
            one, other = (f.model.parameters[name] for f in (followed, again))
            # far below what is said of the estimate; a rough fit ends anywhere within its tolerance
            assert abs(one.value - other.value) < 0.05 * other.stderr, name


def test_a_residual_without_derivatives_is_the_same_near_and_far(two_bodies):
    """A body that hardly moved follows tangents, whichever was computed last."""
    prepared, model = two_bodies
    names = ("slave.inertia", "master.inertia")
    before = np.array([model.parameters[n].value for n in names])
    courses = []
    for without in (False, True):
        bodies = BodyByBody(model, names, prepared.of("fit"), tolerance=1e-4)
        left = []
        for by in ((1.0, 1.0), (1.3, 1.0), (1.3, 1.0 + 1e-6), (1.1, 1.0 + 1e-6)):
            moved = model.with_values(dict(zip(names, before * by, strict=True)))
            point = np.array(by), before
            if without and by != (1.0, 1.0):
                left.append(bodies.residual(moved, *point))
            else:
                left.append(bodies.both(moved, *point)[0])
        courses.append([*left, bodies.both(moved, *point)[1]])
    for one, other in zip(*courses, strict=True):
        assert other == pytest.approx(one, rel=1e-9, abs=1e-12)


def test_starts_that_differ_at_one_body_compute_the_other_once(two_bodies, monkeypatch):
    prepared, model = two_bodies
    base, computed = estimate(model, prepared, effort=EFFORTS.first_steps), []
    starts = [
        base.model.with_values({"slave.inertia": f * base.model.parameters["slave.inertia"].value})
        for f in (1.0, 1.1, 1.2, 1.1)
    ]
    relative = bodies_apart.Apart.relative

    def counted(part, *arguments):
        computed.extend(part.bodies)
        return relative(part, *arguments)

    monkeypatch.setattr(bodies_apart.Apart, "relative", counted)
    promises = Promises(prepared, base)
    squares = [promises.squares(start) for start in starts[1:]]
    assert (computed.count("master"), computed.count("slave")) == (1, 2)
    assert squares[0] == squares[2] == Promises(prepared, base).squares(starts[1])


def test_what_is_gained_at_one_body_does_not_depend_on_effects_at_another(two_bodies):
    """So effects of two bodies cannot mask each other: a pair is sought at one body alone."""
    prepared, model = two_bodies
    base = estimate(model, prepared)
    alone, beside = (
        fit_squares(estimate(there, prepared)) - fit_squares(estimate(here, prepared))
        for here, there in [
            (model, model.with_effect("bias", at="slave")),
            (
                model.with_effect("spring", at="master"),
                model.with_effect("spring", at="master").with_effect("bias", at="slave"),
            ),
        ]
    )
    assert beside == pytest.approx(alone, abs=1e-6 * fit_squares(base))


def test_a_ranking_at_one_body_has_its_candidates_alone(two_bodies):
    prepared, model = two_bodies
    base = estimate(model, prepared)
    some = [Candidate(EFFECTS[n], at) for n in ("bias", "spring") for at in ("master", "slave")]
    both = rank_candidates(base, prepared, among=some)
    there = rank_candidates(base, prepared, among=some, body="slave")
    mine = [r for r in both.ranked if r.candidate.at == "slave"]
    assert [r.candidate.key for r in there.ranked] == [r.candidate.key for r in mine]
    assert [fit_squares(r.fit) for r in there.ranked] == pytest.approx(
        [fit_squares(r.fit) for r in mine], rel=1e-9
    )
