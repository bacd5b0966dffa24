"""list the physical effects, or show one"""

from __future__ import annotations

import argparse

from ._options import add_effect_files

EXAMPLES = """
  teleopdesign effects
  teleopdesign effects stribeck
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("name", nargs="?", help="name of one effect, whose page is shown")
    add_effect_files(parser)


def run(options: argparse.Namespace) -> int:
    """Print the catalogue, or the page of one effect."""
    from ..effects import catalogue, find_effect

    known = catalogue(options.effect)
    if options.name is None:
        for name, effect in known.items():
            print(f"{name:<20} {effect.role:<15} {effect.title}")
        return 0
    effect = find_effect(options.name, known, "effects")
    print(f"{effect.name}  ({effect.role})\n\n{effect.text.strip()}\n")
    for name, parameter in effect.parameters.items():
        print(f"  {name:<22} {parameter.quantity:<14} {parameter.meaning}")
    print(f"\nEnergy: {effect.energy}")
    print(f"Source: {effect.source}")
    return 0
