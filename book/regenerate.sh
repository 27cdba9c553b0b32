#!/usr/bin/env bash
# Makes the pictures and tables of the book anew, each by the command its chapter names.
#
#   book/regenerate.sh               the pictures that take a minute or two
#   book/regenerate.sh --tables      the outputs behind the tables that take minutes, into book/tables/NAME.txt
#   book/regenerate.sh --all         everything: days on two cores, resumed where it was stopped
#   book/regenerate.sh NAME...       these (see --list)
#
# Work in progress lies in target/book. A picture is written under another name and takes its place when it is complete. Every picture's command, seeds,
# version and date stand in book/src/images/PROVENANCE.md, a table's in its own first lines. Needs a Rust toolchain and Python 3.
set -euo pipefail
cd "$(dirname "$0")/.."
images=book/src/images
work=target/book
jamscope=target/release/jamscope

# Name, how long (quick: pictures in minutes, table: output in minutes, long: hours), command. Pictures have a function below.
list() {
    cat <<'LIST'
first_run            quick  jamscope --out DIR (the built-in scene)
by_hand              quick  the commands of the chapter One packing by hand
drives               quick  jamscope run of two scenes of the chapter Forces, displacements and strains
exact_profiles       quick  jamscope exact profile --outer 42 --wavenumber KAPPA
diagrams             quick  python3 book/diagrams.py
precision            quick  jamscope precision --sample quasielastic|plastic --out DIR
angular_5548         long   angular_study --out DIR --disks 5548 --samples 100 --reduced 1e6,1e7,3e7,1e8,3e8,1e9,3e9
angular_22184        long   angular_study --out DIR --disks 22184 --samples 10 --reduced 1e7,1e8,1e9
angular_88776        long   angular_study --out DIR --disks 88776 --samples 24 --reduced 1e8
transition           long   jamscope study --recipe order-parameters --scale medium --out DIR
exact_routes         table  exact_routes
lorentzian_routes    table  lorentzian_routes
angular_estimators   table  angular_estimators
rounding_floor       table  rounding_floor
orderings            table  orderings
sphere_factors       table  sphere_factors
hand_over            table  hand_over
protocol             table  protocol
stability_map        table  stability_map
excess_coordination  table  excess_coordination 1000 8
scaling              table  scaling --out target/book/scaling
angular_coverage     long   angular_coverage
isostatic_held       table  isostatic_collapse held 5548 10 20 40 400 4000
isostatic_collapse   long   isostatic_collapse figures DIR seeds 101 22184 40 25 10 30 100 300 1000
isostatic_box        long   isostatic_collapse seeds 101 88776 8 60 10 30
isostatic_unstressed table  isostatic_collapse unstressed seeds 101 22184 8 50 10 30 100 300 1000
relaxers             long   relaxers
same_minimum         long   same_minimum --tolerances 0.01,0.02,0.005
LIST
}

version() { sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -1; }

# Notes where a picture comes from: files, command, seeds. The row of the same files is replaced.
record() {
    python3 - "$images/PROVENANCE.md" "$1" "$2" "$3" "$(version)" "$(date -u +%F)" <<'PYTHON'
import os, sys
path, files, command, seeds, version, date = sys.argv[1:]
lines = open(path, encoding="utf-8").read().splitlines()
rows = [line for line in lines if line.startswith("| `") and not line.startswith(f"| `{files}` ")]
rows.append(f"| `{files}` | `{command}` | {seeds} | {version} | {date} |")
head = lines[: next(i for i, line in enumerate(lines) if line.startswith("|---")) + 1]
with open(path + ".new", "w", encoding="utf-8") as new:
    new.write("\n".join(head + sorted(rows)) + "\n")
os.replace(path + ".new", path)
PYTHON
}

example() { cargo run --release --quiet --features measurements --example "$@"; }

# A picture that a program wrote takes the place of the old one.
take() { cp "$1" "$2.new" && mv "$2.new" "$2"; }

first_run() {
    "$jamscope" run --out "$work/first_run"
    python3 book/pictures.py run "$work/first_run/report.html" "$images"
    record "three_phases.svg, first_run/*.svg" "jamscope run && python3 book/pictures.py run jamscope-report/report.html $images" "3, 326, 11"
}

by_hand() {
    local runs="$work/by_hand" protocol
    mkdir -p "$runs"
    printf 'disk_count = 5548\n[[sample]]\nname = "one"\nseed = 1\nsource = { pressure = 10.0 }\n' > "$runs/one.toml"
    "$jamscope" run "$runs/one.toml" --out "$runs/one"
    for protocol in fire study; do
        echo "protocol = \"$protocol\"" > "$runs/$protocol.toml"
        "$jamscope" run "$runs/$protocol.toml" --packing "$runs/one/one.packing.xyz" --seed 1 --out "$runs/$protocol"
    done
    "$jamscope" compress "$runs/one/one.packing.xyz" --pressure 1000 --out "$runs/dense.xyz"
    "$jamscope" run --packing "$runs/dense.xyz" --seed 1 --out "$runs/dense"
    python3 book/pictures.py hand "$runs" "$images"
    record "by_hand/*.svg" "book/regenerate.sh by_hand" "1"
}

drives() {
    local runs="$work/drives" name
    mkdir -p "$runs" "$images/drives"
    printf 'disk_count = 1387\nprotocol = "fire"\n[inflation]\ndrive = { point_force = { force_over_mean = 0.1 } }\n[[sample]]\nname = "push"\nsource = { pressure = 1000.0 }\n' > "$runs/push.toml"
    printf 'disk_count = 1387\nprotocol = "fire"\n[inflation]\ndrive = { shear = { strain = 0.002 } }\n[[sample]]\nname = "shear"\nsource = { pressure = 1000.0 }\n' > "$runs/shear.toml"
    for name in push shear; do "$jamscope" run "$runs/$name.toml" --out "$runs/$name"; done
    python3 book/pictures.py drives "$runs" "$images"
    record "drives/*.svg" "book/regenerate.sh drives" "1"
}

exact_profiles() {
    python3 book/pictures.py exact "$jamscope" "$images"
    record "exact_profiles.svg" "python3 book/pictures.py exact target/release/jamscope $images" "none"
}

diagrams() {
    python3 book/diagrams.py "$images"
    record "diagrams/*.svg" "python3 book/diagrams.py $images" "none"
}

precision() {
    local sample
    for sample in quasielastic plastic; do "$jamscope" precision --sample "$sample" --out "$work/precision/$sample"; done
    python3 book/pictures.py precision "$work/precision" "$images" > "$work/precision/table.md"
    record "precision/*.svg" "book/regenerate.sh precision" "11, 1"
}

angular() {
    local disks=$1 samples=$2 reduced=$3
    example angular_study -- --out "$work/angular_$disks" --disks "$disks" --samples "$samples" --reduced "$reduced"
    take "$work/angular_$disks/spectrum.svg" "$images/angular_spectrum_$disks.svg"
    take "$work/angular_$disks/correlation.svg" "$images/angular_correlation_$disks.svg"
    record "angular_*_$disks.svg" "cargo run --release --features measurements --example angular_study -- --out DIR --disks $disks --samples $samples --reduced $reduced" "1 to $samples"
}
angular_5548() { angular 5548 100 1e6,1e7,3e7,1e8,3e8,1e9,3e9; }
angular_22184() { angular 22184 10 1e7,1e8,1e9; }
angular_88776() { angular 88776 24 1e8; }

transition() {
    "$jamscope" study --recipe order-parameters --scale medium --out "$work/transition"
    python3 book/pictures.py study "$work/transition/report.html" "$images"
    record "transition/*.svg" "jamscope study --recipe order-parameters --scale medium --out DIR && python3 book/pictures.py study DIR/report.html $images" "from 1 on"
}

isostatic_collapse() {
    local rest="seeds 101 22184 40 25 10 30 100 300 1000" name
    table isostatic_collapse "isostatic_collapse figures $work/isostatic $rest"
    for name in collapse_22184 collapse_root_22184; do take "$work/isostatic/$name.svg" "$images/isostatic/$name.svg"; done
    record "isostatic/*.svg" "cargo run --release --features measurements --example isostatic_collapse -- figures DIR $rest" "101 to 140"
}

# The output behind a table, with what made it above it.
table() {
    local name=$1 command=$2
    mkdir -p book/tables
    {
        echo "# cargo run --release --features measurements --example ${command/ / -- }"
        echo "# jamscope $(version), $(date -u +%F), seeds in the example, $(nproc) cores, $(uname -m)"
        # shellcheck disable=SC2086
        set -- $command
        example "$1" -- "${@:2}"
    } > "book/tables/$name.txt.new"
    mv "book/tables/$name.txt.new" "book/tables/$name.txt"
}

make() {
    local kind command
    kind=$(list | awk -v name="$1" '$1 == name { print $2 }')
    [ -n "$kind" ] || { echo "regenerate.sh: no $1; see --list" >&2; exit 1; }
    command=$(list | awk -v name="$1" '$1 == name { $1 = ""; $2 = ""; sub(/^ +/, ""); print }')
    echo "== $1: $command"
    if declare -F "$1" > /dev/null; then "$1"; else table "$1" "$command"; fi
}

case "${1:-}" in
    --list) list; exit 0 ;;
    --all) names=$(list | awk '{ print $1 }') ;;
    --tables) names=$(list | awk '$2 == "table" { print $1 }') ;;
    "") names=$(list | awk '$2 == "quick" { print $1 }') ;;
    -*) echo "regenerate.sh: no option $1" >&2; exit 1 ;;
    *) names=$* ;;
esac
cargo build --release --quiet
mkdir -p "$work"
for name in $names; do make "$name"; done
