#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the SVG figures of docs/theory and docs/architecture.md into the folder of this file.

    docs/images/theory/make_figures.py           # write all figures
    docs/images/theory/make_figures.py --check   # exit status 1 if a figure is not up to date

Needs only the standard library. The same script writes the same bytes.
"""

import heapq
import math
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
INK, GREY, PALE = "#1f2933", "#7b8794", "#cbd2d9"
BLUE, ORANGE, GREEN, RED, PURPLE = "#2b6cb0", "#c05621", "#2f855a", "#c53030", "#6b46c1"
FILLS = ["#bee3f8", "#feebc8", "#c6f6d5", "#fed7e2", "#e9d8fd", "#fefcbf", "#d9e2ec"]


class Drawing:
    """An SVG with a white background. Coordinates are pixels, y downwards."""

    def __init__(self, width, height, title):
        self.parts = [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
            f'width="{width}" height="{height}" '
            'font-family="Helvetica, Arial, sans-serif" font-size="14">',
            f"<title>{title}</title>",
            f'<rect width="{width}" height="{height}" fill="#ffffff"/>',
        ]

    @staticmethod
    def number(x):
        return f"{round(x, 1) + 0.0:.1f}".rstrip("0").rstrip(".")

    def points(self, points):
        return " ".join(f"{self.number(x)},{self.number(y)}" for x, y in points)

    def polygon(self, points, fill="none", stroke="none", width=1.5, opacity=1.0, dash=""):
        dashes = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(
            f'<polygon points="{self.points(points)}" fill="{fill}" fill-opacity="{opacity:g}" '
            f'stroke="{stroke}" stroke-width="{width:g}" stroke-linejoin="round"{dashes}/>'
        )

    def pieces(self, polygons, fill):
        path = "".join(
            "M" + "L".join(f"{self.number(x)} {self.number(y)}" for x, y in points) + "Z"
            for points in polygons
        )
        self.parts.append(f'<path d="{path}" fill="{fill}" stroke="{fill}" stroke-width="0.6"/>')

    def line(self, points, stroke=INK, width=1.5, dash="", arrow=False):
        dashes = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(
            f'<polyline points="{self.points(points)}" fill="none" stroke="{stroke}" '
            f'stroke-width="{width:g}" stroke-linejoin="round" stroke-linecap="round"{dashes}/>'
        )
        if arrow:
            (x0, y0), (x1, y1) = points[-2:]
            length = math.hypot(x1 - x0, y1 - y0)
            u, v = (x1 - x0) / length, (y1 - y0) / length
            self.polygon(
                [
                    (x1, y1),
                    (x1 - 9 * u + 4 * v, y1 - 9 * v - 4 * u),
                    (x1 - 9 * u - 4 * v, y1 - 9 * v + 4 * u),
                ],
                stroke,
            )

    def dot(self, at, radius=4.0, fill=INK, stroke="none", width=1.5):
        self.parts.append(
            f'<circle cx="{self.number(at[0])}" cy="{self.number(at[1])}" r="{radius:g}" '
            f'fill="{fill}" stroke="{stroke}" stroke-width="{width:g}"/>'
        )

    def text(self, at, words, anchor="start", fill=INK, size=14, weight="normal", family=""):
        words = words.replace("&", "&amp;").replace("<", "&lt;")
        font = f' font-family="{family}"' if family else ""
        self.parts.append(
            f'<text x="{self.number(at[0])}" y="{self.number(at[1])}" '
            f'text-anchor="{anchor}" fill="{fill}" '
            f'font-size="{size:g}" font-weight="{weight}"{font}>{words}</text>'
        )

    def box(self, x, y, width, height, fill, stroke=GREY):
        self.parts.append(
            f'<rect x="{self.number(x)}" y="{self.number(y)}" '
            f'width="{self.number(width)}" height="{self.number(height)}" '
            f'rx="6" fill="{fill}" stroke="{stroke}" stroke-width="1.2"/>'
        )

    def svg(self):
        return "\n".join(self.parts + ["</svg>"]) + "\n"


def oblique(origin, scale):
    """x to the right, y into the picture, z up."""
    return lambda x, y, z: (origin[0] + scale * (x + 0.42 * y), origin[1] - scale * (z + 0.30 * y))


def draw_cell(d, to, low=(0, 0, 0), front=INK, back=PALE):
    """The twelve edges of a unit cell, the three hidden ones pale."""
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    for a in corners:
        for axis in range(3):
            if a[axis]:
                continue
            b = tuple(1 if i == axis else a[i] for i in range(3))
            hidden = (0, 1, 0) in (a, b)
            d.line(
                [to(*(p + q for p, q in zip(low, a))), to(*(p + q for p, q in zip(low, b)))],
                back if hidden else front,
                1.2,
            )


def mean(points):
    return tuple(sum(c) / len(points) for c in zip(*points))


def surfel():
    d = Drawing(760, 330, "A surfel and its c-vertex")
    to = oblique((50, 275), 180)
    draw_cell(d, to)
    inside = (1, 0, 1)
    nodes = [(0.35, 0, 1), (1, 0, 0.42), (1, 0.62, 1)]
    d.polygon([to(*n) for n in nodes], FILLS[0], BLUE, 2, 0.85)
    for corner in [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]:
        d.dot(to(*corner), 4.5, INK if corner == inside else "#ffffff", INK)
    for n in nodes:
        d.dot(to(*n), 5, ORANGE)
    c = to(*mean(nodes))
    d.dot(c, 5.5, BLUE)
    d.text((c[0] - 10, c[1] + 20), "c-vertex", "middle", BLUE)
    d.text((to(*nodes[0])[0] - 8, to(*nodes[0])[1] + 18), "node", "end", ORANGE)
    d.text((to(*nodes[1])[0] - 10, to(*nodes[1])[1] + 14), "node", "end", ORANGE)
    d.text((to(*nodes[2])[0] + 10, to(*nodes[2])[1] + 6), "node", fill=ORANGE)
    d.line([(to(0.72, 0.25, 0.95)[0], to(0.72, 0.25, 0.95)[1]), (225, 38)], BLUE, 1)
    d.text((229, 36), "surfel", "start", BLUE)
    d.dot((60, 312), 4.5, INK, INK)
    d.text((72, 317), "sample inside")
    d.dot((190, 312), 4.5, "#ffffff", INK)
    d.text((202, 317), "sample outside")

    to = oblique((400, 255), 110)
    for low in ((0, 1, 0), (1, 1, 0), (0, 0, 0), (1, 0, 0)):
        draw_cell(d, to, low, PALE, PALE)
    for loop in (
        [(0, 0, 0), (2, 0, 0), (2, 0, 1), (0, 0, 1)],
        [(0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)],
        [(2, 0, 0), (2, 2, 0), (2, 2, 1), (2, 0, 1)],
    ):
        d.polygon([to(*p) for p in loop], "none", GREY, 1.2)
    corners = [(0.5, 0.5, 0.42), (1.5, 0.5, 0.50), (1.5, 1.5, 0.66), (0.5, 1.5, 0.58)]
    d.polygon([to(*c) for c in corners], FILLS[0], BLUE, 2, 0.85)
    d.line([to(*corners[0]), to(*corners[2])], BLUE, 1.2, "5 4")
    d.line([to(*corners[1]), to(*corners[3])], BLUE, 1.2, "5 4")
    d.line([to(1, 1, 0), to(1, 1, 1)], INK, 2.5)
    d.dot(to(1, 1, 0), 4.5, INK, INK)
    d.dot(to(1, 1, 1), 4.5, "#ffffff", INK)
    d.dot(to(1, 1, 0.54), 5, ORANGE)
    for c in corners:
        d.dot(to(*c), 5.5, BLUE)
    d.line([(to(1, 1, 1)[0], to(1, 1, 1)[1] - 6), (to(1, 1, 1)[0], 62)], GREY, 1)
    d.text((to(1, 1, 1)[0], 55), "crossed grid edge", "middle")
    d.text((to(1, 1, 0.54)[0] - 8, to(1, 1, 0.54)[1] + 26), "node", "end", fill=ORANGE)
    d.text((400, 290), "face of the node: a quad of four c-vertices;", fill=BLUE)
    d.text((400, 309), "sides and diagonals are edges of the graph G", fill=BLUE)
    return d.svg()


def fan():
    d = Drawing(690, 250, "The face of a node becomes a fan")
    quad = [(-85, -45), (70, -75), (95, 60), (-60, 80)]
    for x, is_fan in ((140, False), (460, True)):
        corners = [(x + a, 120 + b) for a, b in quad]
        d.polygon(corners, FILLS[0], BLUE, 2)
        node = (x + 4, 122)
        if is_fan:
            for c in corners:
                d.line([node, c], BLUE, 2)
        else:
            d.line([corners[0], corners[2]], BLUE, 1.2, "5 4")
        d.dot(
            node, 6 if is_fan else 5, BLUE if is_fan else ORANGE, ORANGE if is_fan else "none", 2.5
        )
        for c in corners:
            d.dot(c, 5.5, BLUE)
    d.text((150, 150), "node", fill=ORANGE)
    d.line([(473, 118), (560, 62)], ORANGE, 1)
    d.text((563, 62), "the node is", fill=ORANGE, size=13)
    d.text((563, 78), "a c-vertex now", fill=ORANGE, size=13)
    d.line([(265, 120), (345, 120)], INK, 1.8, arrow=True)
    d.text((140, 232), "one quad, split at either diagonal", "middle")
    d.text((460, 232), "fan of four triangles", "middle")
    return d.svg()


def pseudo_random(seed):
    """Numbers in [0, 1), the same everywhere."""
    while True:
        seed = (1103515245 * seed + 12345) % 2**31
        yield seed / 2**31


def voronoi(columns, rows, sites):
    """Positions of a jittered grid of quads, and per vertex the nearest site.

    Distances are those of paths along sides and diagonals.
    """
    noise = pseudo_random(7)
    at = {
        (i, j): (i + 0.42 * (next(noise) - 0.5), j + 0.42 * (next(noise) - 0.5))
        for j in range(rows)
        for i in range(columns)
    }
    best = {}
    queue = [(0.0, k, s) for k, s in enumerate(sites)]
    heapq.heapify(queue)
    while queue:
        distance, k, v = heapq.heappop(queue)
        if v in best:
            continue
        best[v] = k
        for di in (-1, 0, 1):
            for dj in (-1, 0, 1):
                w = (v[0] + di, v[1] + dj)
                if w in at and w not in best:
                    heapq.heappush(queue, (distance + math.dist(at[v], at[w]), k, w))
    return at, best


def dual():
    columns, rows, scale = 11, 10, 21.5
    sites = [(1, 1), (5, 1), (9, 2), (2, 5), (6, 5), (4, 8), (9, 8)]
    at, label = voronoi(columns, rows, sites)
    d = Drawing(800, 300, "Surface complex, Voronoi cells, dual")
    for panel, title in enumerate(("surface complex and sites", "Voronoi cells", "dual mesh")):
        x0, y0 = 24 + 262 * panel, 30
        to = lambda p: (x0 + scale * (p[0] + 0.2), y0 + scale * (p[1] + 0.2))
        quads = [
            [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            for j in range(rows - 1)
            for i in range(columns - 1)
        ]
        pieces = {k: [] for k in range(len(sites))}
        for q in quads:
            points = [at[v] for v in q]
            centre = mean(points)
            for k in range(4):
                piece = [
                    points[k],
                    mean([points[k], points[(k + 1) % 4]]),
                    centre,
                    mean([points[k], points[k - 1]]),
                ]
                pieces[label[q[k]]].append([to(p) for p in piece])
        if panel > 0:
            for k, polygons in pieces.items():
                d.pieces(polygons, FILLS[k])
        if panel < 2:
            for j in range(rows):
                d.line([to(at[i, j]) for i in range(columns)], PALE if panel == 0 else "#ffffff", 1)
            for i in range(columns):
                d.line([to(at[i, j]) for j in range(rows)], PALE if panel == 0 else "#ffffff", 1)
        for q in quads:
            points = [at[v] for v in q]
            if panel == 2 and len({label[v] for v in q}) >= 3:
                d.polygon([to(p) for p in points], "#ffffff", RED, 1.6, 0.55)
        if panel < 2:
            for v in at:
                d.dot(to(at[v]), 2.2, GREY)
        if panel == 2:
            edges = set()
            for q in quads:
                cells = []
                for v in q:
                    if label[v] not in cells:
                        cells.append(label[v])
                if len(cells) == 3:
                    edges.update(
                        tuple(sorted((cells[a], cells[b]))) for a, b in ((0, 1), (1, 2), (0, 2))
                    )
                if len(cells) == 4:
                    diagonal = min(
                        ((0, 2), (1, 3)),
                        key=lambda e: math.dist(at[sites[cells[e[0]]]], at[sites[cells[e[1]]]]),
                    )
                    edges.update(
                        tuple(sorted((cells[a], cells[b])))
                        for a, b in ((0, 1), (1, 2), (2, 3), (3, 0), diagonal)
                    )
            for a, b in sorted(edges):
                d.line([to(at[sites[a]]), to(at[sites[b]])], INK, 2.2)
        for s in sites:
            d.dot(to(at[s]), 6, INK, "#ffffff", 1.5)
        d.text((x0 + scale * 5.2, 268), title, "middle")
    d.dot((30, 287), 2.2, GREY)
    d.text((38, 291), "c-vertex", size=12)
    d.dot((106, 287), 5, INK)
    d.text((116, 291), "site", size=12)
    d.polygon([(520, 281), (532, 281), (532, 293), (520, 293)], "#ffffff", RED, 1.6)
    d.text((539, 291), "face with corners in three or more cells", size=12)
    return d.svg()


def arc(cx, cy, rx, ry, start, end, steps=40):
    return [
        (
            cx + rx * math.cos(math.radians(start + (end - start) * k / steps)),
            cy + ry * math.sin(math.radians(start + (end - start) * k / steps)),
        )
        for k in range(steps + 1)
    ]


def closed_ball():
    d = Drawing(800, 370, "Partitions that violate the closed ball property")
    A, B, C = FILLS[0], FILLS[1], FILLS[2]
    # A ring around a disk.
    d.polygon([(30, 40), (230, 40), (230, 220), (30, 220)], C, GREY, 1.2)
    d.polygon(arc(130, 130, 75, 75, 0, 360), A, RED, 2.5)
    d.polygon(arc(130, 130, 32, 32, 0, 360), B, RED, 2.5)
    d.text((130, 135), "B", "middle", weight="bold")
    d.text((130, 78), "A", "middle", weight="bold")
    d.text((50, 66), "C", weight="bold")
    for x, name in ((60, "C"), (130, "A"), (200, "B")):
        if x > 60:
            d.line([(x - 70, 285), (x, 285)], INK, 2)
    for x, name in ((60, "C"), (130, "A"), (200, "B")):
        d.dot((x, 285), 5)
        d.text((x, 274), name, "middle")
    d.text((130, 325), "A is a ring, not a disk:", "middle")
    d.text((130, 344), "no triangle at its edges", "middle", RED)
    # A tube of two halves.
    x, top, bottom, rx, ry = 380, 60, 205, 70, 20
    d.polygon(arc(x, top, rx, ry, 180, 360) + [(x + rx, bottom), (x - rx, bottom)], B, "none")
    d.polygon(arc(x, top, rx, ry, 180, 0) + arc(x, bottom, rx, ry, 0, 180), A, "none")
    d.line(arc(x, top, rx, ry, 0, 360), GREY, 1.2)
    d.line(arc(x, bottom, rx, ry, 0, 180), GREY, 1.2)
    for side in (-rx, rx):
        d.line([(x + side, top), (x + side, bottom)], RED, 3)
    d.text((x, 150), "A", "middle", weight="bold")
    d.text((x, 60), "B", "middle", weight="bold")
    d.line(arc(x, 285, 60, 18, 180, 360), INK, 2)
    d.line(arc(x, 285, 60, 18, 180, 0), INK, 2)
    for side, name in ((-60, "A"), (60, "B")):
        d.dot((x + side, 285), 5)
        d.text((x + side * 1.25, 290), name, "middle")
    d.text((x, 325), "A and B share two arcs:", "middle")
    d.text((x, 344), "one edge would stand for both", "middle", RED)
    # A sphere of three lunes.
    x, y, r = 620, 132, 85
    d.polygon(arc(x, y, r, r, 90, 270) + arc(x, y, 18, r, -90, 90), A)
    d.polygon(arc(x, y, r, r, -90, 90) + arc(x, y, 18, r, 90, -90), B)
    d.line(arc(x, y, r, r, 0, 360), RED, 2.5)
    d.line(arc(x, y, 18, r, -90, 90), RED, 2.5)
    d.text((x - 35, y + 5), "A", "middle", weight="bold")
    d.text((x + 52, y + 5), "B", "middle", weight="bold")
    d.text((x + 92, y - 52), "C: the back", "start", size=13)
    for side in (-r, r):
        d.dot((x, y + side), 5.5, RED)
    corners = [(x - 52, 299), (x + 52, 299), (x, 255)]
    d.polygon(corners, FILLS[6], INK, 2)
    d.polygon(
        [
            (px, py + (5 if k < 2 else 6))
            for k, (px, py) in enumerate([(x - 42, 291), (x + 42, 291), (x, 258)])
        ],
        "none",
        INK,
        1.2,
    )
    for c, name, offset in zip(corners, "ABC", ((-12, 5), (12, 5), (13, 2))):
        d.dot(c, 5)
        d.text((c[0] + offset[0], c[1] + offset[1]), name, "middle")
    d.text((x, 325), "A, B, C share two points:", "middle")
    d.text((x, 344), "the same triangle twice", "middle", RED)
    d.text((20, 22), "partition", fill=GREY, size=12)
    d.text((20, 252), "dual", fill=GREY, size=12)
    return d.svg()


def vertex_fan():
    d = Drawing(720, 230, "Fans of triangles around a vertex")

    def draw(centre, angles, fill):
        outer = [
            (centre[0] + 72 * math.cos(math.radians(a)), centre[1] - 72 * math.sin(math.radians(a)))
            for a in angles
        ]
        for a, b in zip(outer, outer[1:]):
            d.polygon([centre, a, b], fill, INK, 1.5)
        for p in outer:
            d.dot(p, 3.5)

    draw((120, 100), [20, 75, 140, 195, 255, 310, 380], FILLS[2])
    draw((360, 120), [5, 50, 95, 140, 185], FILLS[2])
    draw((600, 100), [-35, 0, 40], FILLS[3])
    draw((600, 100), [140, 180, 220], FILLS[3])
    for x, y in ((120, 100), (360, 120), (600, 100)):
        d.dot((x, y), 5.5, BLUE)
    for x, words, colour in (
        (120, "closed fan: interior vertex", GREEN),
        (360, "open fan: boundary vertex", GREEN),
        (600, "two fans: not a manifold", RED),
    ):
        d.text((x, 212), words, "middle", colour)
    return d.svg()


def sizing_field():
    d = Drawing(760, 290, "The sizing field")
    left, right, base, top = 60, 730, 240, 50
    lows = [(150, 30.0), (470, 58.0)]  # where the field was lowered, and to what

    def h(x):
        return min([150.0] + [low + abs(x - at) / 3 for at, low in lows])

    scale = 1.0
    curve = [(x, base - scale * h(x)) for x in range(left, right + 1, 2)]
    sites = [(150.0, 0)]
    for step in (1, -1):
        at = 150.0
        while True:
            new = at
            while left <= new <= right and abs(new - at) < max(h(new), 1.0):
                new += step
            if not left + 12 <= new <= right - 12:
                break
            sites.append((new, 0))
            at = new
    for site, _ in sorted(sites):
        r = h(site)
        d.polygon(arc(site, base, r, r, 180, 360), FILLS[0], BLUE, 1.2, 0.55)
    d.line(curve, ORANGE, 2.8)
    d.line([(left, base), (right + 12, base)], INK, 1.8, arrow=True)
    d.line([(left, base), (left, top - 15)], INK, 1.8, arrow=True)
    for site, _ in sorted(sites):
        d.dot((site, base), 5)
    d.text((right + 10, base + 24), "position along the surface", "end")
    d.text((left + 10, top - 4), "radius", fill=INK)
    d.text((690, base - scale * h(690) - 12), "h", "middle", ORANGE, 17, "bold")
    for (at, low), name in zip(lows, "ab"):
        d.line([(at, base - scale * low - 4), (at, base - scale * low - 44)], GREY, 1, "4 3")
        d.text((at, base - scale * low - 50), f"({name}) h was lowered here", "middle", size=13)
    x1 = 250
    d.line(
        [
            (x1, base - scale * h(x1)),
            (x1 + 45, base - scale * h(x1)),
            (x1 + 45, base - scale * h(x1 + 45)),
        ],
        GREY,
        1.2,
    )
    d.text((x1 + 52, base - scale * h(x1 + 22) + 12), "slope 1/3", size=13)
    d.dot((80, 272), 5)
    d.text((92, 277), "site")
    d.polygon(arc(160, 278, 14, 14, 180, 360), FILLS[0], BLUE, 1.2)
    d.text((182, 277), "disk of the site, radius h")
    return d.svg()


def multi_sheet():
    d = Drawing(780, 310, "A multi-sheet grid cell")
    to = oblique((30, 240), 150)
    draw_cell(d, to)
    first = [(0.55, 0, 0), (0, 0.55, 0), (0, 0, 0.5)]
    second = [(0.4, 1, 1), (1, 0.4, 1), (1, 1, 0.45)]
    for nodes, fill, colour in ((second, FILLS[1], ORANGE), (first, FILLS[0], BLUE)):
        d.polygon([to(*n) for n in nodes], fill, colour, 2, 0.8)
        for n in nodes:
            d.dot(to(*n), 3.5, colour)
        d.dot(to(*mean(nodes)), 5.5, colour)
    d.text((125, 285), "two surfels in one grid cell", "middle")

    def section(x, c_low, c_high, words, colour):
        size, y = 170, 60
        d.polygon([(x, y), (x + size, y), (x + size, y + size), (x, y + size)], "none", INK, 1.4)
        low = [(x, y + 105), (x + c_low[0], y + c_low[1]), (x + size, y + 125)]
        high = [(x, y + 62), (x + c_high[0], y + c_high[1]), (x + size, y + 72)]
        d.line(low, BLUE, 2.5)
        d.line(high, ORANGE, 2.5)
        for points, stroke in ((low, BLUE), (high, ORANGE)):
            d.dot(points[0], 3.5, stroke)
            d.dot(points[2], 3.5, stroke)
            d.dot(points[1], 6, stroke)
        d.text((x + size / 2, 285), words, "middle", colour)
        return low, high

    section(310, (75, 70), (98, 112), "the cones intersect", RED)
    d.line([(495, 145), (545, 145)], INK, 1.8, arrow=True)
    section(560, (80, 116), (92, 68), "c-vertices moved apart", GREEN)
    d.text((395, 48), "cross-section", "middle", GREY, 12)
    d.text((645, 48), "cross-section", "middle", GREY, 12)
    return d.svg()


def types():
    d = Drawing(900, 625, "The main types and what makes them")
    mono = "monospace"

    def box(x, y, width, name, lines, fill="#ffffff"):
        height = 30 + 18 * len(lines)
        d.box(x, y, width, height, fill)
        d.text((x + 12, y + 21), name, weight="bold", size=14)
        for k, words in enumerate(lines):
            d.text((x + 12, y + 41 + 18 * k), words, size=12)

    def arrow(points, words="", at=(0, 0), anchor="middle"):
        d.line(points, INK, 1.6, arrow=True)
        if words:
            d.text(at, words, anchor, BLUE, 12, family=mono)

    box(
        20,
        50,
        190,
        "VolumeView",
        ["samples in their own type", "Grid: size, spacing, origin"],
        FILLS[5],
    )
    arrow([(210, 83), (345, 83)], "parse_surface()", (277, 74))

    d.box(345, 20, 535, 138, FILLS[0])
    d.text((358, 42), "AdaptiveSurface", weight="bold")
    d.text((500, 42), "the reference surface, subdivided where needed", size=12)
    box(
        358,
        55,
        200,
        "SurfaceComplex",
        ["c-vertices with positions", "faces: triangles and quads", "boundary sides"],
    )
    box(570, 55, 145, "Components", ["topology of each"])
    box(727, 55, 142, "Nesting", ["orientation, parent"])

    arrow([(390, 158), (390, 190), (150, 190), (150, 225)], "make_graph()", (270, 182))
    arrow([(560, 158), (560, 225)], "coarsen()", (568, 196), "start")
    box(
        35,
        225,
        235,
        "CVertexGraph",
        ["the graph G: neighbours in", "cyclic order, edge lengths"],
        FILLS[0],
    )
    box(
        430,
        225,
        270,
        "Coarsened",
        ["a smaller SurfaceComplex, certified,", "with a representative per c-vertex"],
        FILLS[0],
    )
    arrow([(430, 258), (270, 258)], "make_graph()", (350, 250))

    d.box(20, 340, 860, 140, FILLS[2])
    arrow([(150, 291), (150, 378)], "Covering::cover()", (160, 322), "start")
    d.text((175, 362), "MeasuredCovering", weight="bold")
    d.text(
        (330, 362),
        "the state of a refined level; for level 0, CoarseMesher holds the first two boxes",
        size=12,
    )
    box(
        35,
        378,
        230,
        "Covering",
        ["distance, radius and Voronoi cell", "of each c-vertex;", "Partition: cell_of, site"],
    )
    box(290, 378, 175, "CertifiedDual", ["DualTriangles;", "checks and repairs", "the Partition"])
    box(490, 378, 170, "LevelMesh", ["points and triangles,", "c-vertices per cell"])
    box(690, 378, 178, "VertexPlacement", ["anchor c-vertex and", "displacement of each", "vertex"])
    arrow([(265, 420), (290, 420)])
    arrow([(465, 410), (490, 410)])
    arrow([(690, 410), (660, 410)])

    arrow([(230, 480), (230, 545)], "extract(): level 0", (240, 508), "start")
    d.text((240, 526), "LevelMaker::add_level(): others", "start", BLUE, 12, family=mono)
    arrow([(620, 480), (620, 545)])
    box(
        90,
        545,
        290,
        "Hierarchy",
        ["positions, shared by all levels;", "triangles of each level"],
        FILLS[1],
    )
    box(
        470,
        545,
        300,
        "ExtractReport",
        ["certificate, topology, metrics and", "shape of each level"],
        FILLS[1],
    )
    return d.svg()


FIGURES = {
    "surfel": surfel,
    "fan": fan,
    "dual": dual,
    "closed-ball": closed_ball,
    "vertex-fan": vertex_fan,
    "sizing-field": sizing_field,
    "multi-sheet": multi_sheet,
    "types": types,
}


def main():
    check = sys.argv[1:] == ["--check"]
    if sys.argv[1:] and not check:
        sys.exit(__doc__)
    stale = []
    for name, draw in FIGURES.items():
        path, text = FOLDER / f"{name}.svg", draw()
        if check:
            if not path.exists() or path.read_text(encoding="utf-8") != text:
                stale.append(path.name)
        else:
            path.write_text(text, encoding="utf-8", newline="\n")
    if stale:
        sys.exit(f"{', '.join(stale)}: not what make_figures.py draws; run it without --check")


if __name__ == "__main__":
    main()
