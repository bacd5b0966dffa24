"""A function or method is named by what it does or gives, never by a participle alone."""

import ast
import re

import pytest
from syntax_trees import PACKAGE, syntax_trees

#: laws and parts of laws, in the words of their equations; a file that a generator writes
LAWS = re.compile(r"(effects|controllers)/(of_blocks/)?[a-z0-9_]+\.py$")
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
#: methods whose participle is a term that is in use: an effect named by its file, a parameter as
#: declared, a motion below the bandwidth, parts of a polynomial of the checker, a sampled law
METHODS = set(
    "carried cleared declared divided halved lowpassed named needed observed raised sampled".split()
)
#: of iterators and readers
NEXT = "next"


def is_misnamed(name):
    words = name.strip("_").split("_")
    if len(words) > 1:
        return words[0] in PLACES and not name.strip("_").startswith(CONVERSIONS)
    return is_grammar(name) or words[0] in PLACES


def is_grammar(name):
    """Whether the whole name is a participle, or a word that says nothing by itself."""
    word = name.strip("_")
    if "_" in word:
        return False
    return (word.endswith("ed") and word not in NOUNS_IN_ED) or word in ALONE


def test_no_function_is_named_by_a_participle_or_a_place_alone():
    wrong = []
    for path, tree in syntax_trees().items():
        where = path.relative_to(PACKAGE).as_posix()
        for node in tree.body:
            if isinstance(node, ast.FunctionDef) and is_misnamed(node.name):
                wrong.append(f"{where}: {node.name}")
    assert [w for w in wrong if not LAWS.match(w.split(":")[0])] == []


def methods():
    """Module and name of the methods of the package; properties are values, not functions."""
    for path, tree in syntax_trees().items():
        for node in (n for n in ast.walk(tree) if isinstance(n, ast.ClassDef)):
            for one in node.body:
                if isinstance(one, ast.FunctionDef) and not any(
                    "property" in ast.unparse(d) for d in one.decorator_list
                ):
                    yield path.relative_to(PACKAGE).as_posix(), one.name


@pytest.mark.slow
def test_no_method_is_named_by_a_participle_alone():
    """A place may stand alone: what it leads to follows, as in `two_port.over(frequency)`."""
    names = {name for _, name in methods()}
    wrong = {f"{w}: {n}" for w, n in methods() if is_grammar(n) and n not in METHODS | {NEXT}}
    assert wrong == set()
    assert METHODS <= names
