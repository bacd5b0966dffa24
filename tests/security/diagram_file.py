"""A diagram's file of which any name may be another, and what a test of it asks of an answer."""

from security.hostile import quoted


def one_line(error):
    assert str(error).isprintable() and len(str(error)) < 1000
    return str(error)


#: where a name stands in a diagram's file; the same name at all places is one wiring
NAMES = {
    "title": "one body",
    "outside": "f",
    "motion": "x",
    "command": "u",
    "reaction": "f_k",
    "arm": "g",
    "place": "k",
    "body": "M",
    "spring": "Z",
    "law": "C",
}


def diagram_file(**names):
    """A diagram with everything that a file may hold, under these names."""
    n = {key: quoted(name) for key, name in {**NAMES, **names}.items()}
    return f"""\
[diagram]
name = {n["title"]}
measured = [{n["motion"]}]
[outside]
{n["outside"]} = "force"
[blocks.{n["body"]}]
kind = "moving"
motion = {n["motion"]}
command = {n["command"]}
loads = {{ {n["outside"]} = 1, {n["reaction"]} = 1, {n["arm"]} = 1 }}
driver = {n["outside"]}
axis = "prismatic"
inertia = 0.15
[blocks.{n["body"]}.effects.viscous]
damping = 2.0
[blocks.{n["spring"]}]
kind = "attached"
motion = {n["motion"]}
force = {n["reaction"]}
axis = "prismatic"
inertia = 0.1
[blocks.{n["law"]}]
kind = "control"
input = {n["motion"]}
output = {n["command"]}
motion = {n["motion"]}
law = "spring_damper"
parameters = {{ stiffness = -10, damping = -1 }}
[kinematics]
{n["place"]} = {quoted("0.1*sin(x)") if n["motion"] == '"x"' else quoted("0.5")}
[junctions]
{n["arm"]} = {{ {n["outside"]} = 0.5 }}
[pose]
{n["motion"]} = 0.1
[texts]
{n["motion"]} = {n["title"]}
"""
