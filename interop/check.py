"""Holds jamscope's files against ASE, OVITO and LAMMPS. See README.md beside it.

    python interop/check.py --out FOLDER [--need ase,ovito,lammps] [--target target/release] [--keep]

1. ASE and OVITO read the extended XYZ of a run: as many disks, the same radii, positions and displacements: ASE to the bit, OVITO to the
   last digit, its radii in single precision.
2. jamscope reads a packing that went through ASE (eight decimals) and OVITO (radii in single precision).
3. LAMMPS reads our data file and finds the energy, every force and the pressure, to 1e-12 of the largest.
4. jamscope reads what LAMMPS wrote, data and dump: the same disks, and the energy and pressure LAMMPS has.
"""

import argparse
import json
import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
os.environ.setdefault("OMP_NUM_THREADS", "1")
STIFFNESS = 2e5
FAULTS = []


def check(what, found, bound):
    """A difference and what it may be."""
    good = found <= bound
    print(f"  {what}: {found:.1e}{'' if good else f'  MORE THAN {bound:.0e}'}")
    if not good:
        FAULTS.append(what)


def run(*command):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True, cwd=ROOT).stdout


def table(path):
    """Rows of the last frame of an extended XYZ file by column, by our own few lines."""
    lines = Path(path).read_text().splitlines()
    count, comment = int(lines[0]), lines[1]
    layout = re.search(r"Properties=(\S+)", comment).group(1).split(":")
    rows, columns, at = [line.split() for line in lines[2 : 2 + count]], {}, 0
    for name, _, width in zip(layout[0::3], layout[1::3], layout[2::3]):
        columns[name] = [row[at : at + int(width)] for row in rows]
        at += int(width)
    numbers = dict(re.findall(r"(\w+)=([-+0-9.eE]+)(?=\s|$)", comment))
    return {name: [[float(v) for v in row] for row in rows] for name, rows in columns.items() if name != "species"}, numbers


def farthest(a, b):
    return max(abs(x - y) for row, other in zip(a, b, strict=True) for x, y in zip(row, other))


def scene(out, jamscope):
    """A small run whose files the others read."""
    file = out / "scene.toml"
    file.write_text('disk_count = 400\n[[sample]]\nname = "dense"\nseed = 1\nsource = { pressure = 2000.0 }\n')
    run(jamscope, "run", file, "--out", out / "report")
    return out / "report" / "dense.packing.xyz", out / "report" / "dense.displacement.xyz"


def with_ase(out, files, jamscope):
    import ase
    from ase.io import read, write

    print(f"ASE {ase.__version__}")
    for file in files:
        ours, _ = table(file)
        atoms = read(file)
        check(f"{file.name}: positions", farthest(atoms.positions.tolist(), ours["pos"]), 0.0)
        check(f"{file.name}: radii", farthest([[r] for r in atoms.arrays["radius"]], ours["radius"]), 0.0)
        if "displacement" in ours:
            check(f"{file.name}: displacements", farthest(atoms.arrays["displacement"].tolist(), ours["displacement"]), 0.0)
        periodic = "Lattice" in file.read_text().splitlines()[1]
        check(f"{file.name}: periodic in the plane or not at all", float(list(atoms.pbc) != [periodic, periodic, False]), 0.0)
    atoms = read(files[0])
    write(out / "by_ase.xyz", atoms, format="extxyz", columns=["symbols", "positions", "radius", "id"])
    back = json.loads(run(jamscope, "inspect", out / "by_ase.xyz", "--law", "hertzian", "--json"))
    ours = json.loads(run(jamscope, "inspect", files[0], "--json"))
    # ASE writes eight decimals: overlaps of some 0.05 are off by 1e-8 each, the pressure in the mean by less.
    check("by way of ASE: pressure, relative (eight decimals)", abs(back["pressure"] / ours["pressure"] - 1), 1e-6)


def with_ovito(out, files, jamscope):
    import ovito
    from ovito.io import export_file, import_file

    print(f"OVITO {ovito.version_string}")
    for file in files:
        ours, _ = table(file)
        data = import_file(str(file)).compute()
        # Its reader of decimals is off by a unit in the last place here and there: coordinates are below 64.
        check(f"{file.name}: positions", farthest(data.particles.positions[...].tolist(), ours["pos"]), 64 * 2**-52)
        # A radius has single precision there.
        radii = [[float(r)] for r in data.particles["Radius"][...]]
        check(f"{file.name}: radii (single precision)", farthest(radii, ours["radius"]), 5e-8)
        if "displacement" in ours:
            name = next(name for name in data.particles.keys() if name.lower() == "displacement")
            check(f"{file.name}: displacements", farthest(data.particles[name][...].tolist(), ours["displacement"]), 2**-52)
    pipeline = import_file(str(files[0]))
    columns = ["Particle Type", "Position.X", "Position.Y", "Position.Z", "Radius", "Particle Identifier"]
    export_file(pipeline, str(out / "by_ovito.xyz"), "xyz", columns=columns, precision=17)
    back = json.loads(run(jamscope, "inspect", out / "by_ovito.xyz", "--law", "hertzian", "--json"))
    ours = json.loads(run(jamscope, "inspect", files[0], "--json"))
    check("by way of OVITO: disks", abs(back["disk_count"] - ours["disk_count"]), 0)
    # Radii of single precision: 0.7 is off by 1.2e-8, overlaps by as much, the pressure by a few times 1e-7 of itself.
    check("by way of OVITO: pressure, relative (radii in single precision)", abs(back["pressure"] / ours["pressure"] - 1), 2e-6)


def with_lammps(out, jamscope, example):
    from lammps import lammps

    for law, style in (("hertz", "gran/hertz/history"), ("hooke", "gran/hooke/history")):
        source = ROOT / "fixtures" / "packings" / f"{law}_N1000_p100.xyz"
        data, forces = out / f"{law}.data", out / f"{law}_forces.xyz"
        run(example, source, data, forces, "0.01", *(["hookean"] if law == "hooke" else []))
        ours, told = table(forces)
        program = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        print(f"LAMMPS {program.version()}, {style}, every coordinate moved by up to 0.01")
        program.commands_string(
            f"""
            units lj
            dimension 2
            boundary p p p
            atom_style sphere
            atom_modify map array
            comm_modify vel yes
            newton on
            read_data {data}
            pair_style {style} {STIFFNESS} 0.0 0.0 0.0 0.0 0
            pair_coeff * *
            neighbor 0.1 bin
            compute local all pair/local dist force
            compute ends all property/local patom1 patom2 cutoff radius
            compute press all pressure NULL pair
            thermo_style custom step pe c_press[1] c_press[2]
            thermo_modify norm no
            fix still all nve/sphere
            timestep 0.0
            run 0
            """
        )
        ids = program.numpy.extract_atom("id")[:1000]
        found = program.numpy.extract_atom("f")[:1000]
        radius = program.numpy.extract_atom("radius")[:1000]
        mass = program.numpy.extract_atom("rmass")[:1000]
        at = {int(label[0]): row for label, row in zip(ours["id"], range(1000))}
        check("mass - 1", max(abs(m - 1.0) for m in mass), 4e-16)
        check("radii", max(abs(r - ours["radius"][at[int(i)]][0]) for i, r in zip(ids, radius)), 0.0)
        largest = max(abs(v) for row in ours["force"] for v in row)
        off = max(abs(f[d] - ours["force"][at[int(i)]][d]) for i, f in zip(ids, found) for d in range(2))
        check("forces, of the largest", off / largest, 1e-12)
        # LAMMPS in two dimensions: pressure over the area of the box (height 1).
        stress = program.numpy.extract_compute("press", 0, 1)
        pressure = 0.5 * (float(stress[0]) + float(stress[1]))
        check("pressure, relative", abs(pressure / float(told["pressure"]) - 1), 1e-12)
        # Granular styles tell no energy: it is added up from LAMMPS's own forces and distances of pairs, u = F δ/α.
        pairs = program.numpy.extract_compute("local", 2, 2)
        ends = program.numpy.extract_compute("ends", 2, 2)
        size = dict(zip((int(i) for i in ids), (float(r) for r in radius)))
        label = lambda value: int(round(value))
        reach = [size[label(a)] + size[label(b)] for a, b, *_ in ends]
        alpha = 2.5 if law == "hertz" else 2.0
        energy = sum(abs(row[1]) * max(total - row[0], 0.0) / alpha for row, total in zip(pairs, reach, strict=True))
        check("energy, relative", abs(energy / float(told["energy"]) - 1), 1e-12)
        program.command(f"write_data {out / f'{law}_lammps.data'}")
        program.command(f"write_dump all custom {out / f'{law}_lammps.dump'} id type x y radius modify format float %.17g")
        program.close()
        name = "hertzian" if law == "hertz" else "hookean"
        for written in (f"{law}_lammps.data", f"{law}_lammps.dump"):
            back = json.loads(run(jamscope, "inspect", out / written, "--law", name, "--json"))
            check(f"{written} read: energy, relative", abs(back["energy"] / float(told["energy"]) - 1), 1e-12)
            check(f"{written} read: pressure, relative", abs(back["pressure"] / float(told["pressure"]) - 1), 1e-12)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="folder for files")
    parser.add_argument("--need", default="", help="programs whose absence is a failure, separated by commas")
    parser.add_argument("--target", type=Path, default=ROOT / "target" / "release", help="where cargo built")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    out = arguments.out.resolve()
    jamscope, example = arguments.target.resolve() / "jamscope", arguments.target.resolve() / "examples" / "to_lammps"
    files = scene(out, jamscope)
    parts = {
        "ase": lambda: with_ase(out, files, jamscope),
        "ovito": lambda: with_ovito(out, files, jamscope),
        "lammps": lambda: with_lammps(out, jamscope, example),
    }
    for name, part in parts.items():
        try:
            __import__(name)
        except ImportError:
            print(f"{name}: not installed, left out")
            if name in arguments.need.split(","):
                FAULTS.append(f"{name} is missing")
            continue
        part()
    print("all agree" if not FAULTS else "differ: " + "; ".join(FAULTS))
    sys.exit(1 if FAULTS else 0)


if __name__ == "__main__":
    main()
