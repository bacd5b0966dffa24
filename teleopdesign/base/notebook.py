"""Small HTML tables, in which results show themselves in a notebook. Every text is escaped."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

#: most rows of a table in a notebook
MOST_ROWS = 40


def html_table(
    title: str, head: Sequence[str], rows: Iterable[Sequence[object]], *, note: str = ""
) -> str:
    """An HTML table with a title above, and with `note` below unless it is "".

    At most MOST_ROWS rows are shown; a last row counts the others.
    """
    listed = [tuple(map(str, row)) for row in rows]
    more = len(listed) - MOST_ROWS
    if more > 0:
        listed = [*listed[:MOST_ROWS], (f"... and {more} more", *[""] * (len(head) - 1))]
    body = "".join(f"<tr>{_cells(row, 'td')}</tr>" for row in listed)
    top = f"<thead><tr>{_cells(head, 'th')}</tr></thead>" if any(head) else ""
    below = f"<p>{escape(note)}</p>" if note else ""
    return (
        f"<div><p><b>{escape(title)}</b></p><table>{top}<tbody>{body}</tbody></table>{below}</div>"
    )


def _cells(row: Sequence[str], tag: str) -> str:
    return "".join(f"<{tag} style='text-align:left'>{escape(cell)}</{tag}>" for cell in row)
