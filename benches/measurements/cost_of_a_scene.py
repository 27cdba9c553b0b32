"""Measures what observables and features cost.

    python3 benches/measurements/cost_of_a_scene.py scenes PROGRAM FOLDER [PICTURE.svg]    time, memory and files of one scene
    python3 benches/measurements/cost_of_a_scene.py sizes FOLDER                           size of the program by its features

scenes  One packing of 5548 disks at p = 1000 is prepared. It is then inflated with all observables, with the radial profile alone and with none,
        by each of PROTOCOLS: five runs each, in turn, on one thread. The table has medians, with the range in brackets. FOLDER is for the
        packing and the reports.
sizes   Builds the program with `cli` and each other feature alone, with `cli` alone and with all features, in release mode into FOLDER.

Needs Python and nothing else, and Linux for the peak memory.
"""

import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

RUNS = 5
HEAD = 'disk_count = 5548\n[[sample]]\nname = "dense"\nseed = 1\nsource = { %s }\n'
SCENES = {
    "all": "",
    "radial profile": "[observables.radial_profile]\n",
    "none": "[observables]\n",
}
PROTOCOLS = ("study",)
FEATURES = ("fit", "linear", "parallel", "plot")


def measured(command):
    """Wall time [s], processor time [s] and peak memory [MiB] of a program."""
    begin = time.perf_counter()
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        sys.exit(f"{' '.join(command)}: exit code {child.returncode}")
    return time.perf_counter() - begin, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def scenes(program, folder):
    folder.mkdir(parents=True, exist_ok=True)
    first = folder / "prepare.toml"
    first.write_text(HEAD % "pressure = 1000.0" + "[observables.displacement_field]\n", encoding="utf-8")
    measured([program, "run", str(first), "--out", str(folder / "prepared"), "--threads", "1"])
    packing = (folder / "prepared/dense.packing.xyz").resolve()
    found = {(protocol, name): [] for protocol in PROTOCOLS for name in SCENES}
    for _ in range(RUNS):
        for protocol, name in found:
            scene, out = folder / "scene.toml", folder / f"{protocol}_{name.replace(' ', '_')}"
            source = HEAD % f'file = "{packing}"'
            scene.write_text(f'protocol = "{protocol}"\n{source}{SCENES[name]}', encoding="utf-8")
            row = measured([program, "run", str(scene), "--out", str(out), "--threads", "1"])
            size = sum(path.stat().st_size for path in out.iterdir() if path.is_file()) / 2**20
            found[protocol, name].append((*row, size))
    print("| protocol | observables | wall time, s | processor time, s | peak memory, MiB | files, MiB |\n|---|---|---|---|---|---|")
    medians = {}
    for (protocol, name), rows in found.items():
        columns = list(zip(*rows))
        medians[protocol, name] = middle = [statistics.median(column) for column in columns]
        cells = [f"{statistics.median(c):.2f} ({min(c):.2f}–{max(c):.2f})" for c in columns[:2]]
        memory = f"{middle[2]:.0f} ({min(columns[2]):.0f}–{max(columns[2]):.0f})"
        print(f"| `{protocol}` | {name} | {cells[0]} | {cells[1]} | {memory} | {middle[3]:.2f} |")
    return medians


def picture(medians, path):
    """Bars of the processor time, of the peak memory and of the files."""
    groups = [("processor time, s", 1, "#0072b2", "%.2f"), ("peak memory, MiB", 2, "#d55e00", "%.0f"), ("files, MiB", 3, "#009e73", "%.2f")]
    height = 44 + 28 * len(medians)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="820" height="{height}" viewBox="0 0 820 {height}" font-family="sans-serif" font-size="13">',
           "<title>Cost of a scene with all observables, with one and with none</title>", f'<rect width="820" height="{height}" fill="white"/>']
    for row, (protocol, name) in enumerate(medians):
        out.append(f'<text x="164" y="{54 + 28 * row}" text-anchor="end">{protocol}: {name}</text>')
    for number, (label, column, colour, form) in enumerate(groups):
        left, largest = 174 + 216 * number, max(values[column] for values in medians.values())
        out.append(f'<text x="{left}" y="24" font-weight="bold">{label}</text>')
        out.append(f'<line x1="{left}" x2="{left}" y1="34" y2="{height - 6}" stroke="black"/>')
        for row, values in enumerate(medians.values()):
            width = 150 * values[column] / largest
            out.append(f'<rect x="{left}" y="{39 + 28 * row}" width="{width:.1f}" height="20" fill="{colour}" fill-opacity="0.75"/>')
            out.append(f'<text x="{left + width + 6:.1f}" y="{54 + 28 * row}">{form % values[column]}</text>')
    path.write_text("\n".join([*out, "</svg>", ""]), encoding="utf-8")


def sizes(folder):
    environment = dict(os.environ, CARGO_TARGET_DIR=str(folder), CARGO_INCREMENTAL="0")
    print("| features | size, MiB | without symbols, MiB |\n|---|---|---|")
    for features in [("cli",), *(("cli", feature) for feature in FEATURES), ("cli", *FEATURES)]:
        command = ["cargo", "build", "--quiet", "--release", "-j1", "--no-default-features", "--features", ",".join(features), "--bin", "jamscope"]
        subprocess.run(command, check=True, env=environment)
        program, bare = folder / "release/jamscope", folder / "jamscope-stripped"
        subprocess.run(["strip", "-o", str(bare), str(program)], check=True)
        row = [path.stat().st_size / 2**20 for path in (program, bare)]
        print(f"| `{'`, `'.join(features)}` | {row[0]:.1f} | {row[1]:.1f} |", flush=True)


def main():
    match sys.argv[1:]:
        case ["scenes", program, folder]:
            scenes(program, Path(folder))
        case ["scenes", program, folder, target]:
            picture(scenes(program, Path(folder)), Path(target))
        case ["sizes", folder]:
            sizes(Path(folder))
        case _:
            sys.exit(__doc__)


if __name__ == "__main__":
    main()
