"""The style of all figures: widths, colours and lines of the cases, symbols, fonts, files.

A figure takes each letter from the first of its fonts that has the letter. Fonts of this machine
follow the fonts of the house style, for names in Japanese, Chinese, Korean, Arabic; a letter that
no font has is drawn as a box.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from functools import cache, wraps
from importlib import import_module
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, cast

from ...base.files import write_beside

if TYPE_CHECKING:
    import matplotlib.figure
    import matplotlib.pyplot
    import numpy as np
    from matplotlib.axes import Axes

    plt = matplotlib.pyplot
else:

    class _Pyplot:
        """`matplotlib.pyplot`, which is loaded when the first figure is drawn, not with a text."""

        def __getattr__(self, name: str) -> Any:
            return getattr(import_module("matplotlib.pyplot"), name)

    plt = _Pyplot()

Draw = TypeVar("Draw", bound=Callable[..., Any])

ONE_COLUMN, TWO_COLUMNS = 3.5, 7.16  # inches

#: the four cases in the same colours (Okabe and Ito) and lines in every figure
CASES = {
    "none": ("#000000", "-", "no compensation"),
    "MBC": ("#0072B2", (0, (5, 1.6)), "motion-based cancellation"),
    "FF": ("#D55E00", (0, (4, 1.4, 1, 1.4)), "force feedback"),
    "hybrid": ("#009E73", "-", "hybrid"),
}
#: colours of what is proved, what is refuted, a theory, and all else
#: of measured signals, of the model before and of the model after
MEASURED, BEFORE, AFTER = "0.55", "#D55E00", "#0072B2"
#: of the directions of motion
FORWARD, BACKWARD, UNTOLD = "#009E73", "#CC79A7", "0.6"
PROVED, REFUTED, THEORY, GREY = "#009E73", "#D55E00", "#0072B2", "#7F7F7F"
#: symbols of signals that are no letter with an index
_SYMBOLS = {
    "E": "R_D - R_M",
    "L": "L",
    "L_E": "L_D - L",
    "L_velocity": r"\dot L",
    "L_acceleration": r"\ddot L",
}
#: a letter with a short index, and how often it is differentiated: "X_m", "X_m_velocity"
_INDEXED = re.compile(r"([A-Za-z])_([A-Za-z0-9]{1,3})(_velocity|_acceleration)?")
_DOTS = {None: "", "_velocity": r"\dot ", "_acceleration": r"\ddot "}


def symbol(name: str) -> str:
    """The signal's symbol in mathtext; a name without a symbol gets spaces for underscores."""
    if name in _SYMBOLS:
        return f"${_SYMBOLS[name]}$"
    if indexed := _INDEXED.fullmatch(name):
        letter, index, rate = indexed.groups()
        index = index if len(index) == 1 else rf"\mathrm{{{index}}}"
        return f"${_DOTS[rate]}{letter}_{{{index}}}$"
    return name.replace("_", " ")


def hatch_region(
    axis: Axes, x: np.ndarray, low: float | np.ndarray, high: float | np.ndarray, label: str
) -> None:
    """Hatch a region between `low` and `high` that a theorem covers."""
    axis.fill_between(
        x,
        low,
        high,
        facecolor="#EEF8F4",
        edgecolor="#8FCDB8",
        hatch="///",
        linewidth=0.0,
        label=label,
    )


def save_figure(
    figure: matplotlib.figure.Figure,
    path: str | Path,
    *,
    suffixes: tuple[str, ...] = (".pdf", ".svg", ".png"),
) -> list[Path]:
    """Write the figure in house style, once for each suffix; returns the paths of the files.

    path: its suffix is replaced by each of `suffixes`; an older file is replaced only when the new
        file is complete
    """
    files = [Path(path).with_suffix(suffix) for suffix in suffixes]
    # fonts and resolution are taken when it is drawn; what has no layout keeps none
    layout = {"figure.constrained_layout.use": figure.get_layout_engine() is not None}
    with plt.style.context([*house_style(), layout]):
        for file in files:
            with write_beside(file) as part:
                figure.savefig(part)
    return files


def as_svg(figure: matplotlib.figure.Figure, *, title: str = "", dpi: float = 100.0) -> str:
    """The figure as SVG for a page, which is closed; the same figure gives the same text.

    title: alternative text;  dpi: of parts that are drawn as pixels
    """
    out = StringIO()
    # the same identifiers in every process; text stays text: small, and sharp at every size
    with plt.rc_context({"svg.hashsalt": "teleopdesign", "svg.fonttype": "none"}):
        named = {"Title": title} if title else {}
        figure.savefig(out, format="svg", metadata={"Date": None, **named}, dpi=dpi)
    plt.close(figure)
    text = out.getvalue()
    return text[text.index("<svg") :]


STYLE = Path(__file__).with_name("teleopdesign.mplstyle")
#: fonts with letters of many languages, as systems bring them; those that are here are used
MANY_LETTERS = (
    "DejaVu Sans", "Noto Sans CJK JP", "Noto Sans CJK SC", "Noto Sans JP", "Noto Sans SC",
    "Noto Sans KR", "Source Han Sans", "IPAexGothic", "IPAGothic", "TakaoGothic", "VL Gothic",
    "WenQuanYi Zen Hei", "WenQuanYi Micro Hei", "Droid Sans Fallback", "UnDotum", "NanumGothic",
    "Hiragino Sans", "PingFang SC", "Heiti TC", "Apple SD Gothic Neo", "Arial Unicode MS",
    "Yu Gothic", "MS Gothic", "Meiryo", "Microsoft YaHei", "SimHei", "SimSun", "Malgun Gothic",
    "Noto Sans", "Noto Sans Arabic", "Noto Sans Devanagari", "Noto Sans Thai",
)  # fmt: skip


@cache
def further_fonts() -> tuple[str, ...]:
    """Names of the fonts in `MANY_LETTERS` that this machine has."""
    from matplotlib.font_manager import fontManager

    here = {font.name for font in fontManager.ttflist}
    return tuple(name for name in MANY_LETTERS if name in here)


def house_style() -> Any:
    """The house style for `plt.style.context`, with further fonts of this machine at the end."""
    return [STYLE, {"font.family": ["STIXGeneral", "DejaVu Serif", *further_fonts()]}]


def in_house_style(draw: Draw) -> Draw:
    """The function, which draws in house style."""

    @wraps(draw)
    def drawn(*arguments: Any, **options: Any) -> Any:
        with plt.style.context(house_style()):
            return draw(*arguments, **options)

    return cast(Draw, drawn)


def letters_without_a_font(texts: Iterable[str]) -> str:
    """The letters of the texts that no font of a figure has, each once; they are drawn as boxes."""
    from matplotlib.font_manager import FontProperties, findfont, get_font

    fonts = [get_font(findfont(FontProperties(family=name))) for name in further_fonts()]
    letters = sorted({c for text in texts for c in text if c.isprintable() and not c.isspace()})
    return "".join(c for c in letters if not any(f.get_char_index(ord(c)) for f in fonts))


def explain_boxes(texts: Iterable[str]) -> str:
    """One line that names letters drawn as boxes and proposes fonts; "" if there are none."""
    lacking = letters_without_a_font(texts)
    if not lacking:
        return ""
    return (
        f'the figure shows boxes for "{lacking[:12]}": no font here has these letters; install '
        "one that has them (Debian: fonts-noto-cjk)"
    )
