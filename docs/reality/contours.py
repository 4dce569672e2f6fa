# SPDX-License-Identifier: BSD-3-Clause
"""Level lines of a picture by marching squares, and truth files of them as `glint evaluate --truth` reads them.

Points are (x, y) in pixels; whole numbers are pixel centres. Nothing here is Glint's own code: truth comes from elsewhere.
"""
import json

import numpy as np

# Edges of a cell with corners 0 (y, x), 1 (y, x+1), 2 (y+1, x+1), 3 (y+1, x), by number: top, right, bottom, left. For each
# pattern of corners above the level, the pairs of edges that a line joins. Patterns 5 and 10 are saddles: the cell's mean tells.
PAIRS = {1: [(3, 0)], 2: [(0, 1)], 3: [(3, 1)], 4: [(1, 2)], 6: [(0, 2)], 7: [(3, 2)], 8: [(2, 3)], 9: [(2, 0)], 11: [(2, 1)],
         12: [(1, 3)], 13: [(1, 0)], 14: [(0, 3)]}
SADDLES = {(5, True): [(3, 2), (1, 0)], (5, False): [(3, 0), (1, 2)],
           (10, True): [(0, 3), (2, 1)], (10, False): [(0, 1), (2, 3)]}


def edge_of(y, x, number):
    """A name that neighbouring cells share: (row, column, 0 for a horizontal edge or 1 for a vertical one)."""
    return [(y, x, 0), (y, x + 1, 1), (y + 1, x, 0), (y, x, 1)][number]


def crossing(values, level, edge):
    y, x, vertical = edge
    a, b = values[y, x], values[y + vertical, x + 1 - vertical]
    t = (level - a) / (b - a)
    return [x + t * (1 - vertical), y + t * vertical]


def walk(links, start, previous=None):
    """Edges from `start` on, until the line ends or comes back."""
    line, here = [start], start
    while True:
        onward = [e for e in links[here] if e != previous]
        if not onward or onward[0] == start:
            return line, bool(onward)
        previous, here = here, onward[0]
        line.append(here)


def level_lines(values, level):
    """List of (points, closed); lines that meet the picture's border are open."""
    values = np.asarray(values, float)
    above = values > level
    pattern = above[:-1, :-1] + 2 * above[:-1, 1:] + 4 * above[1:, 1:] + 8 * above[1:, :-1]
    links = {}
    for y, x in np.argwhere((pattern > 0) & (pattern < 15)):
        p = int(pattern[y, x])
        middle = bool(values[y:y + 2, x:x + 2].mean() > level)
        for a, b in PAIRS.get(p) or SADDLES[p, middle]:
            a, b = edge_of(y, x, a), edge_of(y, x, b)
            links.setdefault(a, []).append(b)
            links.setdefault(b, []).append(a)
    lines, seen = [], set()
    for edge in sorted(links, key=lambda e: len(links[e])):  # ends of open lines first
        if edge in seen:
            continue
        line, closed = walk(links, edge)
        seen.update(line)
        lines.append(([crossing(values, level, e) for e in line], closed))
    return lines


def area(points):
    x, y = np.asarray(points, float).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def smoothed(values, radius=2):
    """Each pixel replaced by the value of a quadratic fitted to its neighbourhood: less noise, curvature kept."""
    offsets = np.arange(-radius, radius + 1)
    v, u = (g.ravel().astype(float) for g in np.meshgrid(offsets, offsets, indexing="ij"))
    weights = np.linalg.pinv(np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], 1))[0].reshape(2 * radius + 1, -1)
    padded = np.pad(np.asarray(values, float), radius, mode="edge")
    out = np.zeros(np.shape(values))
    for i in range(2 * radius + 1):
        for j in range(2 * radius + 1):
            out += weights[i, j] * padded[i:i + out.shape[0], j:j + out.shape[1]]
    return out


def peak(values):
    """Place and height of the maximum: a paraboloid through the logarithms above nine tenths of the brightest pixel."""
    values = np.asarray(values, float)
    y0, x0 = np.unravel_index(np.argmax(values), values.shape)
    top = values[y0, x0]
    ys, xs = np.mgrid[max(y0 - 6, 0):y0 + 7, max(x0 - 6, 0):x0 + 7].reshape(2, -1)
    inside = (ys < values.shape[0]) & (xs < values.shape[1])
    ys, xs = ys[inside], xs[inside]
    near = values[ys, xs] > 0.9 * top
    if near.sum() < 9:  # a small highlight: the nine pixels around the brightest one
        near = (abs(ys - y0) < 2) & (abs(xs - x0) < 2) & (values[ys, xs] > 0)
    u, v = xs[near] - float(x0), ys[near] - float(y0)
    if near.sum() < 6:
        return [float(x0), float(y0)], float(top)
    quadratic = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], 1)
    c = np.linalg.lstsq(quadratic, np.log(values[ys[near], xs[near]]), rcond=None)[0]
    bend = np.array([[2 * c[3], c[4]], [c[4], 2 * c[5]]])
    if np.linalg.eigvalsh(bend)[1] >= 0:  # no maximum
        return [float(x0), float(y0)], float(top)
    at = -np.linalg.solve(bend, c[1:3])
    if np.abs(at).max() > 2:
        return [float(x0), float(y0)], float(top)
    return [float(x0 + at[0]), float(y0 + at[1])], float(np.exp(c[0] + 0.5 * c[1:3] @ at))


def truth_of(lamps, level=0.5, least=6.0):
    """The truth file of one frame: contours of each lamp's picture at a fraction of its own peak, of `least` px2 or more."""
    found, best = [], ([0.0, 0.0], 0.0)
    for picture in lamps:
        place, height = peak(picture)
        if height <= 0:
            continue
        best = max(best, (place, height), key=lambda p: p[1])
        lines = [(points, closed) for points, closed in level_lines(picture, level * height) if len(points) > 3]
        found += [{"closed": closed, "points": points} for points, closed in lines if abs(area(points)) >= least]
    return {"peak_subpixel": best[0], "levels": {f"{level:.2f}": found}}


def write_truth(folder, name, truth):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.json").write_text(json.dumps(truth))
