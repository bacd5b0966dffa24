"""An identified model as a file of a rigid-body simulator: MJCF (MuJoCo) and URDF (ROS, others).

A joint of such a simulator has a Coulomb friction level, viscous damping and a largest motor force;
with MJCF also a spring, an armature (inertia that turns with the joint) and a gain. Other effects
of a model have no place. They are named in a comment of the file, and in `SimulatorFile.left_out`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from xml.etree import ElementTree

from ..base.errors import ModelError, unknown
from ..base.units import unit_after_number
from ..blocks import Body
from ..model import Model

#: kg and kg m^2: least mass and inertia of a link, because simulators refuse less. They do not move
#: with an identified joint
CARRIER_MASS, CARRIER_INERTIA = 1e-6, 1e-9
#: part of the inertia in the link; the rest is the armature. MuJoCo weakens the friction of a joint
#: whose link is light compared with its armature: with a link of 1e-6 kg a slider that should stop
#: in 0.07 s did not stop; with one half, its speed is correct within 0.3 % of the initial speed
LINK_PART = 0.5
#: s, time constant of MuJoCo's friction constraint, and step: four steps to a constant
FRICTION_TIME, STEP = 0.002, 0.0005
#: m or rad, m/s or rad/s, N or N m: limits that URDF demands, far beyond any motion of a record
URDF_TRAVEL, URDF_SPEED, URDF_EFFORT = 1e3, 1e3, 1e6
#: digits of numbers: far more than any estimate has
_DIGITS = 9

#: parameter of a body -> attribute of an MJCF joint that holds it
_MJCF = {
    "coulomb.level": "frictionloss",
    "viscous.damping": "damping",
    "spring.stiffness": "stiffness",
}
#: parameter of a body -> attribute of <dynamics> in URDF that holds it
_URDF = {"coulomb.level": "friction", "viscous.damping": "damping"}
_LIMIT, _GAIN = "actuator_saturation.limit", "actuator_gain.gain"


@dataclass(frozen=True)
class SimulatorFile:
    """The text of a file, and the effects of the model that it cannot hold.

    holds: (parameter, value in SI, unit, attribute in the file);  left_out: effects with their
        place
    """

    text: str
    holds: tuple[tuple[str, float, str, str], ...]
    left_out: tuple[str, ...]


def as_simulator_file(model: Model, form: str, *, name: str = "identified") -> SimulatorFile:
    """The model's bodies as separate joints, each with a motor, without coupling.

    form: a key of `FORMS`;  name: of the model in the file
    raises ModelError: the form is unknown, or an inertia is not positive
    """
    if form not in FORMS:
        raise ModelError(f"export: {unknown('form', form, FORMS)}")
    for place, body in model.bodies.items():
        if not _inertia(body) > 0:
            raise ModelError(
                f"export: {place}.inertia: found {_inertia(body):.3g}, expected more than 0"
            )
    return FORMS[form](model, name)


def _mjcf(model: Model, name: str) -> SimulatorFile:
    root = ElementTree.Element("mujoco", model=name)
    _explain(
        root,
        model,
        "Link and armature share the inertia: take what your own link has off the armature.",
        held=(*_MJCF, _LIMIT, _GAIN),
    )
    # implicit in velocity: damping of a light joint is stiff
    settings = {"gravity": "0 0 0", "integrator": "implicitfast", "timestep": _number(STEP)}
    ElementTree.SubElement(root, "option", settings)
    world = ElementTree.SubElement(root, "worldbody")
    motors = ElementTree.SubElement(root, "actuator")
    holds = []
    for place, body in model.bodies.items():
        slides = body.axis == "prismatic"
        link = ElementTree.SubElement(world, "body", name=place)
        joint = {
            "name": f"{place}_joint",
            "type": "slide" if slides else "hinge",
            "axis": "1 0 0" if slides else "0 0 1",
            "armature": _number((1.0 - LINK_PART) * _inertia(body)),
            "solreffriction": f"{_number(FRICTION_TIME)} 1",
        }
        where = "armature and mass" if slides else "armature and diaginertia"
        holds.append((f"{place}.inertia", _inertia(body), body.unit("inertia"), where))
        for parameter, attribute in _MJCF.items():
            if (value := _value(body, parameter)) is not None:
                joint[attribute] = _number(value)
                holds.append((f"{place}.{parameter}", value, body.unit(parameter), attribute))
        ElementTree.SubElement(link, "joint", joint)
        in_link = LINK_PART * _inertia(body)
        mass, moment = (in_link, CARRIER_INERTIA) if slides else (CARRIER_MASS, in_link)
        moments = " ".join([_number(moment)] * 3)
        ElementTree.SubElement(
            link, "inertial", pos="0 0 0", mass=_number(mass), diaginertia=moments
        )
        motor = {"name": f"{place}_motor", "joint": f"{place}_joint"}
        gain = _value(body, _GAIN)
        if gain is not None:
            motor["gear"] = _number(gain)
            holds.append((f"{place}.{_GAIN}", gain, body.unit(_GAIN), "gear"))
        if (limit := _value(body, _LIMIT)) is not None:
            # MuJoCo limits the force before the gear
            at_motor = limit / abs(gain or 1.0)
            ends = f"{_number(-at_motor)} {_number(at_motor)}"
            motor |= {"forcelimited": "true", "forcerange": ends}
            holds.append((f"{place}.{_LIMIT}", limit, body.unit(_LIMIT), "forcerange"))
        ElementTree.SubElement(motors, "motor", motor)
    return SimulatorFile(_text(root), tuple(holds), _list_left_out(model, (*_MJCF, _LIMIT, _GAIN)))


def _urdf(model: Model, name: str) -> SimulatorFile:
    root = ElementTree.Element("robot", name=name)
    _explain(
        root,
        model,
        "The link has the whole inertia; its travel and speed are not limited by what was seen.",
        held=(*_URDF, _LIMIT),
    )
    ElementTree.SubElement(root, "link", name="base")
    holds = []
    for place, body in model.bodies.items():
        slides = body.axis == "prismatic"
        link = ElementTree.SubElement(root, "link", name=place)
        inertial = ElementTree.SubElement(link, "inertial")
        mass = _inertia(body) if slides else CARRIER_MASS
        moment = CARRIER_INERTIA if slides else _inertia(body)
        ElementTree.SubElement(inertial, "mass", value=_number(mass))
        zero = dict.fromkeys(("ixy", "ixz", "iyz"), "0")
        turns = {axis: _number(moment) for axis in ("ixx", "iyy", "izz")}
        ElementTree.SubElement(inertial, "inertia", zero | turns)
        where = "mass" if slides else "inertia izz"
        holds.append((f"{place}.inertia", _inertia(body), body.unit("inertia"), where))
        kind = "prismatic" if slides else "revolute"
        joint = ElementTree.SubElement(root, "joint", name=f"{place}_joint", type=kind)
        ElementTree.SubElement(joint, "parent", link="base")
        ElementTree.SubElement(joint, "child", link=place)
        ElementTree.SubElement(joint, "axis", xyz="1 0 0" if slides else "0 0 1")
        dynamics = {}
        for parameter, attribute in _URDF.items():
            if (value := _value(body, parameter)) is not None:
                dynamics[attribute] = _number(value)
                holds.append((f"{place}.{parameter}", value, body.unit(parameter), attribute))
        ElementTree.SubElement(joint, "dynamics", dynamics)
        limit = _value(body, _LIMIT)
        if limit is not None:
            holds.append((f"{place}.{_LIMIT}", limit, body.unit(_LIMIT), "limit effort"))
        limits = {
            "lower": _number(-URDF_TRAVEL),
            "upper": _number(URDF_TRAVEL),
            "velocity": _number(URDF_SPEED),
            "effort": _number(URDF_EFFORT if limit is None else limit),
        }
        ElementTree.SubElement(joint, "limit", limits)
    return SimulatorFile(_text(root), tuple(holds), _list_left_out(model, (*_URDF, _LIMIT)))


def _inertia(body: Body) -> float:
    return float(body.parameters["inertia"].value)


def _value(body: Body, parameter: str) -> float | None:
    """A parameter's value; None where the body lacks the effect, or it is absent."""
    effect, _, local_name = parameter.partition(".")
    if parameter not in body.parameters:
        return None
    value = float(body.parameters[parameter].value)
    return None if value == body.effect(effect).absent.get(local_name) else value


def _list_left_out(model: Model, held: tuple[str, ...]) -> tuple[str, ...]:
    there = {parameter.partition(".")[0] for parameter in held}
    return tuple(f"{name} at {place}" for name, place in model.effects if name not in there)


def _explain(
    root: ElementTree.Element, model: Model, of_form: str, *, held: tuple[str, ...]
) -> None:
    """Put a comment first: the model's parameters, and the effects that the format cannot hold."""
    lines = [
        f"{n} = {v.value:.5g}{unit_after_number(model.unit(n))}"
        for n, v in model.parameters.items()
    ]
    left = ", ".join(_list_left_out(model, held)) or "nothing"
    text = (
        f" Identified by teleopdesign; SI units.\n  {of_form}\n  "
        + "\n  ".join(lines)
        + f"\n  Left out, for this format has no place for it: {left}. "
    )
    # "--" must not stand in a comment of XML
    root.append(ElementTree.Comment(text.replace("--", "- -")))


def _number(value: float) -> str:
    return f"{value:.{_DIGITS}g}"


def _text(root: ElementTree.Element) -> str:
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


#: form -> what writes it
FORMS: Mapping[str, Callable[[Model, str], SimulatorFile]] = {"mjcf": _mjcf, "urdf": _urdf}
#: form -> ending of its file
ENDINGS = {"mjcf": ".xml", "urdf": ".urdf"}
