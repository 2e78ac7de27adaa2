"""How fast the measures of this project are beside those of their peers, one thread each.

    python tests/peers/speed.py [SECTION...] [--systems ...]

Sections: divergence, entropy, recurrence, analysis, classic, kurtogram; the default is all. The tables
are printed as Markdown and written to data/results/measures.csv.
A peer's values are compared with ours where both compute the same thing; exit status 1 if they
differ.
"""

import ours  # noqa: I001  (sets the number of threads, finds results)
import results

import argparse
import math
import shutil
import sys
from importlib.metadata import version

import numpy as np
from scipy import fft, signal, stats

SYSTEMS = ("logistic", "Henon", "Lorenz", "Roessler", "Mackey-Glass", "Duffing")
LENGTH = 10_000
DIMENSION, STEPS = 4, 50
# Vectors of the recurrence plot, as many as ours takes at most.
VECTORS = 4000

differences = []
# What was printed, a figure each, and the table that is being printed.
figures = []
table = {}


def line(*cells):
    print("| " + " | ".join(str(c) for c in cells) + " |", flush=True)


def row(*cells):
    line(*cells)
    names = table["columns"].index("peer") + 1 if "peer" in table["columns"] else 1
    for column, cell in zip(table["columns"][names:], cells[names:]):
        figures.append({"table": table["title"], "row": ", ".join(cells[:names]), "column": column,
                        "value": str(cell).strip("*")})


def header(title, *cells):
    print(f"\n{title}\n")
    table.update(title=title, columns=cells)
    line(*cells)
    line(*("---" for _ in cells))


def ms(seconds):
    return f"{1e3 * seconds:.2f}"


def compare(what, found, expected, tolerance):
    if not np.allclose(found, expected, rtol=tolerance, atol=0):
        differences.append(f"{what}: {found} is not {expected}")


# ---- the divergence curve


def divergence(systems):
    """Whole processes on the same file: read it, find the curve, write it."""
    tisean = shutil.which("lyap_r")
    if tisean is None:
        print("\nNo `lyap_r` on the PATH: the divergence curve is not compared with TISEAN's.")
        return
    chaos = ours.build("chaos", "time_chaos")
    header(f"Divergence curve, {LENGTH} samples, dimension {DIMENSION}, {STEPS} steps: whole processes",
           "signal", "TISEAN lyap_r (ms)", "ours (ms)", "ratio", "ours (MB)",
           "largest difference of the curves")
    for system in systems:
        path = ours.samples(chaos, system, LENGTH, 1)
        delay, theiler = (int(n) for n in ours.measures(chaos, "times", path)["times"][1])
        curve = ours.SIGNALS / "curve.txt"
        theirs = ours.process([tisean, f"-m{DIMENSION}", f"-d{delay}", f"-t{theiler}", f"-s{STEPS}",
                               "-V0", "-o", curve, path])
        command = [chaos, "curve", path, DIMENSION, delay, theiler, STEPS]
        own = ours.process(command)
        found = ours.measures(*command)
        memory = found["memory"][1][0]
        # lyap_r scales the signal to a range of 1, which shifts the curve.
        x = np.loadtxt(path)
        difference = np.abs(np.loadtxt(curve)[:, 1] + math.log(np.ptp(x)) - found["curve"][1]).max()
        row(system, ms(theirs), ms(own), f"{theirs / own:.1f}", f"{memory:.1f}", f"{difference:.0e}")
        if difference > 2e-2:
            differences.append(f"divergence curve of {system}: {difference}")


# ---- entropy and recurrence


def sample_entropies(x, tolerance):
    import EntropyHub
    import antropy
    import neurokit2
    import nolds

    yield "antropy", lambda: antropy.sample_entropy(x, 2, tolerance=tolerance)
    yield "neurokit2", lambda: neurokit2.entropy_sample(x, dimension=2, tolerance=tolerance)[0]
    yield "nolds", lambda: nolds.sampen(x, 2, tolerance=tolerance)
    yield "EntropyHub", lambda: EntropyHub.SampEn(x, m=2, r=tolerance)[0][2]


def recurrences(x, delay, theiler, radius):
    """Each gives determinism and mean diagonal, and what more it has."""
    from pyrqa.analysis_type import Classic
    from pyrqa.computation import RQAComputation
    from pyrqa.metric import EuclideanMetric
    from pyrqa.neighbourhood import FixedRadius
    from pyrqa.settings import Settings
    from pyrqa.time_series import TimeSeries
    from pyunicorn.timeseries import RecurrencePlot
    from rqa_analysis.utils import rqa_utils_cpp

    settings = Settings(
        TimeSeries(x, embedding_dimension=DIMENSION, time_delay=delay),
        analysis_type=Classic,
        neighbourhood=FixedRadius(radius),
        similarity_measure=EuclideanMetric,
        theiler_corrector=theiler + 1,
    )

    def with_pyrqa():
        found = RQAComputation.create(settings, verbose=False).run()
        return found.determinism, found.average_diagonal_line

    def with_pyunicorn():
        plot = RecurrencePlot(
            x, dim=DIMENSION, tau=delay, metric="euclidean", threshold=radius, silence_level=2)
        plot.laminarity(), plot.trapping_time(), plot.diag_entropy(), plot.max_diaglength()
        return plot.determinism(), plot.average_diaglength()

    def with_rqa_analysis():
        distances = rqa_utils_cpp.rqa_dist(x, x, dim=DIMENSION, lag=delay)["d"]
        _, found, _, _ = rqa_utils_cpp.rqa_stats(
            distances, rescale=0, rad=radius, diag_ignore=theiler, minl=2, rqa_mode="auto")
        return found

    # It has no window of Theiler's: its line of identity and the pairs beside it count.
    yield "pyunicorn", with_pyunicorn, False
    yield "PyRQA", with_pyrqa, True
    yield "rqa-analysis", with_rqa_analysis, False


def measured(system):
    """A signal, and what ours finds in it."""
    binary = ours.build("chaos", "time_chaos")
    path = ours.samples(binary, system, LENGTH, 1)
    return np.loadtxt(path), ours.measures(binary, "measures", path, DIMENSION, STEPS)


def entropy(systems):
    header(f"Sample entropy, {LENGTH} samples", "signal", "peer", "peer (ms)", "ours (ms)", "ratio")
    for system in systems:
        x, found = measured(system)
        own, [value] = found["sample_entropy"]
        for name, work in sample_entropies(x, 0.2 * x.std()):
            if name == "antropy":
                work()  # compiled by its first call
            seconds, expected = ours.cpu_time(work)
            row(system, name, ms(seconds), ms(own), f"{seconds / own:.1f}")
            compare(f"sample entropy of {system} by {name}", value, expected, 1e-9)


def recurrence(systems):
    header(f"Recurrence measures, {VECTORS} vectors", "signal", "peer", "peer (ms)", "ours (ms)", "ratio")
    for system in systems:
        x, found = measured(system)
        delay, theiler = (int(n) for n in found["times"][1])
        own, numbers = found["recurrence"]
        head = x[: VECTORS + (DIMENSION - 1) * delay]
        for name, work, same in recurrences(head, delay, theiler, 0.2 * x.std()):
            work()  # PyRQA compiles its kernels in its first call
            seconds, expected = ours.cpu_time(work)
            row(system, name, ms(seconds), ms(own), f"{seconds / own:.1f}")
            if same:
                compare(f"recurrence of {system} by {name}", numbers[1:3], expected, 1e-3)


def analysis(systems):
    header(f"Full automatic analysis of {LENGTH} samples",
           "signal", "divergence curve (ms)", "analysis (ms)", "ratio")
    for system in systems:
        _, found = measured(system)
        curve, whole = found["divergence"][0], found["exponent"][0]
        row(system, ms(curve), ms(whole), f"{whole / curve:.1f}")


# ---- the classic set


RATE = 20_000.0


def knocks():
    """A second of a machine with an impact every 371 samples, a strong slow sine and noise."""
    i = np.arange(20_000)
    since = i % 371
    ring = np.exp(-since / 40) * np.sin(2 * np.pi * 3000 * since / RATE)
    noise = np.random.default_rng(1).normal(size=len(i))
    x = ring + 2 * np.sin(2 * np.pi * 10 * i / RATE) + 0.3 * noise
    # The example reads channels as they are recorded, in 32 bits.
    x = x.astype("float32").astype("float64")
    ours.SIGNALS.mkdir(parents=True, exist_ok=True)
    path = ours.SIGNALS / "knocks.txt"
    path.write_text("\n".join(map(repr, [RATE, *map(float, x)])))
    return x, path


def statistics(x):
    """Sixteen; the ten that ours names come first."""
    absolute = np.abs(x)
    mean, rms, peak = x.mean(), np.sqrt(np.mean(x * x)), absolute.max()
    low, high = x.min(), x.max()
    mean_absolute, root = absolute.mean(), np.sqrt(absolute).mean() ** 2
    return (mean, rms, peak, high - low, peak / rms, rms / mean_absolute, peak / mean_absolute, peak / root,
            stats.skew(x), stats.kurtosis(x, fisher=False),
            low, high, x.std(), x.var(), mean_absolute, root)


def spectrum(x, window):
    amplitude = np.abs(fft.rfft(x * window)) * (2 / window.sum())
    amplitude[[0, -1]] /= 2
    return amplitude


def envelope_by_transform(x, window):
    """The band cut out of one transform with the shape of ours, which is the fastest way in SciPy."""
    line = np.linspace(x[0], x[-1], len(x))
    bins = fft.rfft(x - line)
    frequency = np.arange(len(bins)) * RATE / len(x)
    centre, width = 0.15 * RATE, 0.1 * RATE
    away = (frequency - centre) / width
    shape = np.where(np.abs(away) < 1, np.cos(0.5 * np.pi * away) ** 2, 0)
    whole = np.zeros(len(x), complex)
    whole[: len(bins)] = 2 * bins * shape
    envelope = np.abs(fft.ifft(whole))
    return spectrum(envelope - envelope.mean(), window)


def envelope_by_filter(x, window):
    """As most scripts do it: a Butterworth band-pass both ways, and the Hilbert transform."""
    band = signal.butter(4, (0.1 * RATE, 0.2 * RATE), "bandpass", fs=RATE, output="sos")
    envelope = np.abs(signal.hilbert(signal.sosfiltfilt(band, x)))
    return spectrum(envelope - envelope.mean(), window)


def classic(_):
    x, path = knocks()
    found = ours.measures(ours.build("features", "time_signals"), path)
    header(f"Classic set, {len(x)} samples, SciPy {version('scipy')}",
           "part", "SciPy (ms)", "ours (ms)", "ratio")

    def hann():
        return signal.windows.hann(len(x), sym=False)

    def density():
        return signal.welch(x, RATE, "hann", nperseg=1024, detrend="constant")[1]

    parts = {
        "statistics": lambda: statistics(x),
        "fft": lambda: spectrum(x, hann()),
        "welch": density,
        "envelope": lambda: envelope_by_transform(x, hann()),
    }
    total = 0.0
    for name, work in parts.items():
        seconds, expected = ours.cpu_time(work)
        total += seconds
        own, numbers = found[name]
        compare(name, numbers, expected[: len(numbers)], 1e-6)
        row(name, ms(seconds), ms(own), f"{seconds / own:.1f}")
    own = found["classic"][0]
    row("**together**", ms(total), ms(own), f"**{total / own:.1f}**")
    seconds, _ = ours.cpu_time(lambda: envelope_by_filter(x, hann()))
    row("envelope by Butterworth and Hilbert", ms(seconds), ms(found["envelope"][0]),
        f"{seconds / found['envelope'][0]:.1f}")


# ---- the kurtogram


def filters():
    """Quasi-analytic filters of the tree: low and high halves, and thirds (Antoni 2007)."""
    i = np.arange(17)
    low = signal.firwin(17, 0.4) * np.exp(2j * np.pi * i / 8)
    high = signal.firwin(17, 0.4) * np.exp(2j * np.pi * i * 3 / 8)
    j = np.arange(25)
    thirds = [signal.firwin(25, 2 / 9) * np.exp(2j * np.pi * j * (2 * k + 1) / 12) for k in range(3)]
    return (low, high), thirds


def excess(c):
    square = (c * c.conj()).real
    return np.mean(square * square) / np.mean(square) ** 2 - 2


def fast_kurtogram(x, levels, halves, thirds):
    """Kurtosis in 1, 2, 3, 4, 6, ... 2^levels bands by a tree of decimating FIR filters."""
    nodes, found = [x - x.mean()], []
    for level in range(levels + 1):
        found.append([excess(c[16:]) for c in nodes])
        if level == levels:
            return found
        # Three bands per node stand between this level's halves and the next one's.
        if level + 1 < levels:
            found.append([excess(signal.upfirdn(h, c, down=3)[9:]) for c in nodes for h in thirds])
        nodes = [signal.upfirdn(h, c, down=2) for c in nodes for h in halves]


def kurtogram_by_transform(x, most):
    """The bands of ours, each cut from one transform."""
    line = np.linspace(x[0], x[-1], len(x))
    bins = fft.rfft(x - line)
    counts = sorted({1} | {1 << k for k in range(1, 30)} | {3 << k for k in range(30)})
    found = []
    for count in (c for c in counts if c <= most):
        width = 0.5 * len(x) / count
        points = 1 << math.ceil(math.log2(math.ceil(2 * width)))
        margin = math.ceil(2 * points / width)
        for index in range(count):
            centre = (index + 0.5) * width
            first, end = max(1, math.floor(centre - width) + 1), min(math.ceil(centre + width), len(bins))
            k = np.arange(first, end)
            band = np.zeros(points, complex)
            shape = bins[first:end] * (1 + np.cos(np.pi * (k - centre) / width))
            band[: len(k)] = shape
            found.append(excess(fft.ifft(band)[margin : points - margin]))
    return found


def kurtogram(_):
    x, path = knocks()
    own, (largest, *_, cells) = ours.measures(ours.build("features", "time_signals"), path)["kurtogram"]
    halves, thirds = filters()
    header(f"Kurtogram, {len(x)} samples, {cells:.0f} bands, SciPy {version('scipy')}",
           "peer", "peer (ms)", "ours (ms)", "ratio")
    seconds, levels = ours.cpu_time(lambda: fast_kurtogram(x, 7, halves, thirds))
    row("fast kurtogram by `upfirdn`", ms(seconds), ms(own), f"{seconds / own:.1f}")
    if abs(sum(map(len, levels)) - cells) > 0:
        differences.append(f"the fast kurtogram has {sum(map(len, levels))} bands, ours {cells}")
    seconds, bands = ours.cpu_time(lambda: kurtogram_by_transform(x, 128))
    row("our bands by `scipy.fft`", ms(seconds), ms(own), f"{seconds / own:.1f}")
    compare("largest kurtosis", largest, max(bands), 1e-6)


SECTIONS = {f.__name__: f for f in (divergence, entropy, recurrence, analysis, classic, kurtogram)}

if __name__ == "__main__":
    arguments = argparse.ArgumentParser(description="Compare speeds.")
    # Choices of a list that may be empty need their own check.
    arguments.add_argument("sections", nargs="*", help=", ".join(SECTIONS))
    arguments.add_argument("--systems", nargs="+", choices=SYSTEMS, default=SYSTEMS)
    arguments = arguments.parse_args()
    unknown = set(arguments.sections) - set(SECTIONS)
    if unknown:
        sys.exit(f"speed.py: no section {', '.join(sorted(unknown))}; there are {', '.join(SECTIONS)}")
    for name in arguments.sections or SECTIONS:
        SECTIONS[name](arguments.systems)
    print(results.write("measures.csv", figures))
    if differences:
        sys.exit("speed.py: " + "\n".join(differences))
