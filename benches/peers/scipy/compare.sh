#!/bin/sh
# The screened profile by SciPy's Bessel functions and by jamscope, at the same points, in the same rows: error and ns a point.
# Then fits of its wavenumber to the same noisy profiles. From the root of the repository:
#
#     . FOLDER/bin/activate                                             (see setup.sh)
#     benches/peers/scipy/compare.sh
set -eu
export RAYON_NUM_THREADS=1 OMP_NUM_THREADS=1
cargo run --quiet --release --features measurements --example exact_routes | sed -n '1,2p;/`Screened`/p'
python3 benches/peers/scipy/profile.py
echo
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cargo run --quiet --release --features measurements --example fit_cost -- --write "$folder"
python3 benches/peers/scipy/fit.py "$folder"
