"""Scripts by which a shell completes the command, written from its parser."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

#: arguments that take an effect's name
_OF_EFFECTS = ("--only", "--exclude")


@dataclass(frozen=True)
class Option:
    """An option: its names, what follows it, and its help.

    values: words that may follow;  takes: "" for nothing, "word", or "file"
    """

    names: tuple[str, ...]
    takes: str
    values: tuple[str, ...]
    text: str


@dataclass(frozen=True)
class Completion:
    """What may follow a command: its options, and words beside files as its arguments."""

    text: str
    options: tuple[Option, ...]
    words: tuple[str, ...]


def completions(
    parser: argparse.ArgumentParser, effects: Iterable[str]
) -> Mapping[str, Completion]:
    """Command -> what may follow it; effects: names, where one is expected."""
    commands = next(a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
    texts = {choice.dest: choice.help or "" for choice in commands._choices_actions}
    known = tuple(effects)
    return {
        name: Completion(
            texts.get(name, ""),
            tuple(_option(a, known) for a in sub._actions if a.option_strings),
            tuple(w for a in sub._actions if not a.option_strings for w in _words(name, a, known)),
        )
        for name, sub in commands.choices.items()
    }


def _option(action: argparse.Action, effects: tuple[str, ...]) -> Option:
    names = tuple(action.option_strings)
    text = " ".join((action.help or "").split()).replace("%%", "%")
    if action.nargs == 0:
        return Option(names, "", (), text)
    values = effects if names[0] in _OF_EFFECTS else tuple(map(str, action.choices or ()))
    return Option(names, "file" if action.type is Path else "word", values, text)


def _words(command: str, action: argparse.Action, effects: tuple[str, ...]) -> tuple[str, ...]:
    if command == "effects" and action.dest == "name":
        return effects
    return tuple(map(str, action.choices or ()))


def bash(commands: Mapping[str, Completion]) -> str:
    """For bash: `eval "$(teleopdesign completion bash)"`."""
    cases, values = [], []
    for name, command in commands.items():
        options = " ".join(n for o in command.options for n in o.names)
        cases.append(f'    {name}) options="{options}" words="{" ".join(command.words)}" ;;')
        values += [
            f"    {name}:{n}) values='{' '.join(o.values)}' ;;"
            for o in command.options
            for n in o.names
            if o.values
        ]
    return "\n".join(
        [
            "# completion of teleopdesign for bash",
            "_teleopdesign() {",
            '  local word="${COMP_WORDS[COMP_CWORD]}" options="" words="" values="" last="" k',
            "  COMPREPLY=()",
            "  if ((COMP_CWORD == 1)); then",
            f'    COMPREPLY=($(compgen -W "{" ".join(commands)} --help --version" -- "$word"))',
            "    return",
            "  fi",
            '  case "${COMP_WORDS[1]}" in',
            *cases,
            "  esac",
            '  if [[ "$word" == -* ]]; then',
            '    COMPREPLY=($(compgen -W "$options" -- "$word"))',
            "    return",
            "  fi",
            "  for ((k = 2; k < COMP_CWORD; k++)); do",
            '    [[ "${COMP_WORDS[k]}" == --* ]] && last="${COMP_WORDS[k]}"',
            "  done",
            '  case "${COMP_WORDS[1]}:$last" in',
            *values,
            "  esac",
            '  if [[ -n "$values" ]]; then',
            '    COMPREPLY=($(compgen -W "$values" -- "$word"))',
            "    return",
            "  fi",
            '  COMPREPLY=($(compgen -W "$words" -- "$word") $(compgen -f -- "$word"))',
            "}",
            "complete -o filenames -F _teleopdesign teleopdesign",
            "",
        ]
    )


def zsh(commands: Mapping[str, Completion]) -> str:
    """For zsh: `eval "$(teleopdesign completion zsh)"`, after compinit."""
    cases = []
    for name, command in commands.items():
        lines = []
        for option in command.options:
            after = {"": "", "file": ":file:_files", "word": f":value:({' '.join(option.values)})"}
            lines += [f"{n}[{_zsh_text(option.text)}]{after[option.takes]}" for n in option.names]
        words = f"*:word:({' '.join(command.words)})" if command.words else "*:file:_files"
        quoted = " ".join(f"'{line}'" for line in [*lines, words])
        cases.append(f"    {name}) _arguments {quoted} ;;")
    listed = " ".join(f"'{n}:{_zsh_text(c.text)}'" for n, c in commands.items())
    return "\n".join(
        [
            "#compdef teleopdesign",
            "_teleopdesign() {",
            f"  local -a commands=({listed})",
            "  if ((CURRENT == 2)); then _describe command commands; return; fi",
            "  local name=${words[2]}",
            "  shift words; ((CURRENT--))",
            "  case $name in",
            *cases,
            "  esac",
            "}",
            "compdef _teleopdesign teleopdesign",
            "",
        ]
    )


def _zsh_text(text: str) -> str:
    """A help text between brackets and single quotes."""
    for character, stand_in in (("'", "’"), ("[", "("), ("]", ")"), (":", ","), ("\\", "/")):
        text = text.replace(character, stand_in)
    return text


def fish(commands: Mapping[str, Completion]) -> str:
    """For fish: `teleopdesign completion fish | source`."""
    head = "complete -c teleopdesign"
    lines = [
        "# completion of teleopdesign for fish",
        *(
            f"{head} -n __fish_use_subcommand -f -a {name} -d {_fish_text(command.text)}"
            for name, command in commands.items()
        ),
    ]
    for name, command in commands.items():
        here = f"{head} -n '__fish_seen_subcommand_from {name}'"
        if command.words:
            lines.append(f"{here} -a '{' '.join(command.words)}'")
        for option in command.options:
            names = " ".join(
                f"-l {n[2:]}" if n.startswith("--") else f"-s {n[1:]}" for n in option.names
            )
            after = {"": "", "file": " -r -F", "word": " -r"}[option.takes]
            values = f" -f -a '{' '.join(option.values)}'" if option.values else ""
            lines.append(f"{here} {names}{after}{values} -d {_fish_text(option.text)}")
    return "\n".join([*lines, ""])


def _fish_text(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace("'", "\\'")
    return f"'{escaped}'"


#: shell -> what writes its script
SHELLS = {"bash": bash, "zsh": zsh, "fish": fish}
