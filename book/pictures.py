"""Takes the pictures out of a report: python3 book/pictures.py report.html FOLDER

Writes FOLDER/three_phases.svg, map, radial profile and angular profiles of three samples side by side, and FOLDER/first_run/NAME.svg, the
other pictures of the sample in the middle. Needs Python and nothing else. A file is written under another name and then renamed.
"""

import os
import re
import sys
from pathlib import Path

WIDTH_GAP, HEAD = 16, 34


def sections(html):
    """Name and SVG elements of every sample."""
    for part in re.findall(r'<section class="sample".*?</section>', html, re.S):
        yield re.search(r"<h2>(.*?)</h2>", part).group(1), re.findall(r"<svg.*?</svg>", part, re.S)


def title(svg):
    return re.search(r"<title>(?:.*?: )?(.*?)</title>", svg, re.S).group(1)


def size(svg):
    return tuple(float(re.search(rf' {side}="([0-9.]+)"', svg).group(1)) for side in ("width", "height"))


def alone(svg):
    return svg.replace("<svg", '<svg xmlns="http://www.w3.org/2000/svg"', 1) + "\n"


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    other = path.with_name(path.name + ".new")
    other.write_text(text, encoding="utf-8")
    os.replace(other, path)


def file_name(text):
    plain = {"·": "", "∥": "_parallel", "θ": "theta"}
    return re.sub(r"[^a-z0-9]+", "_", "".join(plain.get(c, c) for c in text.lower())).strip("_")


def three_phases(samples):
    rows, top, right = [], 0.0, 0.0
    for name, figures in samples:
        left = 0.0
        rows.append(f'<text x="6" y="{top + 22}" font-size="18" font-weight="bold" font-family="sans-serif">{name}</text>')
        top += HEAD
        for svg in figures[:3]:
            width, height = size(svg)
            rows.append(svg.replace("<svg", f'<svg x="{left}" y="{top}"', 1))
            left += width + WIDTH_GAP
        right, top = max(right, left), top + height + WIDTH_GAP
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {right} {top}" width="{right}" height="{top}">'
    back = f'<rect width="{right}" height="{top}" fill="white"/>'
    return "\n".join([head, back, *rows, "</svg>", ""])


def main():
    report, folder = Path(sys.argv[1]), Path(sys.argv[2])
    samples = list(sections(report.read_text(encoding="utf-8")))
    if len(samples) != 3:
        sys.exit(f"{report}: {len(samples)} samples, not the three of the built-in scene")
    write(folder / "three_phases.svg", three_phases(samples))
    for svg in samples[1][1][3:]:
        write(folder / "first_run" / f"{file_name(title(svg))}.svg", alone(svg))


if __name__ == "__main__":
    main()
