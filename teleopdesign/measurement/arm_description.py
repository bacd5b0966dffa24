"""Description of an arm in an experiment: the table [model.arm], with a URDF file or links."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..arms import Chain, Link, inertia_about, read_urdf, rotation_of
from ..arms.chain import GRAVITY, tensor
from ..base.errors import ExperimentError, did_you_mean, quote
from ..base.frozen import ByValue
from ..base.toml import Table
from .description import BODY, BodyDescription, body_from, effects_from, value_from
from .saving import file_within

#: treatment of inertial parameters: estimated, or taken from the description
ESTIMATES = ("base parameters", "as given")
_ARM = ("urdf", "links", "estimate", "gravity", "joints")
_JOINT = ("urdf_joint", "motor_inertia", "effects")
_LINK = ("joint", "name", "kind", "axis", "xyz", "rpy", "mass", "centre", "inertia")
#: a joint is a body: its name stands in channels and answers
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_-]{0,63}")
_RESERVED = (
    *("arm", "device", "environment", "links", "master", "record", "record_shift"),
    *("segment", "slave", "t", "time"),
)


@dataclass(frozen=True, eq=False)
class ArmDescription(ByValue):
    """The links that couple the joints of an experiment.

    arm: the kinematic chain; its joints have the order of the bodies of the experiment
    estimate: "base parameters" (estimate the inertial parameters) or "as given" (take them from the
        description)
    """

    arm: Chain
    estimate: str

    def __repr__(self) -> str:
        return f"{self.arm!r}\n  inertial parameters: {self.estimate}"


def arm_from(model: Table, folder: Path) -> tuple[ArmDescription, dict[str, BodyDescription]]:
    """Read [model.arm]: the arm, and its joints as bodies.

    folder: of the experiment, where its URDF lies
    raises ExperimentError: unknown key, joint or file, links that make no chain
    """
    model.allow(("arm",))
    table = model.table("arm")
    table.allow(_ARM)
    joints = {name: table.table("joints").table(name) for name in table.table("joints").content}
    if not joints:
        raise table.error("joints", "one table a joint", "none")
    for name, joint in joints.items():
        joint.allow(_JOINT)
        _require_name(name, table.where("joints"))
    x, y, z = table.numbers("gravity", 3, GRAVITY)
    arm = _kinematics(table, folder, joints).with_gravity((x, y, z))
    estimate = table.choice("estimate", ESTIMATES, ESTIMATES[0])
    bodies = {
        name: _joint(name, joint, link)
        for (name, joint), link in zip(joints.items(), arm.links, strict=True)
    }
    return ArmDescription(arm, estimate), bodies


def _require_name(name: str, where: str) -> None:
    if not _NAME.fullmatch(name) or name in _RESERVED:
        raise ExperimentError(
            f"{where}: found {quote(name)}, expected a name of letters and digits, none of "
            f"{', '.join(_RESERVED)}"
        )


def joints_from(model: Table) -> dict[str, BodyDescription]:
    """Read the joints of an identified arm, each a body in the form that an answer writes."""
    joints = {}
    for name in model.content:
        _require_name(name, model.where())
        table = model.table(name)
        table.allow(BODY)
        joints[name] = body_from(name, table)
    return joints


def _joint(name: str, table: Table, link: Link) -> BodyDescription:
    """A joint as a body. The inertia of the body is the inertia of the motor."""
    inertia = None
    if "motor_inertia" in table.content:
        inertia = value_from(table, "motor_inertia")
        size, _ = inertia.in_si("inertia", link.kind)
        if size < 0:
            raise ExperimentError(f"{inertia.where}: found {size:g}, expected 0 or more")
    return BodyDescription(name, link.kind, inertia, effects_from(table), table.where())


def _kinematics(table: Table, folder: Path, joints: Mapping[str, Table]) -> Chain:
    if ("urdf" in table.content) == ("links" in table.content):
        entry = "both" if "urdf" in table.content else "neither"
        raise ExperimentError(
            f"{table.where()}: found {entry} of urdf and [[model.arm.links]], expected one of them"
        )
    if "links" in table.content:
        for joint in joints.values():
            if "urdf_joint" in joint.content:
                raise joint.error("urdf_joint", "urdf", "beside [[model.arm.links]]")
        return _chain_of_links(table, tuple(joints))
    file = table.text("urdf")
    path = file_within(folder, file)
    if path is None:
        names = sorted(p.name for p in folder.iterdir() if p.suffix in (".urdf", ".xml"))
        raise ExperimentError(
            f"{table.where('urdf')}: no file {quote(file)} in {folder.name}/, found "
            f"{', '.join(names[:10]) or 'none'}{did_you_mean(file, names)}"
        )
    named = [joint.text("urdf_joint", name) for name, joint in joints.items()]
    return read_urdf(path, f"{folder.name}/{file}", named)


def _chain_of_links(table: Table, joints: tuple[str, ...]) -> Chain:
    """Kinematic chain from [[model.arm.links]]: one link per joint, from the base to the tip."""
    links = tuple(_link(entry) for entry in table.tables("links"))
    order = tuple(link.joint for link in links)
    if order != joints:
        raise ExperimentError(
            f"{table.where('links')}: found joints {', '.join(order)}, expected those of "
            f"[model.arm.joints] from the base to the tip: {', '.join(joints)}"
        )
    return Chain(links)


def _link(table: Table) -> Link:
    table.allow(_LINK)
    joint = table.text("joint")
    kind = table.choice("kind", ("revolute", "prismatic"), "revolute")
    axis = np.array(table.numbers("axis", 3, (0.0, 0.0, 1.0)))
    if not (size := float(np.linalg.norm(axis))) > 0:
        raise table.error("axis", "a direction", "0, 0, 0")
    zero = (0.0,) * 3
    mass = table.number("mass") if "mass" in table.content else 0.0
    if mass < 0:
        raise table.error("mass", "0 or more", f"{mass:g}")
    about = tensor(np.array(table.numbers("inertia", 6, (0.0,) * 6)))
    return Link(
        name=table.text("name", f"{joint}_link"),
        joint=joint,
        kind=kind,
        axis=axis / size,
        rotation=rotation_of(*table.numbers("rpy", 3, zero)),
        origin=np.array(table.numbers("xyz", 3, zero)),
        inertial=inertia_about(mass, np.array(table.numbers("centre", 3, zero)), about),
    )
