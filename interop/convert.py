"""Packings in binary formats to extended XYZ, which jamscope reads.

    python interop/convert.py FILE OUT.xyz [--frame N|last|all] [--radius R] [--dimension 2|3]

| ending | program | read by | centres | radii | box |
|---|---|---|---|---|---|
| .gsd | HOOMD-blue, freud, OVITO | gsd | particles.position | particles.diameter / 2 | configuration.box |
| .npz | NumPy, freud, jax-md | numpy | positions, position, R, points, pos or x | radii, radius, or diameter(s) / 2, sigma / 2 | box (sides, or a triangular matrix), L |
| .nc | jax-md, jamming (AMBER-like netCDF) | scipy | pos or coordinates | rad, radius, radii | box, BoxMatrix or cell_lengths |

What is missing is an error, unless --radius gives one radius for all. GSD keeps diameters of 1 for particles without any; if all are 1,
give --radius. GSD has single precision: overlaps then have errors of 10^-7, so relax the packing.
A box may be tilted: rows of a lower triangular matrix are the edges, columns of an upper one. HOOMD's box is centred at the origin; the file has Origin accordingly.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

POSITIONS = ("positions", "position", "R", "points", "pos", "x", "coordinates")
RADII = ("radii", "radius", "rad")
DIAMETERS = ("diameters", "diameter", "sigma")
BOXES = ("box", "BoxMatrix", "cell_lengths", "L")


def fail(message):
    raise SystemExit(f"convert.py: {message}")


def edges_of(box, path):
    """Edges, one a row, of a box given as sides or as a triangular matrix: rows of a lower one are edges, columns of an upper one."""
    box = np.asarray(box, float)
    if box.ndim < 2:
        return np.diag(np.atleast_1d(box))
    lower, upper = np.abs(np.tril(box, -1)).max() > 0, np.abs(np.triu(box, 1)).max() > 0
    if lower and upper:
        fail(f"{path}: the matrix of the box is not triangular ({box.tolist()}), so its rows or its columns may be the edges")
    return box.T if upper else box


def from_gsd(path):
    import gsd.hoomd

    with gsd.hoomd.open(path, "r") as trajectory:
        for frame in trajectory:
            box = np.asarray(frame.configuration.box, float)
            dimension = 2 if frame.configuration.dimensions == 2 or box[2] == 0 else 3
            (x, y, z), (xy, xz, yz) = box[:3], box[3:]
            # Tilts of HOOMD are over the side of their edge.
            edges = np.array([[x, 0, 0], [xy * y, y, 0], [xz * z, yz * z, z]])
            radii = np.asarray(frame.particles.diameter, float) / 2
            yield {
                "positions": np.asarray(frame.particles.position, float)[:, :dimension],
                # A diameter that was never written is 1.
                "radii": None if np.all(radii == 0.5) else radii,
                "edges": edges[:dimension, :dimension],
                "corner": -edges[:dimension, :dimension].sum(axis=0) / 2,
            }


def first_of(names, arrays):
    return next((np.asarray(arrays[name]) for name in names if name in arrays), None)


def from_arrays(arrays, path):
    positions, box = first_of(POSITIONS, arrays), first_of(BOXES, arrays)
    radii, diameters = first_of(RADII, arrays), first_of(DIAMETERS, arrays)
    found = ", ".join(arrays)
    if positions is None:
        fail(f"{path}: no array of centres ({', '.join(POSITIONS)}); found: {found}")
    if box is None:
        fail(f"{path}: no box ({', '.join(BOXES)}); found: {found}")
    if radii is None and diameters is not None:
        radii = diameters / 2
    # One frame, or one per entry of the first axis.
    frames = positions[None] if positions.ndim == 2 else positions
    for index, centres in enumerate(frames):
        own = radii if radii is None or np.ndim(radii) < 2 else radii[index]
        each = np.asarray(box)
        if each.ndim >= 1 and len(frames) > 1 and each.shape[0] == len(frames):
            each = each[index]
        # netCDF files of packings flatten D centres and D x D boxes.
        if each.ndim == 1 and each.size == centres.shape[-1] ** 2 and centres.shape[-1] > 1:
            each = each.reshape(centres.shape[-1], -1)
        edges, width = edges_of(each, path), centres.shape[1]
        edges = edges[0, 0] * np.eye(width) if edges.size == 1 else edges[:width, :width]
        yield {"positions": centres.astype(float), "radii": own, "edges": edges, "corner": np.zeros(width)}


def from_npz(path):
    with np.load(path) as arrays:
        yield from from_arrays(dict(arrays), path)


def from_netcdf(path):
    from scipy.io import netcdf_file

    with netcdf_file(path, "r", mmap=False) as file:
        arrays = {name: np.array(variable[:]) for name, variable in file.variables.items()}
    for name in POSITIONS:
        # A row per frame: x_1 y_1 x_2 y_2 ...
        if name in arrays and arrays[name].ndim == 2 and "dim" in file.dimensions:
            dimension = file.dimensions["dim"]
            arrays[name] = arrays[name].reshape(len(arrays[name]), -1, dimension)
    yield from from_arrays(arrays, path)


READERS = {".gsd": from_gsd, ".npz": from_npz, ".nc": from_netcdf}


def written(frame, radius, dimension, path):
    """One frame as extended XYZ."""
    positions, radii = frame["positions"], frame["radii"]
    if dimension == 2 and positions.shape[1] == 3:
        if np.ptp(positions[:, 2]) > 1e-9 * np.abs(frame["edges"]).max():
            fail(f"{path}: z is not the same for all disks; give --dimension 3")
        positions, frame = positions[:, :2], {**frame, "edges": frame["edges"][:2, :2], "corner": frame["corner"][:2]}
    width = positions.shape[1]
    if radius is not None:
        radii = np.full(len(positions), radius)
    if radii is None:
        fail(f"{path}: no radii; give --radius R if all are equal")
    radii = np.broadcast_to(np.asarray(radii, float), len(positions))
    cell, corner = np.eye(3), list(frame["corner"]) + [0.0] * (3 - width)
    cell[:width, :width] = frame["edges"]
    lattice = " ".join(repr(float(component)) for component in cell.flatten())
    origin = " ".join(repr(float(value)) for value in corner)
    periodic = "T T F" if width == 2 else "T T T"
    lines = [
        str(len(positions)),
        f'Lattice="{lattice}" Origin="{origin}" pbc="{periodic}" Properties=species:S:1:pos:R:{width}:radius:R:1:id:I:1 dimension={width}',
    ]
    for place, (centre, own) in enumerate(zip(positions, radii)):
        lines.append(" ".join(["X", *(repr(float(x)) for x in centre), repr(float(own)), str(place + 1)]))
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--frame", default="last")
    parser.add_argument("--radius", type=float)
    parser.add_argument("--dimension", type=int, choices=(2, 3))
    arguments = parser.parse_args()
    reader = READERS.get(arguments.file.suffix)
    if reader is None:
        fail(f"{arguments.file}: the ending is {arguments.file.suffix!r}; known are {', '.join(READERS)}")
    frames = list(reader(str(arguments.file)))
    if arguments.frame == "last":
        frames = frames[-1:]
    elif arguments.frame != "all":
        index = int(arguments.frame)
        if not 0 <= index < len(frames):
            fail(f"{arguments.file}: no frame {index}; the file has {len(frames)}")
        frames = [frames[index]]
    text = "".join(written(frame, arguments.radius, arguments.dimension, arguments.file) for frame in frames)
    arguments.out.write_text(text)
    print(f"{len(frames)} frames in {arguments.out}", file=sys.stderr)


if __name__ == "__main__":
    main()
