"""The residual of one body does not depend on parameters of another, and is not computed anew."""

import numpy as np
import pytest
from cases import make_case, write_case

from teleopdesign import Model, load_experiment
from teleopdesign.diagnose.bodies_apart import select_bodies, separate_bodies
from teleopdesign.diagnose.fit import estimate, fit_squares
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
