"""What the answer file must hold, by the published format."""

import math

VERDICTS = ("effects_missing", "model_adequate", "undecided")


def is_number(x, low=-math.inf, high=math.inf):
    return isinstance(x, int | float) and not isinstance(x, bool) and low <= x <= high


def violations(answer, places=("device",)):
    """Every way in which an answer breaks the format, as text."""
    wrong = []

    def need(holds, text):
        if not holds:
            wrong.append(text)

    def is_place(d):
        return set(d) == {"effect", "at"} and isinstance(d["effect"], str) and d["at"] in places

    def are_parameters(parameters):
        return all(
            set(p) == {"value", "stderr", "unit"}
            and (p["value"] is None or is_number(p["value"]))
            and (p["stderr"] is None or is_number(p["stderr"], 0))
            and isinstance(p["unit"], str)
            for p in parameters.values()
        )

    verdict, missing, ladder = answer["verdict"], answer["missing"], answer["ladder"]
    need(verdict in VERDICTS, f"verdict {verdict!r}")
    need(all(map(is_place, missing)), "missing: an entry is no effect at a place")
    need(bool(missing) == (verdict == "effects_missing"), "verdict and missing disagree")
    keys = [(d["effect"], d["at"]) for d in missing]
    need(len(set(keys)) == len(keys), "missing: the same effect twice")
    need(len(ladder) >= 1 and ladder[0]["added"] is None, "ladder: begins with the user's model")
    for row in ladder:
        need(set(row) == {"added", "fit_error", "check_error"}, "ladder: keys of a row")
        need(row["added"] is None or is_place(row["added"]), "ladder: added")
        need(is_number(row["fit_error"], 0, 1e6), "ladder: fit_error")
        need(is_number(row["check_error"], 0, 1e6), "ladder: check_error")
    need(
        all(r["added"] in missing for r in ladder[1:]) or verdict == "undecided", "ladder, missing"
    )
    need(is_number(answer["noise_floor"], 0, 1e6), "noise_floor")
    probabilities = [c["probability"] for c in answer["candidates"]]
    need(all(is_number(p, 0, 1) for p in probabilities), "candidates: probability")
    need(probabilities == sorted(probabilities, reverse=True), "candidates: best first")
    for c in answer["candidates"]:
        need(set(c) == {"effect", "at", "probability", "check_error", "parameters"}, "candidate")
        need(is_place({"effect": c["effect"], "at": c["at"]}), "candidate: place")
        need(c["parameters"] and are_parameters(c["parameters"]), "candidate: parameters")
    for group in answer["indistinguishable"]:
        need(len(group) > 1 and all(map(is_place, group)), "indistinguishable")
    need(are_parameters(answer["model_parameters"]), "model_parameters")
    need("device.inertia" in answer["model_parameters"] or "device" not in places, "inertia")
    need(answer["check"] in ("records", "blocks of fit"), "check")
    return wrong
