"""JSON lines of `fire_speed` and its peers as a table of medians, ranges and ratios.

    benches/peers/lammps/compare.sh | python3 benches/peers/table.py [--wall]

--wall: of the times on the wall (`wall_ns_per_particle_step`), as for several threads.
"""

import json
import statistics
import sys


def main():
    key = "wall_ns_per_particle_step" if "--wall" in sys.argv[1:] else "ns_per_particle_step"
    times = {}
    for line in sys.stdin:
        run = json.loads(line)
        case = (run.get("law", "hertz"), run["disks"], run["steps"])
        times.setdefault(case, {}).setdefault(run["code"], []).append(run[key])
    print("| law | disks | steps | code | median, ns a particle step | lowest to highest | over jamscope, mixed | over jamscope, double |")
    print("|---|---|---|---|---|---|---|---|")
    for (law, disks, steps), codes in times.items():
        mixed, double = (statistics.median(codes[name]) for name in ("jamscope, mixed precision", "jamscope"))
        for code, found in codes.items():
            median = statistics.median(found)
            span = f"{min(found):.1f}–{max(found):.1f}"
            print(f"| {law} | {disks} | {steps} | {code} | {median:.1f} | {span} | {median / mixed:.1f} | {median / double:.1f} |")


if __name__ == "__main__":
    main()
