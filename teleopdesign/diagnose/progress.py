"""Progress of a ranking: how many of its candidates have been started."""

from __future__ import annotations


class ProgressLine(str):
    """A line of text with a count, such as "step 2: stribeck at device (14 of 38)".

    stage: the stage that the line belongs to, such as "step 2"; "": none
    begun, total: parts of this stage: those that have started, and all
    """

    stage: str
    begun: int
    total: int

    def __new__(cls, text: str, *, begun: int, total: int, stage: str = "") -> ProgressLine:
        head = f"{stage}: " if stage else ""
        line = super().__new__(cls, f"{head}{text} ({begun} of {total})")
        line._text, line.stage, line.begun, line.total = text, stage, begun, total
        return line

    _text: str

    def within(self, stage: str) -> ProgressLine:
        """The same line as part of a stage."""
        return ProgressLine(self._text, begun=self.begun, total=self.total, stage=stage)
