"""The diagnosis that tests of `diagnose` make is held open here."""

from diagnose.conftest import diagnosis, experiment, stribeck_case

__all__ = ["diagnosis", "experiment", "stribeck_case"]
