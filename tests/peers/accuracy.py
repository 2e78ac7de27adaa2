"""How near the largest Lyapunov exponent comes to the true one, by peers with their automatic
settings and by this project, from one signal each.

    python tests/peers/accuracy.py [--samples 10000] [--seeds 5] [--noise 0 0.01 0.05] [--systems ...]

The table, printed as Markdown and written to data/results/exponents.csv, holds the median over the
seeds of |found/true - 1|. Automatic means: called with the signal alone, or with the embedding that the package itself chooses. The
sampling interval is put in afterwards.
"""

import ours  # noqa: I001  (sets the number of threads, finds results)
import results

import argparse
import time
import warnings
from importlib.metadata import version

import neurokit2
import nolds
import numpy as np

# Exponents per sample and where they come from: chaos::test_systems, by the tangent method.
TRUE = {"logistic": np.log(2), "Henon": 0.4193, "Lorenz": 0.906 * 0.04, "Roessler": 0.0714 * 0.3,
        "Mackey-Glass": 0.00513 * 2.5, "Duffing": 0.1047 * 2 * np.pi / 1.2 / 20}


def nolds_rosenstein(x):
    return nolds.lyap_r(x)


def nolds_eckmann(x):
    return max(nolds.lyap_e(x))


def neurokit_plain(x):
    return neurokit2.complexity_lyapunov(x)[0]


def neurokit_embedded(x, method="rosenstein1993"):
    delay, _ = neurokit2.complexity_delay(x, delay_max=50, method="fraser1986")
    dimension, _ = neurokit2.complexity_dimension(x, delay=delay, dimension_max=8, method="afn")
    return neurokit2.complexity_lyapunov(x, delay=delay, dimension=dimension, method=method)[0]


def neurokit_makowski(x):
    return neurokit_embedded(x, "makowski")


def crosshead(chaos):
    def found(x):
        path = ours.SIGNALS / "exponent.txt"
        np.savetxt(path, x, fmt="%.17g")
        return ours.measures(chaos, "exponent", path)["exponent"][1][0]

    return found


def main():
    arguments = argparse.ArgumentParser(description="Compare exponents.")
    arguments.add_argument("--samples", type=int, default=10_000)
    arguments.add_argument("--seeds", type=int, default=5)
    arguments.add_argument("--noise", type=float, nargs="+", default=[0.0, 0.01, 0.05])
    arguments.add_argument("--systems", nargs="+", choices=TRUE, default=list(TRUE))
    arguments = arguments.parse_args()
    warnings.simplefilter("ignore")

    chaos = ours.build("chaos", "time_chaos")
    methods = {
        f"nolds {version('nolds')} lyap_r": nolds_rosenstein,
        f"nolds {version('nolds')} lyap_e": nolds_eckmann,
        f"neurokit2 {version('neurokit2')} rosenstein1993": neurokit_plain,
        "the same, own embedding": neurokit_embedded,
        "makowski, own embedding": neurokit_makowski,
        "ours": crosshead(chaos),
    }
    print("| signal | noise | " + " | ".join(methods) + " |")
    print("| --- | --- |" + " --- |" * len(methods))
    spent = dict.fromkeys(methods, 0.0)
    rows = []
    for system in arguments.systems:
        for noise in arguments.noise:
            seeds = range(1, arguments.seeds + 1)
            signals = [np.loadtxt(ours.samples(chaos, system, arguments.samples, s, noise)) for s in seeds]
            cells = []
            for name, method in methods.items():
                start = time.perf_counter()
                errors = [abs(value_of(method, x) / TRUE[system] - 1) for x in signals]
                spent[name] += time.perf_counter() - start
                cells.append(f"{100 * np.median(errors):.0f} %")
                rows.append({"system": system, "noise": noise, "samples": arguments.samples,
                             "seeds": arguments.seeds, "method": name, "error": f"{np.median(errors):.3g}"})
            print(f"| {system} | {100 * noise:.0f} % | " + " | ".join(cells) + " |", flush=True)
    runs = arguments.seeds * len(arguments.noise) * len(arguments.systems)
    print("\nSeconds for a signal: " + ", ".join(f"{name} {s / runs:.2f}" for name, s in spent.items()))
    print(results.write("exponents.csv", rows))


def value_of(method, x):
    """Not a number where a package fails or abstains; then the median is none either."""
    try:
        return float(method(x))
    except Exception:
        return np.nan


if __name__ == "__main__":
    main()
