"""Draws the diagrams of the book: python3 book/diagrams.py FOLDER, by default book/src/images

diagrams/data_flow.svg     the types that a scene passes through, and the module of each step
diagrams/verlet_list.svg   pairs of one disk in a Verlet list, and how far disks may move
diagrams/tiles.svg         four tiles of a list and the border pairs between them
diagrams/annulus.svg       a, d_0, R, the rim and a ring, in a packing

Disks are those of fixtures/packings/hertz_N1000_p100.xyz. Needs Python and nothing else.
"""

import math
import re
import sys
from pathlib import Path

from pictures import write

HERE = Path(__file__).resolve().parent
PACKING = HERE.parent / "fixtures/packings/hertz_N1000_p100.xyz"
BLUE, ORANGE, GREY = "#0072b2", "#d55e00", "#888888"


def picture(width, height, title, parts):
    head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="13">'
    tip = '<marker id="tip" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="8" markerHeight="8" orient="auto"><path d="M0 1L10 5L0 9z"/></marker>'
    back = f'<rect width="{width}" height="{height}" fill="white"/>'
    return "\n".join([head, f"<title>{title}</title>", f"<defs>{tip}</defs>", back, *parts, "</svg>", ""])


def look(style):
    """Attributes of an element: `stroke_width=2` is stroke-width="2"."""
    return "".join(f' {key.replace("_", "-")}="{value}"' for key, value in style.items())


def text(x, y, words, anchor="start", **style):
    return f'<text x="{x:g}" y="{y:g}" text-anchor="{anchor}"{look(style)}>{words}</text>'


def circle(x, y, radius, **style):
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}"{look(style)}/>'


def line(x1, y1, x2, y2, **style):
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"{look(style)}/>'


def disks_of(path):
    """Side of the box, and (x, y, radius) of every disk."""
    rows = path.read_text(encoding="utf-8").splitlines()
    side = float(re.search(r'Lattice="([0-9.]+)', rows[1]).group(1))
    columns = [row.split() for row in rows[2:]]
    return side, [(float(x) % side, float(y) % side, float(radius)) for _, x, y, _, radius, _ in columns]


def image(distance, side):
    return distance - side * round(distance / side)


def separation(a, b, side):
    return image(b[0] - a[0], side), image(b[1] - a[1], side)


def data_flow():
    boxes = [
        ("Scene", ["law, mixture,", "inflation,", "observables"], "scene"),
        ("Packing", ["disks in", "a periodic box", ""], "packing, io"),
        ("Relaxed&lt;Packing&gt;", ["at rest:", "proven by", "its type"], "relax"),
        ("Inflated", ["two states at rest,", "before and after", ""], "inflation"),
        ("DisplacementField", ["d_i of every disk,", "backbone marked", ""], "displacement"),
        ("observables", ["profiles, spectra,", "contacts, fits,", "phase"], "observe, fit, response"),
        ("Report", ["tables, figures,", "the scene itself", ""], "report"),
    ]
    steps = ["random points", "relax, prepare", "inflate, relax", "after − before", "average, fit", "write"]
    width, height, left, top = 150, 104, 20, 34
    gap = 92
    parts, places = [], []
    for k, (name, words, module) in enumerate(boxes):
        # Four boxes in the upper row, from left to right; three in the lower row.
        row, column = divmod(k, 4)
        x, y = left + (width + gap) * column, top + row * (height + 88)
        places.append((x, y))
        parts.append(f'<rect x="{x}" y="{y}" width="{width}" height="{height}" rx="6" fill="#eef4f9" stroke="{BLUE}" stroke-width="1.5"/>')
        parts.append(text(x + width / 2, y + 22, name, "middle", font_weight="bold", font_family="monospace"))
        for number, word in enumerate(words):
            parts.append(text(x + width / 2, y + 42 + 16 * number, word, "middle"))
        parts.append(text(x + width / 2, y + height + 17, module, "middle", fill=GREY, font_family="monospace", font_size=12))
    for k, step in enumerate(steps):
        (x1, y1), (x2, y2) = places[k], places[k + 1]
        if y1 == y2:
            y = y1 + height / 2
            parts.append(line(x1 + width + 2, y, x2 - 3, y, stroke="black", stroke_width=1.5, marker_end="url(#tip)"))
            words = step.replace(", ", ",|").split("|") if ", " in step else step.rsplit(" ", 1) if len(step) > 11 else [step]
            for number, word in enumerate(words):
                parts.append(text(x1 + width + gap / 2, y - 8 - 15 * (len(words) - 1 - number), word, "middle", font_size=12))
        else:
            middle, below = x1 + width / 2, y1 + height + 44
            parts.append(f'<path d="M{middle} {y1 + height + 24}V{below}H{x2 + width / 2}V{y2 - 3}" fill="none" stroke="black" stroke-width="1.5" '
                         'marker-end="url(#tip)"/>')
            parts.append(text((middle + x2 + width / 2) / 2, below - 6, step, "middle", font_size=12))
    bottom = top + 2 * height + 88
    x, y = places[-1]
    parts.append(text(x + width + 26, y + 30, "report.html to look at", font_size=12))
    parts.append(text(x + width + 26, y + 50, "report.json, *.csv for programs", font_size=12))
    parts.append(text(x + width + 26, y + 70, "*.xyz to go on from", font_size=12))
    parts.append(text(left, 20, "run: one line for each arrow", fill=GREY, font_size=12))
    return picture(4 * width + 3 * gap + 2 * left, bottom + 30, "From a scene to a report: the types and the modules", parts)


def verlet_list():
    side, disks = disks_of(PACKING)
    skin, scale = 0.25, 66.0

    def in_skin(k):
        gaps = [math.hypot(*separation(disks[k], disk, side)) - disks[k][2] - disk[2] for disk in disks if disk is not disks[k]]
        return sum(0 <= gap < skin for gap in gaps) if sum(gap < 0 for gap in gaps) >= 4 else 0

    # A large disk with at least four contacts and the most pairs in the skin.
    chosen = max((k for k in range(len(disks)) if disks[k][2] == 0.7), key=in_skin)
    centre = disks[chosen]
    parts = ['<clipPath id="left"><rect x="10" y="30" width="400" height="400"/></clipPath>', '<g clip-path="url(#left)">']
    to = lambda j: tuple(210 + sign * scale * d for sign, d in zip((1, 1), separation(centre, disks[j], side)))
    pairs = []
    for j, disk in enumerate(disks):
        x, y = separation(centre, disk, side)
        distance = math.hypot(x, y)
        if max(abs(x), abs(y)) > 4 or j == chosen:
            continue
        gap = distance - centre[2] - disk[2]
        kind = "contact" if gap < 0 else "skin" if gap < skin else "far"
        fill = {"contact": "#f3c9ae", "skin": "#cfe3f1", "far": "#eeeeee"}[kind]
        parts.append(circle(to(j)[0], to(j)[1] + 20, scale * disk[2], fill=fill, stroke="#999999"))
        pairs.append((kind, j))
    parts.append(circle(210, 230, scale * (centre[2] + skin), fill="none", stroke=BLUE, stroke_width=1.5, stroke_dasharray="6 4"))
    parts.append(circle(210, 230, scale * centre[2], fill="#f7efd0", stroke="black", stroke_width=1.5))
    for kind, j in pairs:
        if kind != "far":
            style = {"stroke": ORANGE, "stroke_width": 2.5} if kind == "contact" else {"stroke": BLUE, "stroke_width": 2, "stroke_dasharray": "5 4"}
            parts.append(line(210, 230, to(j)[0], to(j)[1] + 20, **style))
    parts += [circle(210, 230, 3), "</g>", '<rect x="10" y="30" width="400" height="400" fill="none" stroke="#999999"/>']
    parts.append(text(202, 252, "i", "end", font_style="italic", font_size=16))
    parts.append(text(10, 20, "The pairs of disk i", font_weight="bold"))
    counts = {kind: sum(k == kind for k, _ in pairs) for kind in ("contact", "skin")}
    for number, (colour, dash, words) in enumerate([
        (ORANGE, "", f"listed, in contact: {counts['contact']} pairs"),
        (BLUE, "5 4", f"listed, a gap below the skin: {counts['skin']} pair" + "s" * (counts["skin"] != 1)),
    ]):
        y = 452 + 20 * number
        parts.append(line(14, y - 4, 50, y - 4, stroke=colour, stroke_width=2.5, stroke_dasharray=dash or "none"))
        parts.append(text(58, y, words))
    parts.append(text(58, 492, "grey: not listed; it does not reach the dashed circle, R_i + s"))
    # The right half: the worst case of a pair that is not listed.
    x, r1, r2, s = 470, 58, 46, 40
    parts.append(text(x, 20, "Why the list holds until a disk has moved by s/2", font_weight="bold"))
    for y, words, moved in ((120, "When the list is built: a gap of s, not listed", 0), (300, "Both have moved by s/2, towards each other: they touch", s / 2)):
        left, right = x + 70, x + 70 + r1 + r2 + s
        parts.append(text(x, y - 74, words))
        if moved:
            for place, radius in ((left, r1), (right, r2)):
                parts.append(circle(place, y, radius, fill="none", stroke="#999999", stroke_dasharray="4 4"))
        parts.append(circle(left + moved, y, r1, fill="#f7efd0", stroke="black"))
        parts.append(circle(right - moved, y, r2, fill="#eeeeee", stroke="black"))
        if moved:
            parts.append(line(left, y, left + moved, y, stroke="black", stroke_width=1.5, marker_end="url(#tip)"))
            parts.append(line(right, y, right - moved, y, stroke="black", stroke_width=1.5, marker_end="url(#tip)"))
            parts.append(text(left - 2, y + 20, "s/2", "middle"))
            parts.append(text(right + 2, y + 20, "s/2", "middle"))
        else:
            parts.append(line(left + r1 + 1, y, right - r2 - 1, y, stroke=BLUE, stroke_width=1.5))
            parts.append(text(left + r1 + s / 2, y - 8, "s", "middle", fill=BLUE, font_style="italic"))
            parts.append(text(left, y + 5, "R_i", "middle"))
            parts.append(text(right, y + 5, "R_j", "middle"))
    parts.append(text(x, 402, "A wide skin: more pairs in every step, fewer lists."))
    parts.append(text(x, 422, "A narrow skin: fewer pairs, more lists."))
    parts.append(text(x, 452, "Left: a packing at p = 100 and s = 0.25,"))
    parts.append(text(x, 472, "half of the smallest radius."))
    return picture(850, 505, "Verlet list with its skin", parts)


def tiles():
    side, disks = disks_of(PACKING)
    cells = int(side / 1.65)
    key = lambda k: (min(int(disks[k][1] / side * cells), cells - 1), min(int(disks[k][0] / side * cells), cells - 1), k)
    order = sorted(range(len(disks)), key=key)
    size, skin, scale, left, top = 250, 0.25, 16.0, 12, 12
    tile_of = {disk: place // size for place, disk in enumerate(order)}
    spot = lambda k: (left + scale * disks[k][0], top + scale * (side - disks[k][1]))
    colours = ["#dcebf5", "#fdf1d6", "#dff1ea", "#f6e3ee"]
    border, touched = [], set()
    for place, i in enumerate(order):
        for j in order[place + 1:]:
            x, y = separation(disks[i], disks[j], side)
            if abs(x) > 1.7 or abs(y) > 1.7 or math.hypot(x, y) >= disks[i][2] + disks[j][2] + skin:
                continue
            px, py = spot(i)
            move = f"M{px:.0f} {py:.0f}l{scale * x:.0f} {-scale * y:.0f}"
            if tile_of[i] != tile_of[j]:
                border.append(move)
                touched.update((i, j))
                if abs(disks[i][1] - disks[j][1]) > side / 2:  # through the side of the box: drawn from both ends
                    qx, qy = spot(j)
                    border.append(f"M{qx:.0f} {qy:.0f}l{-scale * x:.0f} {scale * y:.0f}")
    # The longest run of disks that no pair across the border touches, of the second tile.
    begin, best = size, (0, 0)
    for place in range(size, 2 * size + 1):
        if place == 2 * size or order[place] in touched:
            best = max(best, (place - begin, begin))
            begin = place + 1
    interior = set(order[best[1]:best[1] + best[0]])
    width = scale * side
    parts = [f'<clipPath id="box"><rect x="{left}" y="{top}" width="{width:.1f}" height="{width:.1f}"/></clipPath>', '<g clip-path="url(#box)">']
    for tile, colour in enumerate(colours):
        parts.append(f'<g fill="{colour}" stroke="#aaaaaa" stroke-width="0.7">')
        parts += [circle(*spot(k), scale * disks[k][2]) for k in order[tile * size:(tile + 1) * size] if k not in interior]
        parts.append("</g>")
    parts.append('<g fill="#f0c75e" stroke="#8a6d1f" stroke-width="0.7">')
    parts += [circle(*spot(k), scale * disks[k][2]) for k in interior]
    parts.append("</g>")
    parts.append(f'<path d="{"".join(border)}" stroke="{ORANGE}" stroke-width="1.8" fill="none"/></g>')
    parts.append(f'<rect x="{left}" y="{top}" width="{width:.1f}" height="{width:.1f}" fill="none" stroke="black"/>')
    x, y = left + width + 22, top + 14
    for tile in (3, 2, 1, 0):
        middle = top + scale * (side - sum(disks[k][1] for k in order[tile * size:(tile + 1) * size]) / size)
        parts.append(text(x, middle - 18, f"tile {tile}", font_weight="bold"))
        if tile == 1:
            parts.append(f'<rect x="{x}" y="{middle - 4:.0f}" width="14" height="14" fill="#f0c75e" stroke="#8a6d1f"/>')
            parts.append(text(x + 22, middle + 8, f"interior: {best[0]} disks in a row"))
            parts.append(text(x + 22, middle + 25, "that no border pair touches"))
        if tile == 2:
            parts.append(line(x, middle, x + 18, middle, stroke=ORANGE, stroke_width=2))
            parts.append(text(x + 26, middle + 4, "border pairs: one tile stores their"))
            parts.append(text(x + 26, middle + 21, "forces; the other tile subtracts"))
            parts.append(text(x + 26, middle + 38, "them from its disks afterwards"))
        if tile == 3:
            parts.append(text(x, middle + 4, "250 disks here, 8192 or more"))
            parts.append(text(x, middle + 21, "in the program; consecutive in"))
            parts.append(text(x, middle + 38, "memory, in the order of the cells"))
        if tile == 0:
            parts.append(text(x, middle + 4, "the box is periodic: tiles 0 and 3"))
            parts.append(text(x, middle + 21, "share a border, too"))
    return picture(round(left + width + 22 + 262), round(2 * top + width), "Four tiles of a list and their border pairs", parts)


def annulus():
    side, disks = disks_of(PACKING)
    middle = min((k for k in range(len(disks)) if disks[k][2] == 0.5),
                 key=lambda k: math.hypot(disks[k][0] - side / 2, disks[k][1] - side / 2))
    # The held rim is four times as wide as the largest radius, and has images of the disks where the box ends.
    centre, outer, scale, x0, y0 = disks[middle], 0.48 * side, 14.0, 296.0, 296.0
    groups = {"held": [], "mobile": [], "ring": []}
    for k, disk in enumerate(disks):
        nearest = separation(centre, disk, side)
        for x, y in ((nearest[0] + i * side, nearest[1] + j * side) for i in (-1, 0, 1) for j in (-1, 0, 1)):
            distance = math.hypot(x, y)
            kind = "held" if distance >= outer else "ring" if abs(distance / outer - 0.5) <= 0.03 else "mobile"
            if k != middle and distance < outer + 4 * 0.7:
                groups[kind].append(circle(x0 + scale * x, y0 - scale * y, scale * disk[2]))
    parts = []
    for kind, fill, stroke in (("held", "#b5b5b5", "#8c8c8c"), ("mobile", "#f6f6f6", "#b8b8b8"), ("ring", "#a9cfe8", BLUE)):
        parts.append(f'<g fill="{fill}" stroke="{stroke}" stroke-width="0.8">{"".join(groups[kind])}</g>')
    for share in (0.47, 0.53):
        parts.append(circle(x0, y0, scale * outer * share, fill="none", stroke=BLUE, stroke_width=1.2, stroke_dasharray="5 3"))
    parts.append(circle(x0, y0, scale * outer, fill="none", stroke="black", stroke_width=2))
    parts.append(circle(x0, y0, scale * 0.6, fill=ORANGE, stroke="none"))
    angle = math.radians(35)
    tip = (x0 + scale * outer * math.cos(angle), y0 - scale * outer * math.sin(angle))
    parts.append(line(x0, y0, *tip, stroke="black", stroke_width=1.6, marker_end="url(#tip)"))
    label = (x0 + 0.76 * (tip[0] - x0), y0 + 0.76 * (tip[1] - y0))
    parts.append(f'<rect x="{label[0] - 11:.1f}" y="{label[1] - 11:.1f}" width="22" height="22" rx="4" fill="white"/>')
    parts.append(text(round(label[0], 1), round(label[1] + 6, 1), "R", "middle", font_size=17, font_style="italic"))
    # The inflated disk, larger.
    cx, cy, zoom = 760.0, 160.0, 130.0
    parts.append(line(x0 + 8, y0 - 8, cx - 88, cy + 28, stroke=ORANGE, stroke_width=1, stroke_dasharray="3 3"))
    parts.append(circle(cx, cy, zoom * 0.6, fill="#f6cfb5", stroke=ORANGE, stroke_width=2))
    parts.append(circle(cx, cy, zoom * 0.5, fill="#f9e6d9", stroke="black", stroke_width=1.5, stroke_dasharray="5 3"))
    parts.append(circle(cx, cy, 3))
    parts.append(line(cx, cy, cx - zoom * 0.5, cy, stroke="black", stroke_width=1.5, marker_end="url(#tip)"))
    parts.append(text(cx - zoom * 0.25, cy - 8, "a", "middle", font_size=17, font_style="italic"))
    parts.append(line(cx + zoom * 0.5, cy, cx + zoom * 0.6, cy, stroke=ORANGE, stroke_width=3))
    parts.append(line(cx + zoom * 0.56, cy - 3, cx + zoom * 0.78, cy - 24, stroke=ORANGE, stroke_width=1))
    parts.append(text(cx + zoom * 0.8, cy - 26, "d_0", font_size=16, fill=ORANGE))
    parts.append(text(cx, cy - zoom * 0.6 - 32, "the inflated disk, held at its centre", "middle", font_weight="bold"))
    parts.append(text(cx, cy - zoom * 0.6 - 14, "before: radius a; after: a + d_0", "middle"))
    x, y = 622, 300
    rows = [
        ("black", "#ffffff", "the rim, r = R: beyond it d = 0"),
        ("#8c8c8c", "#b5b5b5", "held disks, R ≤ r &lt; R + 2.8"),
        ("#b8b8b8", "#f6f6f6", "mobile disks, r &lt; R"),
        (BLUE, "#a9cfe8", "a ring, r̂ = r/R = 0.5 ± 0.03"),
    ]
    for number, (stroke, fill, words) in enumerate(rows):
        parts.append(circle(x + 8, y + 26 * number - 4, 8, fill=fill, stroke=stroke, stroke_width=2 if number == 0 else 1))
        parts.append(text(x + 26, y + 26 * number, words))
    parts.append(text(x, y + 128, "To scale: 1000 disks in the box, R = 17.6."))
    parts.append(text(x, y + 148, "In the study R = 42 to 170 and a = 0.5."))
    return picture(920, 598, "The annulus: a, d_0, R, the rim and a ring", parts)


def main():
    if len(sys.argv) > 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1]) if len(sys.argv) == 2 else HERE / "src/images"
    for name, make in (("data_flow", data_flow), ("verlet_list", verlet_list), ("tiles", tiles), ("annulus", annulus)):
        write(folder / "diagrams" / f"{name}.svg", make())


if __name__ == "__main__":
    main()
