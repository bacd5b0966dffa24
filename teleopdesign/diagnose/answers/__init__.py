"""Answer files, read back: the model that a diagnosis ended with, or the diagnosis itself.

saved = load_answer("answer.json")
saved.model(catalogue(effect_files), experiment)    # with its axes, environment and users' effects
restored(saved, experiment, known)                  # a Diagnosis: nothing is sought anew

`diagnose.answer` writes them, with the words on models and experiment by `bodies` and
`fingerprint` here.
"""

from .restored import restore_diagnosis
from .saved import SavedAnswer, load_answer

__all__ = ["SavedAnswer", "load_answer", "restore_diagnosis"]
