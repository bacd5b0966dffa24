"""The report as a page: self-contained, complete, escaped, the same each time."""

import dataclasses
import json
import os
import re
import subprocess
import sys
from base64 import b64decode
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from markupsafe import Markup
from show.report.html_page import HtmlPage

from teleopdesign.base.files import make_plain
from teleopdesign.base.finding import Finding, Graph, Series
from teleopdesign.diagnose.answer import answer
from teleopdesign.show.report import write_report
from teleopdesign.show.report.figures import graph_figure
from teleopdesign.show.report.page import FIGURES, embedded_json, figure_script, page_of, render

HOSTILE = (
    '</script><script>alert(1)</script>"><img src=x onerror=alert(1)>',
    "'\"><svg onload=alert(1)>&amp;<!-- ",
    "{{ 7 * 7 }} {% raw %} ${7} $x_1$",
    "]]></style></title><b>",
)


def finding(text="rises with speed", graph=None, **numbers):
    return Finding("topic", "note", text, numbers, graph=graph)


@pytest.fixture(scope="module")
def written(diagnosis, tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "report.html"
    write_report(diagnosis, path)
    return path.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def html(written):
    return HtmlPage(written)


def test_nothing_is_loaded_from_elsewhere(written, html):
    assert not html.all("link", "iframe", "object", "base")
    for element in html.elements:
        for name, value in element.attributes.items():
            assert not name.startswith("on"), "no script in attributes"
            if name in ("href", "src"):
                assert value.startswith(("#", "data:image/svg+xml;base64,")), value[:80]
    assert "@import" not in written
    assert all(target.startswith("#") for target in re.findall(r"url\(([^)]*)", written))
    kinds = [e.attributes.get("type") for e in html.all("script")]
    assert kinds == ["application/json", None]
    assert html.all("script")[1].text == figure_script()


def test_a_page_has_one_title_headings_in_order_and_unlike_identifiers(html):
    levels = [int(e.tag[1]) for e in html.all("h1", "h2", "h3", "h4")]
    assert levels[0] == 1 and levels.count(1) == 1
    assert all(b - a <= 1 for a, b in zip(levels, levels[1:], strict=False))
    names = [e.attributes["id"] for e in html.elements if "id" in e.attributes]
    assert len(names) == len(set(names))
    targets = [e.attributes["href"][1:] for e in html.all("a", "use") if "href" in e.attributes]
    assert set(targets) <= set(names)


def test_every_figure_has_an_alternative_text_and_every_table_a_caption(html):
    pictures = html.all("img")
    assert len(pictures) == 7
    assert all(e.attributes["alt"] for e in pictures)
    tables = html.all("table")
    assert len(tables) == len(html.all("caption"))
    assert all(e.attributes.get("scope") for e in html.all("th"))
    assert "viewport" in [e.attributes.get("name") for e in html.all("meta")]


def test_the_verdict_and_the_fall_of_the_error_come_first(html, diagnosis):
    first = html.all("header")[0].text
    assert "Your model lacks stribeck at device" in first
    for error in (diagnosis.before.check_error, diagnosis.after.check_error, diagnosis.floor.value):
        assert f"{100 * error:.2f}" in first


def test_the_data_hold_the_answer(html, diagnosis):
    assert html.data["answer"] == make_plain(answer(diagnosis))
    assert html.data["report"]["views"][0]["steps"][0]["check_error"] == pytest.approx(0.0707, 1e-2)


@pytest.mark.slow
def test_a_figure_is_the_same_in_a_process_with_another_hash_seed():
    code = (
        "from teleopdesign.show.report.figures import picture\n"
        "def draw(f):\n    a = f.subplots(); a.plot([0, 1, 2], [1, 0, 2], 'o'); a.imshow([[1.0]])\n"
        "print(picture(draw, size=(2, 1), alt='y'))"
    )
    runs = [
        subprocess.run(
            [sys.executable, "-c", code],
            capture_output=True,
            text=True,
            check=True,
            env={**os.environ, "PYTHONHASHSEED": seed},
        ).stdout
        for seed in ("1", "2")
    ]
    assert runs[0] == runs[1] and "data:image/svg+xml" in runs[0]


def test_a_page_stays_small_however_much_the_findings_hold(page, written, diagnosis):
    n = 200_000
    x = np.linspace(0, 1, n)
    graph = Graph("time (s)", "force (N)", (Series("measured", x, np.sin(1e4 * x)),) * 3)
    many = [finding(graph=graph) for _ in range(20)]
    full = page_of(diagnosis, soundness=many)
    drawn = graph_figure(full["soundness"][0].graph, "force")
    data = len(embedded_json(make_plain(full))) - len(embedded_json(make_plain(page)))
    assert len(written) + data + 20 * len(drawn) < 2e6


#: empty figures, drawn in no time
BARE = dict.fromkeys(FIGURES, lambda *_: Markup("<b></b>"))


@pytest.fixture(scope="module")
def page_with(page):
    """The page, its figures left empty, with a text wherever one can come from a file."""
    return lambda text: HtmlPage(render(with_text(page, text), {"text": text}, BARE))


@pytest.fixture(scope="module")
def harmless(page_with):
    return page_with("harmless").shape


def with_text(page, text):
    """The page with this text wherever a text can come from a file."""

    def put(rows, *fields):
        return tuple({**row, **{f: text for f in fields if row[f]}} for row in rows)

    return {
        **page,
        "title": text,
        "folder": text,
        "verdict": text,
        "floor_source": text,
        "ladder": put(page["ladder"], "name", "brief"),
        "added": put(page["added"], "effect", "at", "title", "law", "source"),
        "parameters": put(page["parameters"], "effect", "parameter", "meaning", "unit"),
        "candidates": put(page["candidates"], "effect", "at"),
        "records": put(page["records"], "file", "use", "digest"),
        "channels": put(page["channels"], "name", "column", "unit"),
        "version": text,
    }


@pytest.mark.parametrize("text", HOSTILE)
def test_a_hostile_text_is_shown_and_adds_no_element(text, page_with, harmless):
    read = page_with(text)
    assert read.shape == harmless
    assert read.all("h1")[0].text == text
    assert read.data == {"text": text}


#: a null or a carriage return is replaced by every reader of HTML, and a surrogate is no text
TEXTS = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0\r"), min_size=1)


@settings(max_examples=20)
@given(text=TEXTS)
def test_no_text_changes_the_elements_of_the_page(text, page_with, harmless):
    read = page_with(text)
    assert read.shape == harmless
    assert read.data == {"text": text}


@pytest.mark.parametrize("text", HOSTILE)
def test_findings_are_escaped_in_text_names_and_figures(text, page):
    graph = Graph(text, text, (Series(text, np.arange(3.0), np.arange(3.0)),) * 2)
    one = Finding(text, "warning", text, {text: 1.5}, text)
    drawn = dataclasses.replace(one, graph=graph)
    full = {**page, "soundness": (one,), "unexplained": (one,), "next_steps": (drawn,)}
    figures = {**BARE, "graph": graph_figure}
    read = HtmlPage(render(full, {"report": make_plain(full)}, figures))
    assert [e.attributes.get("type") for e in read.all("script")] == ["application/json", None]
    assert read.all("script")[1].text == figure_script()
    (shown,) = read.all("img")
    assert shown.attributes["alt"] == f"{text}: {text}"
    assert read.data["report"]["soundness"][0]["numbers"] == {text: 1.5}
    svg = b64decode(shown.attributes["src"].partition(",")[2]).decode("utf-8")
    labels = [e for e in ElementTree.fromstring(svg).iter() if e.text == text]
    assert len(labels) == 4, "two axes and two entries of the legend"
    assert "<script" not in svg and not re.search(r"<[^>]* on\w+=", svg)
    marks = [e for e in read.elements if "finding" in e.attributes.get("class", "")]
    assert sum(e.attributes["class"] == "finding warning" for e in marks) == 3


@given(st.recursive(st.floats() | st.text() | st.integers(), st.lists, max_leaves=5))
def test_embedded_json_reads_back_and_cannot_end_its_element(value):
    text = embedded_json(make_plain({"value": value}))
    assert "<" not in text and "&" not in text
    assert json.loads(text) == make_plain({"value": value})
