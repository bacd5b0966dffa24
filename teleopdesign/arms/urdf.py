"""Arms from URDF, the usual format of robot descriptions: kinematics and inertial values.

Links are read with their inertial values, joints with their origin, axis and kind. Meshes, limits,
transmissions and additions of simulators are ignored. A file is data: a file that declares entities
is refused, and so is a file larger than any robot needs.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..base.errors import ExperimentError, did_you_mean, quote
from ..base.files import read_whole
from .chain import Array, Chain, Link, express_in_frame, inertia_about, rotation_of, tensor

#: most bytes of a file, elements, and depth of elements: a hundred times what a large robot needs
LARGEST, ELEMENTS, DEPTH = 20_000_000, 200_000, 64
#: joints that move along one axis, and those that never move
_KINDS = {"revolute": "revolute", "continuous": "revolute", "prismatic": "prismatic"}
_FIXED = "fixed"


@dataclass(frozen=True)
class _Joint:
    name: str
    kind: str
    parent: str
    child: str
    axis: Array
    rotation: Array
    origin: Array


@dataclass(frozen=True)
class _Robot:
    """The content of a file: link -> its inertial parameters (10,), and joints."""

    file: str
    links: dict[str, Array]
    joints: tuple[_Joint, ...]


def read_urdf(path: Path, file: str, joints: Sequence[str]) -> Chain:
    """The arm in a robot's description.

    file: its name in messages;  joints: names of the moving joints, from the base to the tip
    Links on other joints are part of the link that carries them, with these joints at zero.
    raises ExperimentError: the file is unreadable or invalid, or the joints are no chain in it
    """
    robot = _robot(_root(path, file), file)
    chain = _chain(robot, joints)
    moving = {j.name for j in chain}
    links = []
    before = chain[0].parent if chain else ""
    for joint in chain:
        rotation, origin = _locate_parent(robot, before, joint)
        links.append(
            Link(
                name=joint.child,
                joint=joint.name,
                kind=_KINDS[joint.kind],
                axis=joint.axis,
                rotation=rotation @ joint.rotation,
                origin=origin + rotation @ joint.origin,
                inertial=_inertia_with_children(robot, joint.child, moving),
            )
        )
        before = joint.child
    return Chain(tuple(links))


class _Counted(ET.TreeBuilder):
    """A builder of XML trees of limited depth and size."""

    def __init__(self) -> None:
        super().__init__()
        self.depth = self.count = 0

    def start(self, tag, attrs, /):  # type: ignore[no-untyped-def]
        self.depth += 1
        self.count += 1
        if self.depth > DEPTH or self.count > ELEMENTS:
            raise ValueError("more elements, or elements nested deeper, than a robot has")
        return super().start(tag, attrs)

    def end(self, tag, /):  # type: ignore[no-untyped-def]
        self.depth -= 1
        return super().end(tag)


def _root(path: Path, file: str) -> ET.Element:
    try:
        if path.stat().st_size > LARGEST:
            raise ExperimentError(f"{file}: found more than {LARGEST} bytes, expected a URDF")
        data = read_whole(path, largest=LARGEST)
    except OSError as problem:
        raise ExperimentError(f"{file}: cannot be read: {problem.strerror}") from None
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        raise ExperimentError(f"{file}: not UTF-8 text (byte {problem.start})") from None
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise ExperimentError(f"{file}: found a document type, expected a URDF without one")
    try:
        parser = ET.XMLParser(target=_Counted())
        parser.feed(text)
        root = parser.close()
    except (ET.ParseError, ValueError) as problem:
        raise ExperimentError(f"{file}: not valid XML: {problem}") from None
    if not isinstance(root, ET.Element) or root.tag != "robot":
        tag = quote(root.tag) if isinstance(root, ET.Element) else "nothing"
        raise ExperimentError(f'{file}: found {tag} at the top, expected "robot" of a URDF')
    return root


def _robot(root: ET.Element, file: str) -> _Robot:
    links: dict[str, Array] = {}
    for element in root.findall("link"):
        name = _name(element, file, "link")
        if name in links:
            raise ExperimentError(f"{file}: link {quote(name)} is given twice")
        links[name] = _inertial(element, f"{file}: link {quote(name)}")
    joints = [
        _joint(element, file, links)
        for element in root.findall("joint")
        if element.find("parent") is not None or element.find("child") is not None
    ]
    for one in ("name", "child"):
        names: set[str] = set()
        for joint in joints:
            word = getattr(joint, one)
            if word in names:
                what = "joint" if one == "name" else "link"
                problem = "is given twice" if one == "name" else "hangs on two joints"
                raise ExperimentError(f"{file}: {what} {quote(word)} {problem}")
            names.add(word)
    return _Robot(file, links, tuple(joints))


def _name(element: ET.Element, file: str, what: str) -> str:
    name = element.get("name", "").strip()
    if not name:
        raise ExperimentError(f"{file}: found a {what} without a name")
    return name


def _inertial(link: ET.Element, where: str) -> Array:
    """Inertial parameters (10,) of a link about its frame; zeros where it has none."""
    element = link.find("inertial")
    if element is None:
        return np.zeros(10)
    rotation, centre = _origin(element, f"{where}: inertial")
    mass_of, moments_of = element.find("mass"), element.find("inertia")
    mass = 0.0 if mass_of is None else _numbers(mass_of, "value", 1, f"{where}: mass")[0]
    if mass < 0:
        raise ExperimentError(f"{where}: mass: found {mass:g}, expected 0 or more")
    if moments_of is None:
        return inertia_about(mass, centre, np.zeros((3, 3)))
    values = {
        n: float(_numbers(moments_of, n, 1, f"{where}: inertia", default="0")[0])
        for n in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    }
    about = tensor(np.array(list(values.values())))
    return inertia_about(float(mass), centre, rotation @ about @ rotation.T)


def _joint(element: ET.Element, file: str, links: dict[str, Array]) -> _Joint:
    name = _name(element, file, "joint")
    where = f"{file}: joint {quote(name)}"
    kind = element.get("type", "")
    ends = []
    for end in ("parent", "child"):
        part = element.find(end)
        link = "" if part is None else part.get("link", "")
        if link not in links:
            raise ExperimentError(
                f"{where}: {end}: no link {quote(link)}{did_you_mean(link, links)}"
            )
        ends.append(link)
    axis = np.array([1.0, 0.0, 0.0])
    rotation, origin = _origin(element, where)
    if (axis_element := element.find("axis")) is not None:
        axis = _numbers(axis_element, "xyz", 3, f"{where}: axis", default="1 0 0")
    size = float(np.linalg.norm(axis))
    if kind in _KINDS and not size > 0:
        raise ExperimentError(f"{where}: axis: found 0 0 0, expected a direction")
    return _Joint(name, kind, ends[0], ends[1], axis / (size or 1.0), rotation, origin)


def _origin(element: ET.Element, where: str) -> tuple[Array, Array]:
    """Rotation and origin of an element's `origin`; identity and zero where it has none."""
    origin = element.find("origin")
    if origin is None:
        return np.eye(3), np.zeros(3)
    xyz = _numbers(origin, "xyz", 3, f"{where}: origin", default="0 0 0")
    rpy = _numbers(origin, "rpy", 3, f"{where}: origin", default="0 0 0")
    return rotation_of(*rpy.tolist()), xyz


def _numbers(
    element: ET.Element, key: str, count: int, where: str, default: str | None = None
) -> Array:
    text = element.get(key, default)
    expected = "a finite number" if count == 1 else f"{count} finite numbers"
    if text is None:
        raise ExperimentError(f"{where}: no {quote(key)}, expected {expected}")
    words = text.split()
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        numbers = []
    if len(numbers) != count or not all(math.isfinite(x) for x in numbers):
        raise ExperimentError(f"{where}: {key}: found {quote(text)}, expected {expected}")
    return np.array(numbers)


def _chain(robot: _Robot, joints: Sequence[str]) -> list[_Joint]:
    """The moving joints, from the base to the tip.

    raises ExperimentError: unknown or fixed joints, or no chain
    """
    by_name = {j.name: j for j in robot.joints}
    for name in joints:
        if name not in by_name:
            raise ExperimentError(
                f"{robot.file}: no joint {quote(name)}{did_you_mean(name, by_name)}"
            )
        if by_name[name].kind not in _KINDS:
            raise ExperimentError(
                f"{robot.file}: joint {quote(name)}: found {quote(by_name[name].kind)}, expected "
                f"{', '.join(_KINDS)}"
            )
    carrier = {j.child: j for j in robot.joints}
    chain: list[_Joint] = []
    link, wanted = by_name[joints[-1]].child, set(joints)
    for _ in range(len(robot.joints)):
        joint = carrier.get(link)
        if joint is None:
            break
        if joint.name in wanted:
            chain.insert(0, joint)
        elif joint.kind != _FIXED and wanted - {j.name for j in chain}:
            raise ExperimentError(
                f"{robot.file}: joint {quote(joint.name)} moves the arm too: expected it among "
                "[model.arm.joints]"
            )
        link = joint.parent
    order = [j.name for j in chain]
    if order != list(joints):
        raise ExperimentError(
            f"{robot.file}: found {', '.join(joints)}, expected joints of one chain from the base "
            f"to the tip{': ' + ', '.join(order) if len(order) == len(joints) else ''}"
        )
    return chain


def _locate_parent(robot: _Robot, frame: str, joint: _Joint) -> tuple[Array, Array]:
    """Rotation and origin of a joint's parent link, in the frame of a link that carries it."""
    carrier = {j.child: j for j in robot.joints}
    rotation, origin, link = np.eye(3), np.zeros(3), joint.parent
    while link != frame:
        there = carrier[link]
        rotation, origin = there.rotation @ rotation, there.origin + there.rotation @ origin
        link = there.parent
    return rotation, origin


def _inertia_with_children(robot: _Robot, link: str, moving: set[str]) -> Array:
    """Inertial parameters (10,) of a link with all links on it whose joints do not move."""
    whole = np.zeros(10)
    waiting = [(link, np.eye(3), np.zeros(3))]
    while waiting:
        name, rotation, origin = waiting.pop()
        whole = whole + express_in_frame(robot.links[name], rotation, origin)
        waiting += [
            (j.child, rotation @ j.rotation, origin + rotation @ j.origin)
            for j in robot.joints
            if j.parent == name and j.name not in moving
        ]
    return whole
