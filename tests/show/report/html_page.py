"""Reads a report as a browser would: elements with attributes and text, in order."""

import json
from html.parser import HTMLParser

VOID = {"meta", "wbr", "br", "link", "img", "input", "hr", "base", "source", "col", "area", "embed"}


class Element:
    def __init__(self, tag, attributes, parents):
        self.tag, self.attributes, self.parents = tag, dict(attributes), parents
        self.parts = []

    @property
    def text(self):
        return "".join(self.parts)


class HtmlPage(HTMLParser):
    """elements: in order; an end without its beginning, or an open end, is an AssertionError."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.elements, self.open = [], []
        self.feed(text)
        self.close()
        assert not self.open, f"not closed: {[e.tag for e in self.open]}"

    def handle_starttag(self, tag, attrs):
        self.elements.append(Element(tag, attrs, [e.tag for e in self.open]))
        if tag not in VOID:
            self.open.append(self.elements[-1])

    def handle_startendtag(self, tag, attrs):
        self.elements.append(Element(tag, attrs, [e.tag for e in self.open]))

    def handle_endtag(self, tag):
        assert self.open and self.open[-1].tag == tag, f"</{tag}> closes nothing"
        self.open.pop()

    def handle_data(self, data):
        for element in self.open:
            element.parts.append(data)

    def all(self, *tags):
        return [e for e in self.elements if e.tag in tags]

    @property
    def data(self):
        (script,) = [e for e in self.all("script") if e.attributes.get("type")]
        return json.loads(script.text)

    @property
    def shape(self):
        """Every element with the names of its attributes: what no text may change."""
        return [
            (e.tag, tuple(sorted(e.attributes))) for e in self.elements if e.tag not in ("wbr", "b")
        ]
