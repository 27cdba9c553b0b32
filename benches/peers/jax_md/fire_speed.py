"""CPU time per particle step of jax-md's FIRE on Hertzian disks: one JSON line a run.

    . FOLDER/bin/activate                          (see setup.sh)
    python benches/peers/jax_md/fire_speed.py [PACKING] [--steps N] [--replicate K] [--format sparse|ordered|dense]

The problem is that of ../lammps/fire_speed.py, case `inflated`: one small disk grows by 0.1 and is held. Double precision, one
thread (XLA is told so, and the process is bound to one core where the system can do that). FIRE as `minimize.fire_descent`
has it, compiled in loops of 20 steps; the neighbour list (skin 0.1, half of the pairs once unless --format says otherwise) is asked
whether it still holds after each. Compilation is not counted: the same loop runs once before the clock starts.
"""

import argparse
import json
import os
import pathlib
import re
import sys
import time

os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
os.environ["OMP_NUM_THREADS"] = "1"
os.environ["JAX_ENABLE_X64"] = "1"
os.environ["JAX_PLATFORMS"] = "cpu"
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})

import jax  # noqa: E402
import jax.numpy as jnp  # noqa: E402
import numpy as np  # noqa: E402
from jax_md import energy, minimize, partition, space  # noqa: E402

GROWTH = 0.1
STIFFNESS = 2e5
SKIN = 0.1
STEPS_A_LOOP = 20
# First and largest time step: the largest one at which FIRE settles at p = 100 is that of LAMMPS's side, ten times 0.0003.
FIRST_STEP, LARGEST_STEP = 0.0003, 0.003


def packing_of(path, replicate):
    """The packing of the other peer, read by its own functions (without its program)."""
    source = pathlib.Path(__file__).parent.parent.joinpath("lammps/fire_speed.py").read_text()
    names = {"re": re}
    parts = re.findall(r"^def (?:read_packing|tiled|middle_small_disk)\(.*?(?=^def )", source, flags=re.S | re.M)
    exec("\n".join(parts), names)
    sides, disks = names["tiled"](*names["read_packing"](path), replicate)
    held = names["middle_small_disk"](sides, disks)
    x, y, radius = disks[held]
    disks[held] = (x, y, radius + GROWTH)
    return sides, disks, held


def run(sides, disks, held, steps, form):
    """CPU seconds, lists made and largest force after so many steps."""
    radii = np.array([radius for _, _, radius in disks])
    kinds, kind = np.unique(radii, return_inverse=True)
    reach = kinds[:, None] + kinds[None, :]
    effective = kinds[:, None] * kinds[None, :] / reach
    # E = (2/5) k sqrt(R_eff) delta^(5/2) = (epsilon / alpha) (1 - r / sigma)^alpha with alpha = 5/2.
    epsilon = STIFFNESS * np.sqrt(effective) * reach**2.5
    box = np.array(sides)
    displacement, shift = space.periodic(box)
    make_list, energy_of = energy.soft_sphere_neighbor_list(
        displacement, box, species=jnp.array(kind), sigma=jnp.array(reach), epsilon=jnp.array(epsilon), alpha=2.5,
        dr_threshold=SKIN, format=form,
    )
    mobile = jnp.ones((len(disks), 1)).at[held].set(0.0)
    gradient = jax.grad(energy_of)

    def force(position, neighbor, **_):
        return -gradient(position, neighbor=neighbor) * mobile

    first, step = minimize.fire_descent(force, shift, dt_start=FIRST_STEP, dt_max=LARGEST_STEP)

    @jax.jit
    def loop(state, neighbors):
        state = jax.lax.fori_loop(0, STEPS_A_LOOP, lambda _, state: step(state, neighbor=neighbors), state)
        return state, neighbors.update(state.position)

    position = jnp.mod(jnp.array([(x, y) for x, y, _ in disks]), box)
    neighbors = make_list.allocate(position)
    start = first(position, neighbor=neighbors)
    jax.block_until_ready(loop(start, neighbors))
    state, lists = start, 0
    begin = time.process_time()
    for _ in range(steps // STEPS_A_LOOP):
        state, neighbors = loop(state, neighbors)
        if bool(neighbors.did_buffer_overflow):
            neighbors = make_list.allocate(state.position)
            lists += 1
    jax.block_until_ready(state)
    seconds = time.process_time() - begin
    forces = force(state.position, neighbors)
    return seconds, lists, float(jnp.max(jnp.linalg.norm(forces, axis=1)))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("packing", nargs="?", default="fixtures/packings/hertz_N5548_p100.xyz")
    parser.add_argument("--steps", type=int, default=2000)
    parser.add_argument("--replicate", type=int, default=1)
    parser.add_argument("--format", choices=("sparse", "ordered", "dense"), default="ordered")
    arguments = parser.parse_args()
    forms = partition.NeighborListFormat
    form = {"sparse": forms.Sparse, "ordered": forms.OrderedSparse, "dense": forms.Dense}[arguments.format]
    sides, disks, held = packing_of(arguments.packing, arguments.replicate)
    steps = arguments.steps - arguments.steps % STEPS_A_LOOP
    seconds, lists, force = run(sides, disks, held, steps, form)
    line = {
        "code": f"jax {jax.__version__}, jax-md",
        "case": "inflated",
        "law": "hertz",
        "format": arguments.format,
        "disks": len(disks),
        "steps": steps,
        "cpu_seconds": round(seconds, 4),
        "ns_per_particle_step": round(1e9 * seconds / (steps * len(disks)), 2),
        "buffers_made_anew": lists,
        "largest_force": force,
    }
    print(json.dumps(line), flush=True)


if __name__ == "__main__":
    sys.exit(main())
