"""What the answer file must hold, by the published format."""

import math

PLACE = ("effect", "at")
LADDER = {
    "added", "instead_of", "fit_error", "check_error", "check_error_at_command", "blind",
    "could_be",
}  # fmt: skip
CANDIDATE = {
    "effect", "at", "probability", "check_error", "check_error_at_command", "blind", "refused",
    "parameters",
}  # fmt: skip
VERDICTS = ("effects_missing", "model_adequate", "undecided")


def is_number(x, low=-math.inf, high=math.inf):
    return isinstance(x, int | float) and not isinstance(x, bool) and low <= x <= high


def place_of(entry):
    """An entry of `missing` as effect and place alone."""
    return {k: entry.get(k) for k in PLACE}


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
    need(all(is_place(place_of(d)) for d in missing), "missing: an entry is no effect at a place")
    need(all(set(d) <= {*PLACE, "instead_of"} for d in missing), "missing: keys of an entry")
    replacements = {(d["effect"], d["at"]): d.get("instead_of") for d in missing}
    need(bool(missing) == (verdict == "effects_missing"), "verdict and missing disagree")
    keys = [(d["effect"], d["at"]) for d in missing]
    need(len(set(keys)) == len(keys), "missing: the same effect twice")
    need(len(ladder) >= 1 and ladder[0]["added"] is None, "ladder: begins with the user's model")
    for row in ladder:
        need(set(row) >= LADDER, "ladder: keys of a row")
        need(row["added"] is None or is_place(row["added"]), "ladder: added")
        instead = row["instead_of"]
        need(instead is None or isinstance(instead, str), "ladder: instead_of")
        if row["added"] is not None:
            key = row["added"]["effect"], row["added"]["at"]
            need(replacements.get(key, instead) == instead, "missing: instead_of")
        others = row["could_be"]
        need(others is None or all(map(is_place, others)), "ladder: could_be")
        need(is_number(row["fit_error"], 0, 1e6), "ladder: fit_error")
        need(is_number(row["check_error"], 0, 1e6), "ladder: check_error")
        error_at_command = row["check_error_at_command"]
        need(
            error_at_command is None or is_number(error_at_command, 0, 1e6),
            "ladder: check_error_at_command",
        )
        need(is_number(row["blind"], 0, 1), "ladder: blind")
    errors = [row["check_error"] for row in ladder]
    need(errors == sorted(errors, reverse=True), "ladder: a rung leaves more than the one before")
    need(answer["blind"] == ladder[-1]["blind"], "blind")
    added = [row["added"] for row in ladder[1:]]
    named = [place_of(d) for d in missing]
    need(all(d in added for d in named), "missing: what the ladder has not added")
    chances = {(c["effect"], c["at"]): c["probability"] for c in answer["candidates"]}
    need(all(chances[key] >= 0.5 for key in keys), "missing: less likely than not")
    likely = [d for d in added if chances[d["effect"], d["at"]] >= 0.5]
    need(named == likely or verdict == "undecided", "missing: a likely one is left out")
    for row in ladder[1:]:
        same = [c for c in answer["candidates"] if row["added"] == {k: c[k] for k in PLACE}]
        need(
            all(c["check_error"] == row["check_error"] for c in same),
            "one model, two errors: " + str(row["added"]),
        )
    need(is_number(answer["noise_floor"], 0, 1e6), "noise_floor")
    probabilities = [c["probability"] for c in answer["candidates"]]
    need(all(is_number(p, 0, 1) for p in probabilities), "candidates: probability")
    need(probabilities == sorted(probabilities, reverse=True), "candidates: best first")
    for c in answer["candidates"]:
        need(set(c) >= CANDIDATE, "candidate")
        need(c["refused"] is None or isinstance(c["refused"], str), "candidate: refused")
        need(is_place({"effect": c["effect"], "at": c["at"]}), "candidate: place")
        need(c["parameters"] and are_parameters(c["parameters"]), "candidate: parameters")
    for group in answer["indistinguishable"]:
        need(len(group) > 1 and all(map(is_place, group)), "indistinguishable")
    need(are_parameters(answer["model_parameters"]), "model_parameters")
    need("device.inertia" in answer["model_parameters"] or "device" not in places, "inertia")
    need(answer["check"] in ("records", "blocks of fit"), "check")
    return wrong
