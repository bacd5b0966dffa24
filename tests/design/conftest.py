"""Experiment and model that several tests here share."""

import pytest

import teleopdesign as td
from teleopdesign.blocks import Value
from teleopdesign.design import prediction, verdict
from teleopdesign.diagnose import Diagnosis, LadderRow
from teleopdesign.diagnose.noise_floor import NoiseFloor
from teleopdesign.diagnose.recording import DiagnosedRecording

#: what a diagnosis of the rod ends with, rounded: value and standard error
ROD = {
    "device.inertia": (0.198, 4e-4),
    "device.coulomb.level": (0.548, 5e-4),
    "device.viscous.damping": (1.84, 4e-3),
    "device.stribeck.extra_static_level": (0.197, 4e-3),
    "device.stribeck.stribeck_velocity": (0.0225, 3e-4),
}


@pytest.fixture(scope="session", autouse=True)
def few_motions():
    """A design looks at fewer motions, the ends of the grid among them: half of its time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(verdict, "SIZES", (0.1, 1.0))
        patch.setattr(verdict, "FREQUENCIES", (1.0, 3.0, 30.0))
        patch.setattr(prediction, "MULTIPLES", (1.0, 10.0))
        yield


@pytest.fixture(scope="session")
def experiment():
    return td.load_experiment(td.example("rod"))


@pytest.fixture(scope="session")
def rod(experiment):
    """The rod as a diagnosis leaves it, with Stribeck friction."""
    model = td.Model.from_experiment(experiment).with_effect("stribeck")
    model = model.with_values({n: Value(v, stderr=e) for n, (v, e) in ROD.items()})
    row = LadderRow(None, 0.0105, 0.0105, model, 0.0, check_error_at_command=0.0105)
    floor = NoiseFloor(0.01, "stated", drawn=0.01)
    recording = DiagnosedRecording(stated=experiment)
    return Diagnosis("effects_missing", (row,), floor, (), (), recording=recording)


@pytest.fixture(scope="session")
def designed(rod):
    """The design for it."""
    from teleopdesign.design import design

    return design(rod)


@pytest.fixture(scope="session")
def unsure(rod):
    """The design for the rod if its Coulomb level were hardly known."""
    from teleopdesign.design import design

    level = {"device.coulomb.level": Value(0.548, stderr=0.3)}
    return design(rod.with_final_model(rod.model.with_values(level)))
