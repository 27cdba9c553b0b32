"""CPU time per particle step of LAMMPS's FIRE on soft disks: one JSON line a run.

    . FOLDER/activate-lammps                       (see setup.sh)
    python benches/peers/lammps/fire_speed.py [PACKING] [--steps N] [--replicate K] [--case inflated|jittered] [--law hertz|hooke] [--repeat N]
        [--style lean|granular] [--skin S] [--threads T] [--pair STYLE]

The case `inflated` (default): one small disk, the one nearest to the middle of the box, grows by 0.1 and is held; all others
are mobile in the periodic box. The case `jittered`: every coordinate moved by a uniform random number in +-0.01, none held.
The force limit is 0, so all the steps asked for are made. --replicate K tiles the packing K x K before that.

Mass 1, no damping, FIRE with velocity Verlet; styles, stiffnesses and skins as in peer.py. --pair: another style for Hertzian contacts,
as `table spline 1000` or `lepton`. With --threads T above 1 the style is its variant /omp.
CPU seconds are those of the process around `minimize`, neighbour lists and set-up of the run included; wall seconds too.
`largest_force` (component) and `energy` are those at the end: a run that diverged is seen by them.
"""

import argparse
import json
import random
import re
import time

import numpy as np

from peer import STIFFNESS, code, minimiser

GROWTH = 0.1  # radius added to the inflated disk [length]
JITTER = 0.01  # half width of the random displacement [length]
SEED = 1
# First time step; FIRE raises it up to tenfold (LAMMPS's tmax). 0.0003 converges at p = 100. From 0.0007 on it does not: the
# disks then never settle, lists are rebuilt often and a step costs half as much again, which would flatter the other side.
TIME_STEP = 0.0003


def read_packing(path):
    """Sides of the box and (x, y, radius) of each disk of an extended XYZ file as in fixtures/packings."""
    with open(path) as file:
        count = int(file.readline())
        comment = file.readline()
        rows = [next(file).split() for _ in range(count)]
    lattice = [float(value) for value in re.search(r'Lattice="([^"]*)"', comment).group(1).split()]
    properties = re.search(r"Properties=(\S+)", comment).group(1).split(":")
    start, at = {}, 0
    for name, _, width in zip(properties[0::3], properties[1::3], properties[2::3]):
        start[name] = at
        at += int(width)
    position, radius = start["pos"], start["radius"]
    disks = [(float(row[position]), float(row[position + 1]), float(row[radius])) for row in rows]
    return (lattice[0], lattice[4]), disks


def tiled(sides, disks, number):
    """The packing repeated number x number times in a box as many times as large."""
    copies = [(x + i * sides[0], y + j * sides[1], r) for j in range(number) for i in range(number) for x, y, r in disks]
    return (number * sides[0], number * sides[1]), copies


def middle_small_disk(sides, disks):
    """Index of the smallest disk nearest to the middle of the box."""
    smallest = min(radius for _, _, radius in disks)
    return min(
        (index for index, disk in enumerate(disks) if disk[2] == smallest),
        key=lambda index: (disks[index][0] - sides[0] / 2) ** 2 + (disks[index][1] - sides[1] / 2) ** 2,
    )


def run(sides, disks, arguments):
    """CPU and wall seconds, steps made, largest force and energy after them."""
    disks, held = list(disks), None
    if arguments.case == "inflated":
        held = middle_small_disk(sides, disks)
        x, y, radius = disks[held]
        disks[held] = (x, y, radius + GROWTH)
    else:
        draw = random.Random(SEED)
        disks = [(x + draw.uniform(-JITTER, JITTER), y + draw.uniform(-JITTER, JITTER), r) for x, y, r in disks]
    rows = np.array([(x, y, radius, index == held) for index, (x, y, radius) in enumerate(disks)])
    lmp = minimiser(
        sides, rows, arguments.law, arguments.time_step, arguments.style, arguments.skin, arguments.threads, arguments.pair
    )
    begin, wall = time.process_time(), time.perf_counter()
    lmp.command(f"minimize 0.0 0.0 {arguments.steps} {10 * arguments.steps}")
    seconds, wall = time.process_time() - begin, time.perf_counter() - wall
    made = int(lmp.extract_global("ntimestep"))
    force, energy = lmp.get_thermo("fmax"), lmp.get_thermo("pe")
    lmp.close()
    return seconds, wall, made, force, energy


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("packing", nargs="?", default="fixtures/packings/hertz_N5548_p100.xyz")
    parser.add_argument("--steps", type=int, default=2000)
    parser.add_argument("--replicate", type=int, default=1)
    parser.add_argument("--case", choices=("inflated", "jittered"), default="inflated")
    parser.add_argument("--law", choices=tuple(STIFFNESS), default="hertz")
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--time-step", type=float, default=TIME_STEP)
    parser.add_argument("--style", choices=("lean", "granular"), default="lean")
    parser.add_argument("--skin", type=float)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--pair")
    arguments = parser.parse_args()
    sides, disks = tiled(*read_packing(arguments.packing), arguments.replicate)
    for _ in range(arguments.repeat):
        seconds, wall, steps, force, energy = run(sides, disks, arguments)
        line = {
            "code": code(arguments.style, arguments.law, arguments.threads),
            "case": arguments.case,
            "law": arguments.law,
            "disks": len(disks),
            "steps": steps,
            "cpu_seconds": round(seconds, 4),
            "ns_per_particle_step": round(1e9 * seconds / (steps * len(disks)), 2),
            "wall_ns_per_particle_step": round(1e9 * wall / (steps * len(disks)), 2),
            "largest_force": force,
            "energy": energy,
        }
        if arguments.pair:
            line["pair"] = arguments.pair
        print(json.dumps(line), flush=True)


if __name__ == "__main__":
    main()
