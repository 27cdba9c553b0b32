"""The screened profile by SciPy's Bessel functions: error and ns a point, in the rows of `cargo run --release --features measurements --example exact_routes`.

d/d_0 = [Y1(kr) J1(kR) - J1(kr) Y1(kR)] / [Y1(ka) J1(kR) - J1(ka) Y1(kR)] at the points of
fixtures/reference/bessel_profile.json (25 digits), whole arrays at once, the least of several passes.
"""

import json
import time

import numpy as np
from scipy.special import j1, y1

A = 0.5
RANGES = [(0.0, 1e-3), (1e-3, 1.0), (1.0, 30.0), (30.0, 1e3), (1e3, 1e6)]


def bracket(r, outer, k):
    return (y1(k * r) * j1(k * outer) - j1(k * r) * y1(k * outer)) / (y1(k * A) * j1(k * outer) - j1(k * A) * y1(k * outer))


def main():
    table = json.load(open("fixtures/reference/bessel_profile.json"))
    # Tag "grid": points next to a node or a pole show the condition of the problem and no route.
    rows = [row for row in table["rows"] if row[4] == "grid" and float(row[1]) > 0.0]
    outer, k, r, truth = (np.array([float(row[column]) for row in rows]) for column in range(4))
    for low, high in RANGES:
        part = (k * outer > low) & (k * outer <= high) & (r < outer) & (r > A)
        if not part.any():
            continue
        points = r[part], outer[part], k[part]
        error = np.abs(bracket(*points) / truth[part] - 1.0)
        near = (points[1] - points[0]) / points[1] < 0.02
        # Large enough that the call of a function costs nothing a point.
        many = [np.tile(column, 1 + 100_000 // part.sum()) for column in points]
        least = min(timed(many) for _ in range(7))
        worst = [f"{error[which].max():.1e}" if which.any() else "-" for which in (~near, near)]
        print(f"| {low:g} to {high:g} | {part.sum()} | bracket, SciPy | {worst[0]} | {worst[1]} | {least:.0f} |")


def timed(points):
    begin = time.perf_counter()
    bracket(*points)
    return 1e9 * (time.perf_counter() - begin) / len(points[0])


if __name__ == "__main__":
    main()
