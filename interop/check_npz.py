"""Compares the NumPy archives of jamscope with its extended XYZ, bit by bit, as `numpy.load` reads them.

    python interop/check_npz.py PACKING [--jamscope target/release/jamscope]
"""

import argparse
import subprocess
import tempfile
from pathlib import Path

import numpy as np

NAMES = {"pos": "positions", "radius": "radii", "id": "labels", "label": "labels", "correction": "corrections"}


def columns(path):
    """Columns of extended XYZ by name, as arrays."""
    lines = path.read_text().splitlines()
    layout = lines[1].split("Properties=")[1].split()[0].split(":")
    rows, start, found = [line.split() for line in lines[2:]], 0, {}
    for name, kind, width in zip(layout[0::3], layout[1::3], layout[2::3]):
        end = start + int(width)
        if kind != "S":
            values = [[float(word) for word in row[start:end]] for row in rows]
            found[name] = np.array(values).squeeze(axis=1) if end == start + 1 else np.array(values)
        start = end
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("packing", type=Path)
    parser.add_argument("--jamscope", type=Path, default=Path("target/release/jamscope"))
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        xyz, npz = Path(folder) / "a.xyz", Path(folder) / "a.npz"
        for out in (xyz, npz):
            command = [arguments.jamscope, "inspect", arguments.packing, "--not-at-rest", "--modes", "2", "--write", out]
            subprocess.run([str(part) for part in command], check=True, capture_output=True)
        expected = columns(xyz)
        with np.load(npz, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
    for name, values in expected.items():
        found = arrays[NAMES.get(name, name)].astype(float)
        if found.ndim == 2 and found.shape[1] < values.shape[1]:
            values = values[:, : found.shape[1]]
        if found.shape != values.shape or found.tobytes() != values.tobytes():
            raise SystemExit(f"{name} differs")
        print(f"  {name} {found.shape}: equal to the bit")
    print("scalars:", {name: value.item() for name, value in arrays.items() if value.ndim == 0})
    print("all agree")


if __name__ == "__main__":
    main()
