"""The text encoding of a table, judged from its bytes alone.

A byte-order mark and UTF-8 can be recognised for certain. Many other encodings can decode the same
bytes; the module takes the encoding in which most letters are usual in tables of measurements. A
table holds few words ("time", "position", "torque") and units, so that few letters decide.
"""

from __future__ import annotations

import codecs
import unicodedata

from ...base.errors import ExperimentError
from ..limits import HALF, SMALL

_LATIN = "ÄÖÜäöüßéèêëàâçîïôûùœñáíóúãõåøæÅØÆÉ°µ²³±·×–"
_JAPANESE = (
    "時間刻位置角度変速加関節電流圧力指令値実測操作手外目標軸回転数左右上下単番号試験日付荷重"
)
_SIMPLIFIED = (
    "时间刻位置角度移速加关节电流压力矩指令值实测操作手外目标轴回转数左右上下单编号试验日期扭"
)
_TRADITIONAL = (
    "時間刻位置角度移速加關節電流壓力矩指令值實測操作手外目標軸回轉數左右上下單編號試驗日期扭"
)
_KOREAN = "시간위치각도변속가관절전류압력토크힘지령값실측조작손외목표축회수좌우상하번호험일자명모터"
#: encoding -> letters of tables in it: the encodings besides UTF-8 that loggers, spreadsheets and
#: drives still use. Of several that fit equally the first one counts
ALPHABETS = {
    "cp1252": _LATIN,
    "cp932": _JAPANESE,
    "gb18030": _SIMPLIFIED,
    "big5": _TRADITIONAL,
    "cp949": _KOREAN,
    "euc_jp": _JAPANESE,
    "cp1251": "",
    "mac_roman": _LATIN,
}


def encoding_of(raw: bytes, file: str, *, whole: bool) -> str:
    """Name of the encoding of a text.

    raw: first bytes of the text;  whole: no byte follows
    raises ExperimentError: a zero byte, or a UTF-16 mark at the beginning of something else
    """
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        text = _decode(raw, "utf-16", whole=False)
        if text is None or sum(letter.isascii() for letter in text) < SMALL * len(text):
            raise ExperimentError(
                f"{file}: not a text (it begins as UTF-16 does, and does not go on so)"
            )
        return "utf-16"
    if raw[:3] == b"\xef\xbb\xbf":
        return "utf-8-sig"
    if b"\x00" in raw:
        raise ExperimentError(f"{file}: not a text (byte {raw.index(0)} is 0)")
    if _decode(raw, "utf-8", whole) is not None:
        return "utf-8"
    shares = {e: _known_share(_decode(raw, e, whole), e) for e in ALPHABETS}
    best = max(shares, key=lambda e: shares[e])
    if shares[best] >= HALF:
        return best
    return "cp1252" if _decode(raw, "cp1252", whole) is not None else "latin-1"


def _decode(raw: bytes, encoding: str, whole: bool) -> str | None:
    """The text, without a last letter that was cut off; None: not a text of this encoding."""
    try:
        return codecs.getincrementaldecoder(encoding)().decode(raw, final=whole)
    except UnicodeDecodeError:
        return None


def _known_share(text: str | None, encoding: str) -> float:
    """Share of the non-ASCII letters that are usual in tables of this encoding."""
    if text is None:
        return 0.0
    beyond = [k for k, letter in enumerate(text) if ord(letter) > 127]
    known = sum(_is_known(text, k, encoding) for k in beyond)
    return known / max(len(beyond), 1)


def _is_known(text: str, k: int, encoding: str) -> bool:
    letter = text[k]
    if letter in ALPHABETS[encoding]:
        return True
    name = unicodedata.name(letter, "")
    if encoding in ("cp932", "euc_jp"):
        return name.startswith(("HIRAGANA", "KATAKANA"))
    # within a Cyrillic word; a single such letter among Latin letters is a misread accent
    if encoding == "cp1251":
        beside = text[max(0, k - 1) : k] + text[k + 1 : k + 2]
        return letter == "°" or name.startswith("CYRILLIC SMALL") and not beside.isascii()
    return False
