#!/usr/bin/env bash
# Whether two builds of jamscope write the same bytes: the built-in scene, two studies, a packing from a file, linear outputs.
#
#     benches/measurements/same_bytes.sh OLD_PROGRAM NEW_PROGRAM
#
# Wall times are left out: they are the only numbers that differ from run to run.
set -euo pipefail
fixtures=$(realpath "$(dirname "$0")/../../fixtures")
programs=("$(realpath "$1")" "$(realpath "$2")")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

outputs() {
    mkdir "$2"
    cd "$2"
    "$1" run --out scene > scene.txt
    "$1" study --recipe angular --scale small --seeds 2 --out angular > /dev/null
    "$1" study --recipe hookean --scale small --seeds 1 --protocol fire-newton --out hookean > /dev/null
    "$1" run --packing "$fixtures/packings/hertz_N5548_p100.xyz" --out packing > packing.txt
    for packing in hertz_N1000_p10 hertz_N1000_p100 hooke_N1000_p100; do
        "$1" inspect "$fixtures/packings/$packing.xyz" --modes 5 --json > "$packing.json"
    done
    "$1" scene > printed.toml
    find . -name timings.json -delete
    # A sample's third line is its wall time.
    find . -path '*/samples/*' -name '*.jsonl' -exec sed -i '$d' {} +
    grep -rlE 'wall|seconds' . | xargs -r sed -i -E '/wall|seconds/d'
}

(outputs "${programs[0]}" "$folder/old")
(outputs "${programs[1]}" "$folder/new")
diff --recursive --brief "$folder/old" "$folder/new"
echo "the same bytes in $(find "$folder/old" -type f | wc -l) files"
