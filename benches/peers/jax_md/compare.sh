#!/bin/sh
# FIRE, jamscope beside jax-md: alternates the two on one packing, one JSON line a run. From the root of the repository:
#
#     . FOLDER/bin/activate                                             (see setup.sh)
#     benches/peers/jax_md/compare.sh [PACKING] [STEPS] [REPEATS] [REPLICATE] | python3 benches/peers/table.py
set -eu
packing=${1:-fixtures/packings/hertz_N5548_p100.xyz}
steps=${2:-2000}
repeats=${3:-5}
replicate=${4:-1}
export RAYON_NUM_THREADS=1

cargo build --quiet --release --features measurements --example fire_speed
for _ in $(seq "$repeats"); do
    for precision in mixed double; do
        cargo run --quiet --release --features measurements --example fire_speed -- "$packing" --steps "$steps" --replicate "$replicate" --precision "$precision"
    done
    python benches/peers/jax_md/fire_speed.py "$packing" --steps "$steps" --replicate "$replicate"
done
