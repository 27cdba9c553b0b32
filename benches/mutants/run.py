#!/usr/bin/env python3
"""Mutation score of five modules: how many one-line mutants of `src` the tests catch. See README.md in this folder.

    python3 benches/mutants/run.py --work DIR [--each 60] [--seed 1] [--survivors]
"""

import argparse
import csv
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from mutate import mutants_of, switched

ROOT = Path(__file__).resolve().parents[2]
RESULTS = Path(__file__).parent / "results.csv"
MODULES = ["src/law", "src/forces", "src/network.rs", "src/observe/angular", "src/reference"]
# Runs of a module, the quick ones first: program and arguments of its test harness. Tests that take long and concern other modules are
# left out, so the score is a lower bound.
SLOW = ["list_and_hot_loop", "force_is_minus", "virial_is_minus"]
QUICK = ["contact::", "kernels::forces", "on_site::", "applied::", "certificate::", "relax::a", "relax::energies", "relax::hertzian",
         "relax::damped", "relax::descent", "minimisers::closed_forms", "spheres::", "linear::hessian"]
MECHANICS = [("mechanics", [*QUICK, *(word for slow in [*SLOW, "incremental_update"] for word in ("--skip", slow))]),
             ("mechanics", [*SLOW, "relax::", "minimisers::"])]
RUNS = {
    "src/law": [("lib", ["law::", "forces::"]), *MECHANICS, ("extending", [])],
    "src/forces": [("lib", ["forces::", "neighbours::", "simd::"]), *MECHANICS],
    "src/network.rs": [("lib", ["network::"]), *MECHANICS, ("observables", ["response_observables"])],
    "src/observe/angular": [("observables", ["angular::", "--skip", "angular::fits", "--skip", "estimators"]),
                            ("observables", ["angular::fits", "estimators", "ensemble_fits::spectra", "response_observables"])],
    "src/reference": [("lib", ["reference::"]), ("reference", []), ("observables", ["fit::"])],
}
TARGETS = {"lib": ["--lib"], "mechanics": ["--test", "mechanics"], "observables": ["--test", "observables"],
           "reference": ["--test", "reference"], "extending": ["--test", "extending"]}
SWITCH = """
/// The mutant that `JAMSCOPE_MUTANT` chooses.
pub mod switch {
    static CHOSEN: std::sync::LazyLock<u32> =
        std::sync::LazyLock::new(|| std::env::var("JAMSCOPE_MUTANT").map_or(0, |text| text.parse().expect("a number")));
    /// Whether this is the mutant of the run.
    #[inline]
    pub fn on(mutant: u32) -> bool {
        *CHOSEN == mutant
    }
}
"""
# A mutant may allocate without end.
MEMORY = 4 << 30


def candidates(seed):
    """The mutants of each module in random order, numbered from 1."""
    shuffled, number = {}, 0
    for module in MODULES:
        path = ROOT / module
        files = [path] if path.is_file() else sorted(path.rglob("*.rs"))
        found = [m for file in files for m in mutants_of(str(file.relative_to(ROOT)), file.read_text())]
        random.Random(seed).shuffle(found)
        for mutant in found:
            number += 1
            mutant.number = number
        shuffled[module] = found
        print(f"{module}: {len(found)} possible mutants", flush=True)
    return shuffled


def copy_tree(work, built):
    """Copies the files of the repository; those with switches are kept if they are built already."""
    tree = work / "tree"
    files = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True).stdout.split("\0")
    for name in filter(None, files):
        if built and (name == "src/lib.rs" or any(name.startswith(module) for module in MODULES)):
            continue
        source, target = ROOT / name, tree / name
        if source.exists() and not (target.exists() and target.read_bytes() == source.read_bytes()):
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, target)
    return tree


def built_before(tree, work, shuffled):
    """The mutants of the copy as an earlier run left it, and those that it refused."""
    record = json.loads((work / "chosen.json").read_text())
    mutants = {m.number: m for found in shuffled.values() for m in found}
    refused = []
    for number, outcome in record["refused"].items():
        mutants[int(number)].outcome = outcome
        refused.append(mutants[int(number)])
    return [mutants[number] for number in record["chosen"]], refused


def write_tree(tree, chosen):
    by_file = {}
    for mutant in chosen:
        by_file.setdefault(mutant.file, []).append(mutant)
    for module in MODULES:
        path = ROOT / module
        for file in [path] if path.is_file() else sorted(path.rglob("*.rs")):
            name = str(file.relative_to(ROOT))
            write_if_new(tree / name, switched(file.read_text(), by_file.get(name, [])))
    write_if_new(tree / "src/lib.rs", (ROOT / "src/lib.rs").read_text() + SWITCH)


def write_if_new(path, text):
    """Cargo builds what is newer than its last build."""
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def guilty(tree, message, chosen):
    """Mutants at the places of a compiler's error: the innermost replacements, or else the innermost slots."""
    found = {}
    for span in message["spans"]:
        text = (tree / span["file_name"]).read_bytes() if (tree / span["file_name"]).exists() else b""
        for begin, end, outcome in ((b"/*<%d*/", b"/*%d>*/", "does not compile"), (b"/*[%d*/", b"/*%d]*/", "no switch")):
            best = None
            for mutant in (m for m in chosen if m.file == span["file_name"]):
                first, last = text.find(begin % mutant.number), text.find(end % mutant.number)
                if 0 <= first <= span["byte_start"] and span["byte_end"] <= last + 12 and (best is None or last - first < best[0]):
                    best = (last - first, mutant)
            if best:
                found[best[1].number] = (best[1], outcome)
                break
    return list(found.values())


def cargo(tree, arguments):
    """Messages of a build, and the paths of the programs."""
    command = ["cargo", *arguments, "--message-format=json"]
    result = subprocess.run(command, cwd=tree, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    messages = [json.loads(line) for line in result.stdout.splitlines() if line.startswith("{")]
    errors = [m["message"] for m in messages if m["reason"] == "compiler-message" and m["message"]["level"] == "error"]
    programs = [m["executable"] for m in messages if m["reason"] == "compiler-artifact" and m.get("executable") and m["profile"]["test"]]
    return result.returncode, errors, programs


def compile_chosen(tree, shuffled, each):
    """Takes mutants until `each` of every module compile together. Returns them and those that do not compile."""
    waiting = {module: list(found) for module, found in shuffled.items()}
    chosen, refused = [], []
    while True:
        for module in MODULES:
            have = sum(m.file.startswith(module) for m in chosen)
            while have < each and waiting[module]:
                chosen.append(waiting[module].pop(0))
                have += 1
        write_tree(tree, chosen)
        # A test program, not the library alone: dependencies of tests change features, and the library would be built twice.
        code, errors, _ = cargo(tree, ["test", "--no-run", "--test", "reference"])
        if code == 0:
            record = {"chosen": [m.number for m in chosen], "refused": {m.number: m.outcome for m in refused}}
            (tree.parent / "chosen.json").write_text(json.dumps(record))
            return chosen, refused
        bad = {m.number: (m, outcome) for error in errors for m, outcome in guilty(tree, error, chosen)}
        print(f"{len(chosen)} together, {len(bad)} of them do not compile", flush=True)
        if not bad:
            print("\n".join(error.get("rendered", "") for error in errors[:5]))
            raise SystemExit("an error that belongs to no mutant")
        for number, (mutant, outcome) in bad.items():
            mutant.outcome = outcome
            refused.append(mutant)
        chosen = [m for m in chosen if m.number not in bad]


def run(tree, program, arguments, number, limit):
    """The first test that fails, "time limit", "ended early", or None if all pass."""
    environment = {**os.environ, "JAMSCOPE_MUTANT": str(number), "PROPTEST_MAX_SHRINK_ITERS": "0", "RUST_BACKTRACE": "0"}
    environment.pop("JAMSCOPE_SEED", None)

    def limited():
        os.setsid()
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))

    process = subprocess.Popen([program, *arguments], cwd=tree, env=environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                               text=True, preexec_fn=limited)
    late = threading.Event()

    def stop():
        try:
            os.killpg(process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass

    timer = threading.Timer(limit, lambda: (late.set(), stop()))
    timer.start()
    failed = None
    for line in process.stdout:
        if line.startswith("test ") and line.rstrip().endswith("FAILED") and not line.startswith("test result"):
            failed = line.split()[1]
            stop()
            break
    code = process.wait()
    timer.cancel()
    if failed:
        return failed
    if late.is_set():
        return "time limit"
    return None if code == 0 else "ended early"


def forget_regressions(tree):
    for file in tree.rglob("*.regressions"):
        if not (ROOT / file.relative_to(tree)).exists():
            file.unlink()


def interval(caught, count):
    """Wilson's interval of 95 %."""
    z, share = 1.959964, caught / count
    middle, width = share + z * z / (2 * count), z * (share * (1 - share) / count + z * z / (4 * count * count)) ** 0.5
    return (middle - width) / (1 + z * z / count), (middle + width) / (1 + z * z / count)


def write(rows):
    with RESULTS.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["file", "line", "change", "outcome"])
        writer.writerows(sorted(rows))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--work", type=Path, required=True, help="folder of the copy of the tree; set CARGO_TARGET_DIR to keep builds")
    parser.add_argument("--each", type=int, default=60, help="mutants of every module")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--built", action="store_true", help="takes the mutants of an earlier run in the same folder; only tests are built again")
    parser.add_argument("--survivors", action="store_true", help="runs again only those that survived in results.csv")
    parser.add_argument("--minutes", type=float, default=1e9, help="stops after this time")
    options = parser.parse_args()
    begun = time.monotonic()
    tree = copy_tree(options.work, options.built)
    old = {}
    if options.survivors:
        with RESULTS.open() as file:
            old = {(row["file"], row["line"], row["change"], str(k)): row["outcome"] for k, row in enumerate(csv.DictReader(file))}
    shuffled = candidates(options.seed)
    if options.built:
        chosen, refused = built_before(tree, options.work, shuffled)
    else:
        chosen, refused = compile_chosen(tree, shuffled, options.each)
    programs = {}
    for name, target in TARGETS.items():
        code, errors, paths = cargo(tree, ["test", "--no-run", *target])
        if code != 0:
            raise SystemExit(f"{name}: {errors[:1]}")
        programs[name] = paths[-1]
    print(f"compiled after {time.monotonic() - begun:.0f} s", flush=True)
    limits = {}
    for runs in RUNS.values():
        for program, arguments in runs:
            key = (program, tuple(arguments))
            if key not in limits:
                start = time.monotonic()
                failed = run(tree, programs[program], arguments, 0, 900)
                limits[key] = 10 + 4 * (time.monotonic() - start)
                print(f"{program} {' '.join(arguments)}: {time.monotonic() - start:.0f} s without a mutant", flush=True)
                if failed:
                    raise SystemExit(f"{failed} fails without a mutant")
    rows = [(m.file, m.line, m.change, m.outcome) for m in refused if m.outcome == "does not compile"]
    survived = {tuple(key[:3]) for key, outcome in old.items() if outcome == "survived"}
    # All modules in turn, so that a run that is stopped covers them evenly.
    turn = {m.number: sum(o.file.startswith(module) for o in chosen[:k]) for k, m in enumerate(chosen) for module in MODULES
            if m.file.startswith(module)}
    for mutant in sorted(chosen, key=lambda m: turn[m.number]):
        if time.monotonic() - begun > 60 * options.minutes:
            print("out of time")
            break
        module = next(module for module in MODULES if mutant.file.startswith(module))
        key = (mutant.file, str(mutant.line), mutant.change)
        if options.survivors and key not in survived:
            known = [outcome for name, outcome in old.items() if tuple(name[:3]) == key]
            rows.append((*key[:1], mutant.line, mutant.change, known[0] if known else "not run"))
            continue
        outcome, start = "survived", time.monotonic()
        for program, arguments in RUNS[module]:
            failed = run(tree, programs[program], arguments, mutant.number, limits[(program, tuple(arguments))])
            if failed:
                outcome = f"{program}: {failed}"
                break
        forget_regressions(tree)
        rows.append((mutant.file, mutant.line, mutant.change, outcome))
        print(f"{mutant.number} {mutant.file}:{mutant.line} {mutant.change}: {outcome}, {time.monotonic() - start:.0f} s", flush=True)
        write(rows)
    write(rows)
    for module in [*MODULES, ""]:
        outcomes = [row[3] for row in rows if row[0].startswith(module) and row[3] != "does not compile"]
        caught = sum(outcome != "survived" for outcome in outcomes)
        if outcomes:
            low, high = interval(caught, len(outcomes))
            print(f"{module or 'all'}: {caught} of {len(outcomes)} caught, {100 * caught / len(outcomes):.1f} % ({100 * low:.1f}–{100 * high:.1f})")


if __name__ == "__main__":
    main()
