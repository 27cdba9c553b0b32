#!/bin/sh
# The same matrices, factorised by jamscope and by CHOLMOD in one run, one thread each: the table of benches/measurements/orderings.rs with
# CHOLMOD's rows below. Needs what setup.sh installs. Usage: compare.sh
set -eu
cd "$(dirname "$0")/../../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cc -O2 benches/peers/cholmod/factorise.c -lcholmod -lm -o "$folder/factorise"
cargo build --release --quiet --features measurements --example orderings
target/release/examples/orderings --write "$folder"
(cd "$folder" && OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 ./factorise ./*.mtx)
