"""A function is named by what it does or gives, never by a participle or a place alone."""

import ast
import re
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "teleopdesign"
#: laws and parts of laws, in the words of their equations; a file that a generator writes
LAWS = re.compile(r"(effects|controllers)/[a-z0-9_]+\.py$|realise/_free_mass.py$")
PLACES = """
    above across after against along among around at before behind below beside between
    beyond by from in inside of off on once out over per since through till toward under
    until upon via with within without
""".split()
#: what stands alone and says nothing; before a noun it may: `other_values`
ALONE = """
    all any bare begun built done drawn driven each felt given gone held hidden kept
    known led left lost made meant met near next nothing only other others outside paid
    said same seen sent shown so spoken stuck taken told understood written
""".split()
NOUNS_IN_ED = {"bed", "feed", "need", "seed", "speed"}
#: they begin the name of a conversion or of a changed copy: `from_control`, `with_shift`
CONVERSIONS = ("as_", "from_", "in_", "of_", "on_", "to_", "with_", "without_")


def is_misnamed(name):
    words = name.strip("_").split("_")
    if len(words) > 1:
        return words[0] in PLACES and not name.strip("_").startswith(CONVERSIONS)
    word = words[0]
    participle = word.endswith("ed") and word not in NOUNS_IN_ED
    return participle or word in PLACES or word in ALONE


@pytest.mark.parametrize("name", ["found_by", "_kept", "along", "over_frequency", "restored"])
def test_the_rule_knows_what_it_forbids(name):
    assert is_misnamed(name) == (name != "found_by")


def test_no_function_is_named_by_a_participle_or_a_place_alone():
    wrong = []
    for path in sorted(PACKAGE.rglob("*.py")):
        where = path.relative_to(PACKAGE).as_posix()
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.FunctionDef) and is_misnamed(node.name):
                wrong.append(f"{where}: {node.name}")
    assert [w for w in wrong if not LAWS.match(w.split(":")[0])] == []
