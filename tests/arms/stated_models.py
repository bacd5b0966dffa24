"""The model that an experiment on an arm states, joint by joint, beside its prepared records."""

import teleopdesign as td
from teleopdesign.diagnose.parts import prepare_parts


def stated_models(experiment):
    """Prepared records, and joint -> the model of this joint alone with the first links."""
    prepared, stated = prepare_parts(experiment), td.Model.from_experiment(experiment)
    return prepared, {
        j: td.Model({j: body}, stated.known).with_links(prepared.initial)
        for j, body in stated.bodies.items()
    }
