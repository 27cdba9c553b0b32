"""Makes pictures of the book: python3 book/pictures.py run|study report.html FOLDER, or hand|drives|exact|precision SOURCE FOLDER

run     of the built-in scene: FOLDER/three_phases.svg, map, radial profile and angular profiles of three samples side by side, and
        FOLDER/first_run/NAME.svg, the other pictures of the sample in the middle
study   of `order-parameters`, scale medium: FOLDER/transition/NAME.svg
hand    of the runs of the chapter *One packing by hand*, SOURCE/NAME/report.html: FOLDER/by_hand/NAME_map.svg and NAME_profile.svg
drives  of the runs of the chapter *Forces, displacements and strains*: FOLDER/drives/NAME_map.svg and push_modes.svg
exact   from the tables of `jamscope exact`, SOURCE the program: FOLDER/exact_profiles.svg, r d_r of four wavenumbers
precision  of SOURCE/quasielastic and SOURCE/plastic, written by `jamscope precision`: FOLDER/precision/NAME.svg; prints the table of the chapter

Needs Python and nothing else. A file is written under another name and then renamed.
"""

import csv
import os
import re
import subprocess
import sys
from pathlib import Path

WIDTH_GAP, HEAD = 16, 34

# Figures of a study that the book shows, by their titles.
OF_STUDY = {
    "G* against p̂": "order_parameter",
    "θ* against p̂": "correlation_angle",
    "S(f), 5548": "spectrum_5548",
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


def of_hand(runs, folder):
    for name in ("fire", "study", "dense"):
        _, figures = next(sections((runs / name / "report.html").read_text(encoding="utf-8")))
        for svg, kind in zip(figures, ("map", "profile")):
            write(folder / "by_hand" / f"{name}_{kind}.svg", alone(svg))


def of_drives(runs, folder):
    for name in ("push", "shear"):
        _, figures = next(sections((runs / name / "report.html").read_text(encoding="utf-8")))
        write(folder / "drives" / f"{name}_map.svg", alone(figures[0]))
        for svg in figures:
            if "dashed the continuum" in svg:
                write(folder / "drives" / f"{name}_modes.svg", alone(svg))


def of_exact(jamscope, folder):
    """r d_r against r in a disk of R = 42, from elastic to between the first two poles."""
    def table(*arguments):
        text = subprocess.run([jamscope, "exact", *arguments], check=True, capture_output=True, text=True).stdout
        return [list(map(float, row)) for row in list(csv.reader(text.splitlines()))[2:]]

    outer, first = 42.0, table("poles", "--outer", "42")[0][1]
    left, top, width, height, largest = 64.0, 16.0, 520.0, 300.0, 0.18
    across = lambda r: left + width * r / outer
    down = lambda y: top + height * (0.5 - 0.5 * y / largest)
    out = ['<svg xmlns="http://www.w3.org/2000/svg" width="720" height="364" viewBox="0 0 720 364" font-family="sans-serif" font-size="13">',
           "<title>r d_r of the elastic and three screened solutions</title>", '<rect width="720" height="364" fill="white"/>',
           f'<rect x="{left}" y="{top}" width="{width}" height="{height}" fill="none" stroke="black"/>',
           f'<line x1="{left}" x2="{left + width}" y1="{down(0)}" y2="{down(0)}" stroke="gray"/>']
    for r in (0, 10, 20, 30, 40):
        out.append(f'<text x="{across(r):.1f}" y="{top + height + 18}" text-anchor="middle">{r}</text>')
    for y in (-0.15, -0.1, -0.05, 0, 0.05, 0.1, 0.15):
        out.append(f'<text x="{left - 6}" y="{down(y) + 4:.1f}" text-anchor="end">{str(y).replace("-", "−")}</text>')
    out.append(f'<text x="{left + width / 2}" y="{top + height + 38}" text-anchor="middle">r [diameters of a small disk]</text>')
    out.append(f'<text x="14" y="{top + height / 2}" transform="rotate(-90 14 {top + height / 2})" text-anchor="middle">r d_r</text>')
    for k, (share, colour) in enumerate([(0.0, "black"), (0.6, "#0072b2"), (1.3, "#d55e00"), (1.5, "#009e73")]):
        rows = table("profile", "--outer", "42", "--wavenumber", repr(share * first), "--count", "160")
        points = " ".join(f"{across(r):.1f},{down(r * d):.1f}" for r, d, *_ in rows)
        out.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"/>')
        out.append(f'<text x="{left + width + 12}" y="{top + 20 + 22 * k}" fill="{colour}">{f"κ = {share} κ₁" if share else "elastic, κ = 0"}</text>')
    write(folder / "exact_profiles.svg", "\n".join([*out, "</svg>", ""]))


def power(value):
    if value == 0:
        return "0"
    digit, exponent = f"{value:.0e}".split("e")
    return f"{digit}·10" + str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def of_precision(measured, folder):
    """Error against work, and the row of each relaxer at its default: force limit 10⁻⁸, or tolerance 0.1."""
    tables = {}
    for sample in ("quasielastic", "plastic"):
        for work in ("force_evaluations", "seconds"):
            svg = (measured / sample / f"{sample}.displacement_{work}.svg").read_text(encoding="utf-8")
            write(folder / "precision" / f"{sample}_{work}.svg", svg)
        with open(measured / sample / "precision.csv", encoding="utf-8") as file:
            rows = [row for row in csv.DictReader(file) if row["sample"]]
        for row in rows:
            if (row["varied"], float(row["value"])) in (("force limit", 1e-8), ("tolerance", 0.1)):
                # Implicit dynamics has both: the force limit comes first.
                tables.setdefault(row["method"], {}).setdefault(sample, row)
    print("| relaxer |" + " in | error | evaluations | factorisations | s |" * 2 + "\n|---|" + "---|" * 10)
    for method, samples in tables.items():
        cells = [method]
        for row in samples.values():
            limit = "*" if row["stop"] == "step limit" else ""
            cells += [row["minimum"] + limit, power(float(row["displacement_error"])), row["force_evaluations"], row["factorisations"], f"{float(row['seconds']):.2g}"]
        print("| " + " | ".join(cells) + " |")


def main():
    makers = {"run": of_run, "study": of_study, "hand": of_hand, "drives": of_drives, "exact": of_exact, "precision": of_precision}
    if len(sys.argv) != 4 or sys.argv[1] not in makers:
        sys.exit(__doc__)
    makers[sys.argv[1]](Path(sys.argv[2]), Path(sys.argv[3]))


if __name__ == "__main__":
    main()
