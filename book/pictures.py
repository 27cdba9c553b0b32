"""Takes pictures of the book out of a page: python3 book/pictures.py run|study report.html FOLDER

run     of the built-in scene: FOLDER/three_phases.svg, map, radial profile and angular profiles of three samples side by side, and
        FOLDER/first_run/NAME.svg, the other pictures of the sample in the middle
study   of `order-parameters`, scale medium: FOLDER/transition/NAME.svg

Needs Python and nothing else. A file is written under another name and then renamed.
"""

import os
import re
import sys
from pathlib import Path

WIDTH_GAP, HEAD = 16, 34

# Figures of a study that the book shows, by their titles.
OF_STUDY = {
    "G* against p̂": "order_parameter",
    "θ* against p̂": "correlation_angle",
    "S(f), 5548": "spectrum_5548",
    "G(θ), 5548": "correlation_5548",
    "Mean radial profiles, 22184 disks, d_0 = 0.1": "profiles_22184",
    "κ of the best screened solution against p̂": "wavenumber",
}


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


def of_run(report, folder):
    samples = list(sections(report.read_text(encoding="utf-8")))
    if len(samples) != 3:
        sys.exit(f"{report}: {len(samples)} samples, not the three of the built-in scene")
    write(folder / "three_phases.svg", three_phases(samples))
    for svg in samples[1][1][3:]:
        write(folder / "first_run" / f"{file_name(title(svg))}.svg", alone(svg))


def of_study(report, folder):
    found = {}
    for svg in re.findall(r"<svg.*?</svg>", report.read_text(encoding="utf-8"), re.S):
        found.setdefault(re.search(r"<title>(.*?)</title>", svg, re.S).group(1), svg)
    missing = [name for name in OF_STUDY if name not in found]
    if missing:
        sys.exit(f"{report}: no figure {missing}")
    for name, file in OF_STUDY.items():
        write(folder / "transition" / f"{file}.svg", alone(found[name]))


def main():
    if len(sys.argv) != 4 or sys.argv[1] not in ("run", "study"):
        sys.exit(__doc__)
    {"run": of_run, "study": of_study}[sys.argv[1]](Path(sys.argv[2]), Path(sys.argv[3]))


if __name__ == "__main__":
    main()
