#!/bin/sh
# FIRE, jamscope in mixed and in double precision beside LAMMPS: alternates them on one packing, one JSON line a run. From the root of the repository:
#
#     . FOLDER/activate-lammps                                          (see setup.sh)
#     benches/peers/lammps/compare.sh [PACKING] [STEPS] [REPEATS] [REPLICATE] [hertz|hooke] [lean|granular] [THREADS] | python3 benches/peers/table.py
#
# Styles of LAMMPS: peer.py. With two threads use `table.py --wall`.
# Alternating spreads the noise of a shared machine over all; compare medians. Jamscope's side is the example
# `fire_speed`, which prints the same JSON keys for the same problem.
set -eu
packing=${1:-fixtures/packings/hertz_N5548_p100.xyz}
steps=${2:-2000}
repeats=${3:-5}
replicate=${4:-1}
law=${5:-hertz}
style=${6:-lean}
threads=${7:-1}
export OMP_NUM_THREADS="$threads" RAYON_NUM_THREADS="$threads"

cargo build --quiet --release --features measurements --example fire_speed
jamscope=${CARGO_TARGET_DIR:-target}/release/examples/fire_speed
for _ in $(seq "$repeats"); do
    for precision in mixed double; do
        "$jamscope" "$packing" --steps "$steps" --replicate "$replicate" --law "$law" --precision "$precision"
    done
    python benches/peers/lammps/fire_speed.py "$packing" --steps "$steps" --replicate "$replicate" --law "$law" --style "$style" --threads "$threads"
done
