#!/bin/sh
# To a residual of 1e-8, jamscope's FIRE, in double and in mixed precision, and its staged relaxer beside LAMMPS's FIRE, from the same start. From the root of the
# repository:
#
#     . FOLDER/activate-lammps                                          (see setup.sh)
#     benches/peers/lammps/to_residual.sh [--law hertz|hooke] [--style lean|granular] [--disks N] [REPEATS] [CASE ...]
#
# A case is `random-SEED` (random points) or a packing in whose middle a disk grows; without any, those of the README.
# jamscope writes the start; LAMMPS's first time step and tolerance are chosen by runs that do not count. Then all take
# turns REPEATS times. JSON lines of all runs go to standard error, the table of medians to standard output, and a line for all
# random points together: the programs end in different minima, and how many steps it takes to one is a matter of luck.
set -eu
law=hertz style=lean count=5548
while [ $# -gt 0 ]; do
    case $1 in
        --law) law=$2 ;;
        --style) style=$2 ;;
        --disks) count=$2 ;;
        *) break ;;
    esac
    shift 2
done
repeats=${1:-3}
[ $# -eq 0 ] || shift
[ $# -gt 0 ] || set -- $(seq -f 'random-%g' 8) fixtures/packings/hertz_N5548_p100.xyz fixtures/packings/hertz_N5548_p10.xyz
export OMP_NUM_THREADS=1 RAYON_NUM_THREADS=1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
lammps="python $(dirname "$0")/to_residual.py"

cargo build --quiet --release --features measurements --example to_residual
jamscope="${CARGO_TARGET_DIR:-target}/release/examples/to_residual --law $law --disks $count"
for from in "$@"; do
    case=$(basename "$from" .xyz)
    $jamscope "$from" --write "$folder/start"
    $jamscope "$from" --relaxer fire >"$folder/guess"
    mean=$(python -c 'import json, sys; print(json.load(open(sys.argv[1]))["mean_contact_force"])' "$folder/guess")
    $lammps "$folder/start" --case "$case" --law "$law" --style "$style" --search --mean-force "$mean" >"$folder/search"
    cat "$folder/search" >&2
    chosen=$(tail -n 1 "$folder/search" |
        python -c 'import json, sys; run = json.load(sys.stdin); print("--time-step", run["time_step"], "--tolerance", run["tolerance"])')
    for _ in $(seq "$repeats"); do
        for relaxer in fire mixed staged; do
            $jamscope "$from" --relaxer "$relaxer" | tee -a "$folder/runs" >&2
        done
        # shellcheck disable=SC2086
        $lammps "$folder/start" --case "$case" --law "$law" --style "$style" $chosen | tee -a "$folder/runs" >&2
    done
    # shellcheck disable=SC2086
    $lammps "$folder/start" --case "$case" --law "$law" --style "$style" $chosen --watch | tee -a "$folder/watched" >&2
done
python - "$folder" <<'PYTHON'
import json
import statistics
import sys

read = lambda name: [json.loads(line) for line in open(f"{sys.argv[1]}/{name}")]
first_step = {run["case"]: run["first_step"] for run in read("watched")}
runs = {}
for run in read("runs"):
    runs.setdefault(run["case"], {}).setdefault((run["code"], run["relaxer"]), []).append(run)
print("| case | pressure | code | CPU seconds | evaluations | of them until the backbone is first below | factorisations | residual | over jamscope's FIRE | over its FIRE, mixed | over its staged |")
print("|---|---|---|---|---|---|---|---|---|---|---|")
random = []
for case, codes in runs.items():
    median = {code: statistics.median(run["cpu_seconds"] for run in of_code) for code, of_code in codes.items()}
    fire, mixed, staged = (median["jamscope", relaxer] for relaxer in ("fire", "mixed", "staged"))
    if case.startswith("random"):
        random.append([fire, mixed, staged, *(seconds for (code, _), seconds in median.items() if code.startswith("LAMMPS"))])
    for (code, relaxer), of_code in codes.items():
        run, seconds, first = of_code[0], median[code, relaxer], ""
        what = f"{code.split()[0]}, { {'fire': 'FIRE', 'mixed': 'FIRE, mixed', 'staged': 'staged'}[relaxer] }"
        if "time_step" in run:
            what += f", first step {run['time_step']}"
            first = (first_step[case] or run["steps"]) + 1
        evaluations = run.get("force_evaluations", run["steps"] + 1)
        print(f"| {case} | {run['pressure']:.1f} | {what} | {seconds:.2f} | {evaluations} | {first} | {run.get('factorisations', 0)} "
              f"| {run['residual']:.1e} | {seconds / fire:.2f} | {seconds / mixed:.2f} | {seconds / staged:.2f} |")
if len(random) > 1:
    double, mixed, staged, theirs = map(sum, zip(*random))
    print(f"\n{len(random)} starts from random points together: {double:.2f} s, {mixed:.2f} s in mixed precision, {staged:.2f} s staged and {theirs:.2f} s")
    for name, place, ours in (("FIRE", 0, double), ("FIRE, mixed", 1, mixed), ("staged", 2, staged)):
        ratios = sorted(run[3] / run[place] for run in random)
        print(f"over {name}: {theirs / ours:.1f}; single ones {ratios[0]:.1f} to {ratios[-1]:.1f}, median {statistics.median(ratios):.1f}")
PYTHON
