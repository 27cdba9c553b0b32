"""κ by `scipy.optimize.curve_fit`, from the profiles that `cargo run --release --features measurements --example fit_cost -- --write FOLDER` wrote.

Amplitude and κ are free. One start, in the middle of the range (κR = 7), and the best of many, 16 a branch of the profile, which
is how densely jamscope looks before it polishes.
"""

import pathlib
import sys
import time
import warnings

import numpy as np
from scipy.optimize import curve_fit
from scipy.special import j1, y1

A, R, LARGEST = 0.5, 42.0, 25.0 / 42.0


def model(r, amplitude, k):
    k = abs(k)
    return amplitude * (y1(k * r) * j1(k * R) - j1(k * r) * y1(k * R)) / (y1(k * A) * j1(k * R) - j1(k * A) * y1(k * R))


def fit(r, d, error, start):
    """chi², κ and its error; chi² infinite where the search fails."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            best, covariance = curve_fit(model, r, d, p0=(0.1, start), sigma=error, absolute_sigma=True)
        return np.sum(((d - model(r, *best)) / error) ** 2), abs(best[1]), np.sqrt(covariance[1, 1])
    except (RuntimeError, ValueError):
        return np.inf, np.nan, np.nan


def main():
    many = np.linspace(0.5 / R, LARGEST, int(16 * LARGEST * R / np.pi))
    for argument in ("2", "5", "9", "14"):
        files = sorted(pathlib.Path(sys.argv[1]).glob(f"{argument}_*.csv"))
        for name, starts in (("one start", [7.0 / R]), ("best of many starts", many)):
            right, seconds = 0, 0.0
            for file in files:
                r, d, error = np.loadtxt(file, delimiter=",", unpack=True)
                begin = time.perf_counter()
                _, k, of_k = min((fit(r, d, error, start) for start in starts), key=lambda found: found[0])
                seconds += time.perf_counter() - begin
                right += abs(k - float(argument) / R) <= 5 * of_k
            print(f"| {argument} | SciPy, {name} | {right} of {len(files)} | {1e3 * seconds / len(files):.2f} |")


if __name__ == "__main__":
    main()
