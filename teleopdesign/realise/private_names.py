"""A diagram with private names, on which equations and generated source are written.

Signals are s000_, s001_ ... and blocks b000_, b001_ ... in their order, whatever their names are.
So no name of a user equals a word of the generated source, or a name that the package makes itself
(`s000__velocity`). A diagram with other names gives the same numbers to the last bit. All names
that a user reads are translated back.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from types import MappingProxyType

import sympy as sp

from ..base.errors import ModelError
from ..diagrams import (
    Attached,
    Block,
    Control,
    Diagram,
    Junction,
    Kinematics,
    Linked,
    Moving,
    position_symbol,
)
from ..diagrams.junctions import Weight

#: beginning of every private name; ends with "_", so that no such name begins another one
_BEGIN = re.compile(r"\b[sbd]\d{3,}_")
_TITLE = "d000_"


@dataclass(frozen=True)
class PrivateNames:
    """The diagram with private names, and the translation back.

    public: private name -> name of the user;  private: signal -> its private name
    """

    diagram: Diagram
    public: Mapping[str, str]
    private: Mapping[str, str]

    def public_name(self, name: str) -> str:
        """The user's name for a private name, or for one derived from it, such as a velocity."""
        begin = _BEGIN.match(name)
        return name if begin is None else self.public[begin[0]] + name[begin.end() :]

    def public_names(self, *names: str) -> tuple[str, ...]:
        """The user's names, as of `public_name`.

        raises ModelError: two of them are equal, or one is "time"
        """
        owners: dict[str, str] = {"time": "the time"}
        for name in dict.fromkeys(names):
            public = self.public_name(name)
            if public in owners:
                two = sorted(
                    (owners[public], self._describe_signal(name)),
                    key=lambda text: text != "the signal",
                )
                raise ModelError(
                    f'{self.public[_TITLE]}: "{public}" is the name of {" and of ".join(two)}: '
                    "call the signal otherwise"
                )
            owners[public] = self._describe_signal(name)
        return tuple(map(self.public_name, names))

    def _describe_signal(self, name: str) -> str:
        begin = _BEGIN.match(name)
        if begin is None or begin[0] == name:
            return "the signal"
        what = name[begin.end() :].strip("_").replace("_", " ")
        return f"the {what} of {self.public[begin[0]]}"

    @contextmanager
    def in_errors(self) -> Iterator[None]:
        """A context in which errors on the private diagram are raised with the user's names."""
        try:
            yield
        except ModelError as error:
            text = _BEGIN.sub(lambda m: self.public.get(m[0], m[0]), str(error))
            raise type(error)(text) from None


def private_names(diagram: Diagram) -> PrivateNames:
    """The diagram with private names of its signals and blocks; values and wiring are the same."""
    signals = {s: f"s{i:03d}_" for i, s in enumerate(diagram.signals)}
    blocks = {b.name: f"b{i:03d}_" for i, b in enumerate(diagram.blocks)}
    symbols = {position_symbol(s): position_symbol(p) for s, p in signals.items()}

    def renamed(weight: Weight) -> Weight:
        return weight.xreplace(symbols) if isinstance(weight, sp.Expr) else weight

    inner = Diagram(
        _TITLE,
        tuple(_rename_block(b, blocks[b.name], signals) for b in diagram.blocks),
        tuple(
            Junction(signals[j.output], {signals[s]: renamed(w) for s, w in j.terms.items()})
            for j in diagram.junctions
        ),
        {signals[s]: quantity for s, quantity in diagram.outside.items()},
        tuple(signals[s] for s in diagram.measured),
        {},
        tuple(
            Kinematics(signals[k.output], sp.sympify(renamed(k.expression), strict=True), k.axis)
            for k in diagram.kinematics
        ),
        {signals[s]: x for s, x in diagram.pose.items() if s in signals},
    )
    public = {_TITLE: diagram.name} | {
        p: n for table in (signals, blocks) for n, p in table.items()
    }
    return PrivateNames(inner, MappingProxyType(public), MappingProxyType(signals))


def _rename_block(block: Block, name: str, signals: Mapping[str, str]) -> Block:
    if isinstance(block, Moving):
        loads = {signals[s]: sign for s, sign in block.loads.items()}
        driver = signals.get(block.driver, "")
        motion, command = signals[block.motion], signals[block.command]
        return Moving(name, block.body, motion, command, loads, driver)
    if isinstance(block, Attached):
        return replace(block, name=name, motion=signals[block.motion], force=signals[block.force])
    if isinstance(block, Linked):
        motions, forces = (tuple(signals[s] for s in x) for x in (block.motions, block.forces))
        return replace(block, name=name, motions=motions, forces=forces)
    assert isinstance(block, Control)
    source, made, along = signals[block.input], signals[block.output], signals.get(block.motion, "")
    others = tuple(signals[s] for s in block.others)
    return replace(block, name=name, input=source, output=made, motion=along, others=others)
