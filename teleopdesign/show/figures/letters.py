"""Fonts for letters that a figure's fonts lack: names in Japanese, Chinese, Korean, Arabic.

A figure takes each letter from the first of its fonts that has the letter. Fonts of this machine
follow the fonts of the house style; a letter that no font has is drawn as a box.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

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
