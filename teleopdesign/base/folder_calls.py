"""Folders that can be called: `td.diagnose(experiment)` is `td.find_missing(experiment)`.

`td.NAME` is a folder once a module in the folder is imported, so that no function can have the name
of a folder. A folder named by a verb runs the one function that a user expects. A folder named by a
noun raises an error that lists its functions.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib import import_module
from types import ModuleType
from typing import Any

__all__ = ["VERBS", "let_folders_be_called"]

#: folder named by a verb -> the public function that runs when the folder is called
VERBS = {
    "check": "check_experiment",
    "derive": "derive_transfers",
    "design": "design_compensation",
    "diagnose": "find_missing",
    "simulate": "simulate_diagram",
}
#: folder -> what to type instead, if no single function stands for the folder
INSTEAD = {
    "app": "type `teleopdesign app` in a terminal",
    "realise": "write td.to_iosystem(diagram)",
    "show": "every result draws itself: diagnosis.plot(), study.plot; td.show.save_figure writes",
    "studies": "write td.study(diagram, axes, measures=...)",
    "tuning": "write td.tune(diagram, parameters, objective)",
    "unexplained": "write td.describe(model, experiment)",
    "next_experiment": "write td.propose_experiment(diagnosis)",
}


class _Imported(ModuleType):
    """A module that pickles as its name, so that a script's function that uses it can be sent."""

    def __reduce__(self) -> tuple[Callable[[str], ModuleType], tuple[str]]:
        return import_module, (self.__name__,)


class _Folder(_Imported):
    """A folder whose call runs its function; the function is looked up at the time of the call.

    A public name of the folder stands for its function, also where a module has the same name.
    """

    def __setattr__(self, name: str, value: Any) -> None:
        if type(value) is ModuleType and name in getattr(self, "__all__", ()):
            return
        super().__setattr__(name, value)

    @property
    def __call__(self) -> Any:
        package, _, folder = self.__name__.rpartition(".")
        if folder in VERBS:
            return getattr(import_module(package), VERBS[folder])
        known = ", ".join(f"td.{folder}.{n}" for n in getattr(self, "__all__", ())[:4])
        hint = INSTEAD.get(folder) or f"its functions: {known}, ..."
        raise TypeError(f"td.{folder} is a folder and not callable; {hint}")


class _Package(_Imported):
    """The package; a folder that the import system binds as its attribute becomes a `_Folder`."""

    def __setattr__(self, name: str, value: Any) -> None:
        if type(value) is ModuleType and value.__name__ == f"{self.__name__}.{name}":
            if hasattr(value, "__path__"):
                value.__class__ = _Folder
                for public in getattr(value, "__all__", ()):
                    if type(vars(value).get(public)) is ModuleType:
                        delattr(value, public)
        super().__setattr__(name, value)


def let_folders_be_called(package: str) -> None:
    """From now on the folders of the package can be called, however they are imported.

    package: name of the package, whose module is already imported
    """
    sys.modules[package].__class__ = _Package
