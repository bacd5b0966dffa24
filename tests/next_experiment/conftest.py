"""The diagnosis that tests of `diagnose` make is held open here."""

from diagnose.conftest import diagnosis, end, experiment, first, search, stribeck_case

__all__ = ["diagnosis", "end", "experiment", "first", "search", "stribeck_case"]
