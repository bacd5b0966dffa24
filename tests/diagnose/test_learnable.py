"""What a black box learns from the motion: a law that the model lacks, and no noise."""

from dataclasses import replace

import numpy as np
import pytest

from teleopdesign.diagnose import learnable as module
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.learnable import (
    learnable,
)
from teleopdesign.measurement.prepare import prepare


@pytest.fixture(scope="module", autouse=True)
def whole_black_box(all_trees):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "TREES", all_trees)
        yield


@pytest.fixture(scope="module")
def prepared(experiment):
    return prepare(experiment)


def of_fit_records(prepared):
    """The same without check records."""
    kept = tuple(replace(s, use="fit") for s in prepared.stretches)
    return replace(prepared, stretches=kept)


@pytest.mark.parametrize(
    "records", ["check records", pytest.param("blocks of fit records", marks=pytest.mark.slow)]
)
def test_a_law_that_the_model_lacks_could_be_learned(records, diagnosis, prepared):
    prepared = prepared if records == "check records" else of_fit_records(prepared)
    model = diagnosis.before.model
    learned = learnable(model, prepared)
    # the missing Stribeck effect is most of what is left, and its record repeats it
    assert learned.error < 0.6 * learned.left
    # the error that the diagnosis would say, of these records
    assert learned.left == pytest.approx(estimate(model, prepared).check_error, rel=0.02)
    assert f"{100 * learned.part:.2g} % follows from the motion" in str(learned)


@pytest.mark.slow
def test_of_what_a_right_model_leaves_next_to_nothing_could_be_learned(diagnosis, prepared):
    learned = learnable(diagnosis.after.model, prepared)
    assert learned.left == pytest.approx(diagnosis.after.check_error, rel=0.1)
    # a tenth: trees follow some of the noise of the records that they learn from
    assert learned.error > 0.9 * learned.left


@pytest.mark.slow
def test_a_force_that_does_not_repeat_is_not_learned(diagnosis, prepared):
    rng = np.random.default_rng(0)

    def noisy(s):
        noise = s.motion.lowpassed(rng.normal(0.0, 1.0, len(s.motion.time)))
        force = s.motion.interaction + noise * np.sqrt(s.measured / s.weight / len(s.keep))
        return replace(s, motion=replace(s.motion, interaction=force))

    stretches = tuple(map(noisy, prepared.stretches))
    learned = learnable(diagnosis.after.model, replace(prepared, stretches=stretches))
    assert learned.part < 0.1 * learned.left
