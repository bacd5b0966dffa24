"""Answer files, read back: the model that a diagnosis ended with, or the diagnosis itself.

    saved = load_answer("answer.json")
    saved.model(catalogue(effect_files), experiment)  # with axes, environment and users' effects
    restore_diagnosis(saved, experiment, known)       # a Diagnosis: nothing is searched again

`diagnose.answer` writes answer files; `bodies` and `fingerprint` here describe the models and the
experiment in them.
"""

from .restored import restore_diagnosis
from .saved import SavedAnswer, load_answer

__all__ = ["SavedAnswer", "load_answer", "restore_diagnosis"]
