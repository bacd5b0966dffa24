"""Claims about a measured device are about the numbers that are printed, and these are few."""

import json
import re

import pytest

from teleopdesign.cli import main

#: parameters as an estimator leaves them: (value, standard error, unit on a revolute axis)
AS_ESTIMATED = {
    "inertia": (0.0120278431, 3.21e-5, "kg*m^2"),
    "coulomb.level": (0.200348834924, 5.0283e-4, "N*m"),
    "viscous.damping": (0.0501132199, 2.4627e-4, "N*m*s/rad"),
}
STRIBECK = {
    "stribeck.extra_static_level": (0.0482773312, 0.0011234, "N*m"),
    "stribeck.stribeck_velocity": (0.2487123123, 0.0056321, "rad/s"),
}


def answer_with(path, parameters):
    values = {
        f"device.{name}": {"value": value, "stderr": error, "unit": unit}
        for name, (value, error, unit) in parameters.items()
    }
    row = {"added": None, "fit_error": 0.02, "check_error": 0.02}
    content = {
        "verdict": "model_adequate",
        "noise_floor": 0.02,
        "indistinguishable": [],
        "ladder": [row],
        "missing": [],
        "model_parameters": values,
        "candidates": [],
    }
    path.write_text(json.dumps(content))
    return str(path)


@pytest.mark.slow
@pytest.mark.parametrize("more", [{}, STRIBECK])
def test_the_limit_that_is_printed_is_proved_where_it_is_typed(tmp_path, capsys, more):
    """0.19936 was printed as 0.1994, and what is typed so was refuted."""
    answer = answer_with(tmp_path / "answer.json", AS_ESTIMATED | more)
    assert main(["passivity", answer]) == 0
    output = capsys.readouterr().out
    limit = re.search(r"for passivity at every level in the interval: (\S+)", output)[1]
    out = tmp_path / "claims.json"
    assert main(["passivity", answer, "--dahl", limit, "20000", "--json", str(out)]) == 0
    claims = {c["topic"]: c["status"] for c in json.loads(out.read_text())["claims"]}
    assert claims["any law within the level"] == claims["95 % interval"] == "proved"
    assert "refuted" not in claims.values()
