#!/bin/sh
# Damped dynamics to a residual, jamscope's implicit steps beside LAMMPS's explicit ones, from the same inflated start. From the
# root of the repository:
#
#     . FOLDER/activate-lammps                                          (see setup.sh)
#     benches/peers/lammps/dynamics.sh [PACKING] [LIMIT] [REPEATS] [STEPS]
#
# The two take turns REPEATS times: jamscope to the limit, LAMMPS 2000 steps for the time of a step. How many steps LAMMPS needs
# does not depend on the machine: it is taken from one run of LAMMPS to the limit at the end, or is STEPS where that is given
# (with `motion` from jamscope's own motion: the time at which its residual falls to the limit, over LAMMPS's 5e-4). The last line
# has the ratio: LAMMPS's steps times the median time of a step over the median time of jamscope.
set -eu
packing=${1:-fixtures/packings/hertz_N5548_p100.xyz}
limit=${2:-1e-5}
repeats=${3:-3}
steps=${4:-run}
export OMP_NUM_THREADS=1 RAYON_NUM_THREADS=1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
here=$(dirname "$0")

cargo build --quiet --release --features measurements --example dynamics_speed
jamscope=${CARGO_TARGET_DIR:-target}/release/examples/dynamics_speed
"$jamscope" "$packing" --start "$folder/start"
for _ in $(seq "$repeats"); do
    cat /proc/loadavg
    "$jamscope" "$packing" --limit "$limit" | tee -a "$folder/jamscope"
    python "$here/dynamics.py" "$folder/start" --limits 0 --most-steps 2000 | tee -a "$folder/lammps"
done
case $steps in
run) python "$here/dynamics.py" "$folder/start" --limits "$limit" | tee "$folder/needed" ;;
motion) "$jamscope" "$packing" --limit "$limit" --motion | tee "$folder/needed" ;;
*) echo "{\"steps\": $steps}" | tee "$folder/needed" ;;
esac
python - "$folder" <<'END'
import json
import statistics
import sys

read = lambda name: [json.loads(line) for line in open(f"{sys.argv[1]}/{name}")]
jamscope = statistics.median(run["cpu_seconds"] for run in read("jamscope"))
of_step = statistics.median(run["cpu_seconds"] / run["steps"] for run in read("lammps"))
needed = read("needed")[0]
steps = needed["after_time"] / 5e-4 if "after_time" in needed else needed["steps"]
print(json.dumps({"lammps_steps": round(steps), "lammps_seconds": round(steps * of_step, 2), "jamscope_seconds": jamscope,
                  "ratio": round(steps * of_step / jamscope, 1)}))
END
