#!/usr/bin/env bash
# What a newcomer waits for, from a fresh clone with nothing compiled: seconds of each command. Downloads are not counted.
#
#     benches/measurements/first_minute.sh [--checks]
#
# With --checks also `.ci/run` in a second clone.
set -euo pipefail
root=$(git -C "$(dirname "$0")" rev-parse --show-toplevel)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export CARGO_INCREMENTAL=0
unset CARGO_TARGET_DIR

timed() {
    local name=$1 start=$SECONDS
    shift
    if ! "$@" > "$work/log" 2>&1; then
        tail -20 "$work/log"
        exit 1
    fi
    printf '%-32s %5d s\n' "$name" $((SECONDS - start))
}

fresh() {
    rm -rf "$work/jamscope"
    git clone --quiet "$root" "$work/jamscope"
    cd "$work/jamscope"
    cargo fetch --quiet --locked
}

printf '%s, %s cores, commit %s\n' "$(rustc --version)" "$(nproc)" "$(git -C "$root" rev-parse --short HEAD)"
fresh
timed "cargo build --release" cargo build --release
timed "cargo run --release, then" cargo run --release
timed "cargo test --no-run" cargo test --no-run
timed "cargo test, then" cargo test
if [[ ${1:-} == --checks ]]; then
    fresh
    timed ".ci/run" .ci/run
fi
