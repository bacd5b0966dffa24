"""Finished points, kept while a study runs: one line each in a file beside the target.

    3f21c0aa {"study": "...", "points": 100}
    9b00e1d7 {"form": "5c1...", "values": {...}}
    0c44e6f2 {"point": 17, "form": "5c1...", "values": [0.0123]}

Each line is written at once and begins with its checksum (CRC-32). If a process is killed, or a
disk is full, at most the last line is broken. A broken line is removed when the study continues.
Numbers are written with all their digits.
"""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..base.errors import ExperimentError
from .outcomes import Outcomes, PointOutcome

try:
    import fcntl
except ImportError:  # no such thing on Windows: there two processes are not kept apart
    fcntl = None  # type: ignore[assignment]


class Journal:
    """Outcomes by point, also on disk if there is a path."""

    def __init__(self, path: Path | None, study: str, points: int) -> None:
        """Open the journal, with the outcomes of an earlier run of the same study.

        points: number of points
        raises ExperimentError: it belongs to another study, is in use, or cannot be written
        """
        self.path, self.study, self.points = path, study, points
        self.outcomes = Outcomes(points)
        self._forms: dict[str, tuple[Any, ...]] = {}
        self._file: int | None = None
        if path is not None:
            self._open(path)

    def _open(self, path: Path) -> None:
        try:
            self._file = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        except OSError as error:
            raise ExperimentError(f"{path}: cannot be written: {error.strerror}") from error
        try:
            if fcntl is not None:
                try:
                    fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                except BlockingIOError:
                    raise ExperimentError(
                        f"{path}: another process computes this study: wait for its end, or choose "
                        "another file"
                    ) from None
            good = self._read(path)
            os.ftruncate(self._file, good)
            os.lseek(self._file, good, os.SEEK_SET)
            if not good:
                self._write({"study": self.study, "points": self.points})
        except BaseException:
            self.close()
            raise

    def _read(self, path: Path) -> int:
        """Read every complete line; returns the position after the last of them."""
        assert self._file is not None
        end = 0
        with os.fdopen(os.dup(self._file), "rb") as file:
            file.seek(0)
            for number, line in enumerate(file):
                content = _content(line)
                if content is None or number > 0 and not self._knows(content):
                    break
                if number == 0:
                    if content.get("study") != self.study:
                        raise ExperimentError(
                            f"{path}: holds points of another study (other model, axes, measures "
                            "or version): choose another file, or remove it"
                        )
                elif "point" in content:
                    self._take(content)
                else:
                    self._forms[content["form"]] = _tuples(content["values"])
                end += len(line)
        return end

    def _knows(self, content: Mapping[str, Any]) -> bool:
        """Whether a line is a form, a failed point, or a point whose form precedes it."""
        if "point" in content:
            index, form = content["point"], content.get("form")
            is_next = index in range(self.points) and index not in self.outcomes
            return is_next and ("reason" in content or form in self._forms)
        return "form" in content and "values" in content

    def _take(self, content: Mapping[str, Any]) -> None:
        index = int(content["point"])
        form = self._forms.get(content.get("form", ""), ())
        outcome = PointOutcome(
            index, form, _tuples(content.get("values", ())), content.get("reason", "")
        )
        self.outcomes.keep(outcome)

    def add(self, outcome: PointOutcome) -> None:
        """Store an outcome; raises ExperimentError: the file cannot be written."""
        if outcome.point in self.outcomes:
            return
        if self._file is not None:
            content: dict[str, Any] = {"point": outcome.point}
            if outcome.reason:
                content["reason"] = outcome.reason
            else:
                content |= {"form": self._name_form(outcome.form), "values": outcome.values}
            self._write(content)
        self.outcomes.keep(outcome)

    def _name_form(self, form: tuple[Any, ...]) -> str:
        """Name of a form; the form is written before its first use."""
        name = f"{zlib.crc32(json.dumps(form).encode()):08x}"
        if name not in self._forms:
            self._write({"form": name, "values": form})
            self._forms[name] = form
        return name

    def _write(self, content: Mapping[str, Any]) -> None:
        assert self._file is not None
        body = json.dumps(content, separators=(",", ":")).encode()
        line = b"%08x %s\n" % (zlib.crc32(body), body)
        try:
            while line:
                line = line[os.write(self._file, line) :]
        except OSError as error:
            raise ExperimentError(
                f"{self.path}: cannot be written: {error.strerror}; {len(self.outcomes)} of "
                f"{self.points} points are kept: the same study continues from there"
            ) from error

    def close(self) -> None:
        """Close the file without removing it."""
        if self._file is not None:
            os.close(self._file)
            self._file = None

    def remove(self) -> None:
        """Close the file and remove it, once its content is stored elsewhere."""
        if self._file is not None and self.path is not None:
            self.path.unlink(missing_ok=True)
        self.close()


def _content(line: bytes) -> dict[str, Any] | None:
    """The content of a line; None if the line is incomplete or damaged."""
    head, _, body = line.removesuffix(b"\n").partition(b" ")
    try:
        if not line.endswith(b"\n") or int(head, 16) != zlib.crc32(body):
            return None
        content = json.loads(body)
    except ValueError:
        return None
    return content if isinstance(content, dict) else None


def _tuples(value: Any) -> Any:
    """Lists from JSON as tuples, at any depth."""
    return tuple(_tuples(v) for v in value) if isinstance(value, list | tuple) else value
