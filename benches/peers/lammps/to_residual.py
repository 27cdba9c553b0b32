"""CPU time of LAMMPS from a start to a residual: one JSON line a run.

    . FOLDER/activate-lammps                       (see setup.sh)
    python benches/peers/lammps/to_residual.py START --case NAME --search --mean-force F      chooses step and tolerance
    python benches/peers/lammps/to_residual.py START --case NAME --time-step DT --tolerance T

START: the sides of the periodic box in the first line after a #, then a line a disk: x, y, radius, 1 if held. The example
`to_residual` writes it. Mass 1, lists checked every step; --law and --style (styles, stiffnesses and skins: peer.py).
Minimiser: FIRE with velocity Verlet (`min_modify norm max integrator verlet delaystep 5`), or --method, with words of `min_modify` after it:
"cg line forcezero".

The residual is jamscope's: the largest net force on a mobile disk of the backbone over the mean contact force of the backbone.
It is computed at the end, from LAMMPS's own forces: those of a table have an error above 1e-8. `residual_of_the_law` is that of the exact forces
at LAMMPS's positions. LAMMPS's tolerance is on the largest force on any mobile disk, rattlers
included: --limit times the mean contact force of LAMMPS's own end. CPU seconds are those of the process (one thread) around
`minimize`, neighbour lists and set-up of the run included. `--search` tries the first time steps TIME_STEPS, each for no more
steps than the fastest before it, and ends with a line of the fastest that converges and the tolerance.

`--watch`: a run that is not timed; `first_step` is that at which the residual was first below the limit, looked at every ten.
"""

import argparse
import json
import time

import numpy as np

from peer import STIFFNESS, by_label, code, minimiser
from residual import Residual

# First time steps; FIRE raises them up to tenfold (LAMMPS's tmax). From 0.001 no start came to rest.
TIME_STEPS = (0.0005, 0.0007, 0.0003)
WATCH_EVERY = 10


def run(sides, disks, options, time_step, tolerance, most_steps, watch=None):
    """The JSON line of one minimisation, and the mean contact force at its end."""
    lmp = minimiser(sides, disks, options.law, time_step, options.style, options.skin, pair=options.pair, method=options.method)
    residual = Residual(disks[:, 2], disks[:, 3] > 0, np.array(sides), options.law)
    count = len(disks)
    first_step = []
    if watch is not None:

        def look(_, step, own, identifier, x, added):
            added[:] = 0.0
            if not first_step and residual.of(by_label(lmp, own), by_label(lmp, own, "f")) <= watch:
                first_step.append(int(step))

        lmp.command(f"fix watch all external pf/callback {WATCH_EVERY} {WATCH_EVERY}")
        lmp.set_fix_external_callback("watch", look)
    begin = time.process_time()
    lmp.command(f"minimize 0.0 {tolerance!r} {most_steps} {10 * most_steps}")
    seconds = time.process_time() - begin
    steps = int(lmp.extract_global("ntimestep"))
    # LAMMPS's own `fmax` is the largest component, its tolerance is on the length.
    net, position = by_label(lmp, count, "f"), by_label(lmp, count)
    force = float(np.hypot(*net.T).max())
    of_the_law, reached = residual.of(position), residual.of(position, net)
    lmp.close()
    line = {
        "code": code(options.style, options.law),
        "case": options.case,
        "law": options.law,
        "relaxer": options.method,
        "disks": count,
        "time_step": time_step,
        "tolerance": tolerance,
        "converged": bool(force <= tolerance),
        "cpu_seconds": round(seconds, 4),
        "steps": steps,
        "largest_force": force,
        "residual": reached,
        "residual_of_the_law": of_the_law,
        "mean_contact_force": residual.mean_force,
        "pressure": round(residual.virial / (2 * sides[0] * sides[1]), 4),
    }
    if watch is not None:
        del line["cpu_seconds"]
        line["first_step"] = first_step[0] if first_step else None
    return line


def search(sides, disks, options):
    """Step and tolerance of the fastest run that converges, with every run tried."""
    fastest, limit = None, options.limit
    for time_step in TIME_STEPS:
        # A step costs no less where it is longer: a run of more steps cannot be the fastest.
        most = options.most_steps if fastest is None else fastest["steps"]
        line = run(sides, disks, options, time_step, limit * options.mean_force, most)
        print(json.dumps(line), flush=True)
        if line["converged"] and (fastest is None or line["cpu_seconds"] < fastest["cpu_seconds"]):
            fastest = line
    if fastest is None:
        raise SystemExit(f"{options.case}: no time step of {TIME_STEPS} converges in {options.most_steps} steps")
    chosen = {"time_step": fastest["time_step"], "tolerance": limit * fastest["mean_contact_force"]}
    print(json.dumps(chosen), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("start")
    parser.add_argument("--case", default="")
    parser.add_argument("--limit", type=float, default=1e-8)
    parser.add_argument("--most-steps", type=int, default=100000)
    parser.add_argument("--search", action="store_true")
    parser.add_argument("--mean-force", type=float, help="with --search: a first guess")
    parser.add_argument("--time-step", type=float, default=TIME_STEPS[0])
    parser.add_argument("--tolerance", type=float)
    parser.add_argument("--watch", action="store_true")
    parser.add_argument("--law", choices=tuple(STIFFNESS), default="hertz")
    parser.add_argument("--style", choices=("lean", "granular"), default="lean")
    parser.add_argument("--skin", type=float)
    parser.add_argument("--pair", help="another style for Hertzian contacts")
    parser.add_argument("--method", default="fire")
    arguments = parser.parse_args()
    with open(arguments.start) as file:
        sides = [float(side) for side in file.readline().lstrip("#").split()]
    disks = np.loadtxt(arguments.start)
    if arguments.search:
        search(sides, disks, arguments)
        return
    watch = arguments.limit if arguments.watch else None
    line = run(sides, disks, arguments, arguments.time_step, arguments.tolerance, arguments.most_steps, watch)
    print(json.dumps(line), flush=True)


if __name__ == "__main__":
    main()
