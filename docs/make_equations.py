#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes resources/explain/equations/*.svg from resources/explain/equations.json.

    python3 docs/make_equations.py        all equations; needs matplotlib, which nothing else of Glint does

Glyphs are outlines, so that no font is needed to show them. Every symbol is a group with its id of equations.json (its second
place in an equation: "id.2"). There is no colour but currentColor. One em is EM units. <title> is the plain form, <desc> the
source text: a test compares both with equations.json.
"""
import json
import pathlib
import re
from xml.sax.saxutils import escape

import matplotlib
from matplotlib.font_manager import FontProperties
from matplotlib.ft2font import LOAD_NO_HINTING
from matplotlib.mathtext import MathTextParser

EXPLAIN = pathlib.Path(__file__).resolve().parent.parent / "resources" / "explain"
EM = 20.0  # units of one em: digits after the point then count a hundredth of a pixel
GAP = 0.45 * EM  # between lines
MARGIN = 0.1 * EM  # italics overhang their boxes
ABOVE = 0.2 * EM  # and below: text is close to a picture
SYMBOL = re.compile("⟦([a-z0-9-]+):([^⟧]*)⟧")
MATRIX = re.compile(r"\\matrix\{(.*)\}$")
# One glyph each, that no equation has: they show the place of a symbol in the order of glyphs.
MARKERS = [r"\aleph", r"\beth", r"\gimel", r"\daleth", r"\clubsuit", r"\spadesuit", r"\natural", r"\sharp", r"\flat", r"\wp"]

matplotlib.rcParams["mathtext.fontset"] = "stix"
parser = MathTextParser("path")


class Box:
    """Width, height above and depth below the baseline; paths as (symbol or None, d) with y downwards from the baseline."""

    def __init__(self, width=0.0, height=0.0, depth=0.0, paths=()):
        self.width, self.height, self.depth, self.paths = width, height, depth, list(paths)

    def add(self, other, x, y=0.0):
        self.paths += [(symbol, shifted(points, x, y)) for symbol, points in other.paths]


def shifted(points, x, y):
    return [(command, [(px + x, py + y) for px, py in pairs]) for command, pairs in points]


def parsed(tex):
    """mathtext sets relations and sums tight."""
    tex = re.sub(r" (=|\+|-|\\sim|\\parallel|>) ", r" \\,\1\\, ", tex)
    return parser.parse("$" + tex + "$", 72, FontProperties(size=EM))


def same(a, b):
    return a[0].fname == b[0].fname and a[2] == b[2]


def outline(glyph):
    """Glyph of a parse as path commands."""
    font, size, char, ox, oy = glyph
    font.set_size(100, 72)
    font.load_char(char, flags=LOAD_NO_HINTING)
    vertices, codes = font.get_path()
    scale = size / 100
    at = [(ox + scale * x, -(oy + scale * y)) for x, y in vertices]
    commands, i = [], 0
    while i < len(codes):
        count, letter = {1: (1, "M"), 2: (1, "L"), 3: (2, "Q"), 4: (3, "C"), 79: (1, "Z")}[int(codes[i])]
        commands.append((letter, [] if letter == "Z" else at[i:i + count]))
        i += count
    return commands


def rectangle(x, y, width, height):
    return [("M", [(x, y)]), ("L", [(x + width, y)]), ("L", [(x + width, y + height)]), ("L", [(x, y + height)]), ("Z", [])]


def owners(tex, glyphs):
    """For each glyph the number of the symbol in the text that it belongs to, or None."""
    symbols = [m.group(2) for m in SYMBOL.finditer(tex)]
    assert len(symbols) <= len(MARKERS), "too many symbols in " + tex
    numbers = iter(range(len(symbols)))
    marked = parsed(SYMBOL.sub(lambda m: "{" + MARKERS[next(numbers)] + "}", tex))[3]
    markers = [parsed(m)[3][0] for m in MARKERS[:len(symbols)]]
    found = []
    for glyph in marked:
        which = [i for i, m in enumerate(markers) if same(glyph, m)]
        found += [which[0]] * len(parsed(symbols[which[0]])[3]) if which else [None]
    assert len(found) == len(glyphs), "a symbol changes the others in " + tex
    return found


def mathtext(tex, places):
    if not tex.strip():
        return Box()
    width, height, depth, glyphs, rects = parsed(SYMBOL.sub(lambda m: "{" + m.group(2) + "}", tex))
    box = Box(width, height - depth, depth)
    names = []
    for symbol in [m.group(1) for m in SYMBOL.finditer(tex)]:
        places[symbol] = places.get(symbol, 0) + 1
        names.append(symbol if places[symbol] == 1 else f"{symbol}.{places[symbol]}")
    for glyph, owner in zip(glyphs, owners(tex, glyphs)):
        box.paths.append((None if owner is None else names[owner], outline(glyph)))
    for x, y, w, h in rects:
        box.paths.append((None, rectangle(x, -y - h, w, h)))
    return box


def matrix(cells, places):
    rows = [[mathtext(cell.strip(), places) for cell in row.split("&")] for row in cells.split(r"\\")]
    widths = [max(row[i].width for row in rows) for i in range(len(rows[0]))]
    bracket, between, axis = 0.28 * EM, 0.9 * EM, 0.27 * EM
    height = sum(max(b.height + b.depth for b in row) for row in rows) + 0.35 * EM * (len(rows) - 1)
    box = Box(sum(widths) + between * (len(widths) - 1) + 2 * bracket + 0.3 * EM)
    top = -axis - height / 2
    y = top
    for row in rows:
        above = max(b.height for b in row)
        x = bracket + 0.15 * EM
        for b, width in zip(row, widths):
            box.add(b, x + (width - b.width) / 2, y + above)
            x += width + between
        y += above + max(b.depth for b in row) + 0.35 * EM
    thick = 0.06 * EM
    top, height = top - 0.1 * EM, height + 0.2 * EM
    for x, arm in [(thick, 0.0), (box.width - 2 * thick, -bracket + 2 * thick)]:
        box.paths.append((None, rectangle(x, top, thick, height)))
        for at in [top, top + height - thick]:
            box.paths.append((None, rectangle(x + arm, at, bracket - thick, thick)))
    box.height, box.depth = -top, top + height
    return box


def line(tex, places):
    """Pieces of a line side by side: a matrix ends its line."""
    m = MATRIX.search(tex)
    if not m:
        return mathtext(tex, places)
    head, tail = mathtext(tex[:m.start()] + r"\;", places), matrix(m.group(1), places)
    box = Box(head.width + tail.width, max(head.height, tail.height), max(head.depth, tail.depth))
    box.add(head, 0)
    box.add(tail, head.width)
    return box


def number(v):
    text = f"{v:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def data(points):
    return "".join(command + " ".join(number(c) for pair in pairs for c in pair) for command, pairs in points)


def svg(equation):
    places = {}
    lines = [line(tex, places) for tex in equation["tex"]]
    whole, y = Box(max(b.width for b in lines)), 0.0
    for b in lines:
        whole.add(b, MARGIN, y + ABOVE + b.height)
        y += b.height + b.depth + GAP
    width, height = whole.width + 2 * MARGIN, y - GAP + 2 * ABOVE
    groups = {}
    for name, points in whole.paths:
        groups.setdefault(name, []).append(data(points))
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{number(width)}" height="{number(height)}" '
           f'viewBox="0 0 {number(width)} {number(height)}" color="black" fill="currentColor">']
    out.append(f"<title>{escape(equation['plain'])}</title>")
    out.append(f"<desc>{escape(chr(10).join(equation['tex']))}</desc>")
    for name, paths in groups.items():
        out.append("<g>" if name is None else f'<g id="{name}">')
        out += [f'<path d="{d}"/>' for d in paths]
        out.append("</g>")
    return "\n".join(out) + "\n</svg>\n"


def main():
    equations = json.loads((EXPLAIN / "equations.json").read_text())["equations"]
    folder = EXPLAIN / "equations"
    folder.mkdir(exist_ok=True)
    for old in folder.glob("*.svg"):
        old.unlink()
    for equation in equations:
        (folder / (equation["id"] + ".svg")).write_text(svg(equation))
    print(f"wrote {len(equations)} equations to {folder.relative_to(EXPLAIN.parent.parent)}")


if __name__ == "__main__":
    main()
