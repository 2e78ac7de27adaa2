"""Writes reference.csv: what SciPy and NumPy say to inputs that the tests make by formula.

    python -m venv venv && venv/bin/pip install numpy scipy && venv/bin/python make.py

One line per array: its name, then its numbers. Line 1 names the versions.
"""

import pathlib

import numpy as np
import scipy
from scipy import interpolate, signal, stats

rows = {}

# The input of most rows: two sines, a chirp and a spike, with a mean. No random numbers, so that
# the tests can make it again. Rounded to float32 because recordings are.
i = np.arange(240)
x = 2 + 3 * np.sin(0.31 * i) + 0.5 * np.cos(1.7 * i + 0.2) + 0.8 * np.sin(0.004 * i * i)
x[100] += 9
x = x.astype(np.float32).astype(float)
rows["input"] = x

for window in ("hann", "flattop"):
    rows[f"window_{window}"] = signal.get_window(window, 24, fftbins=True)
    density = signal.periodogram(x, 1.0, window, detrend=False, scaling="spectrum")[1]
    # The periodogram of scaling "spectrum" holds mean squares: A²/2 off 0 Hz and Nyquist.
    amplitude = np.sqrt(2 * density)
    amplitude[[0, -1]] /= np.sqrt(2)
    rows[f"amplitude_{window}"] = amplitude

# firwin's Kaiser design with the prototype's length and beta, applied without delay.
taps = signal.firwin(2 * 15 * 3 + 1, 1 / 3, window=("kaiser", 0.1102 * (90 - 8.7)))
rows["decimated_by_3"] = np.convolve(x, taps, "valid")[::3]

for order in range(1, 9):
    sos = signal.butter(order, 0.08, fs=1.0, output="sos")
    settled = signal.sosfilt_zi(sos) * x[0]
    rows[f"butterworth_{order}"] = signal.sosfilt(sos, x, zi=settled)[0][:60]

# A second-order resonance at 0.08 of the sample rate, zeta 0.05: bilinear, pre-warped there.
omega = 2 * np.tan(np.pi * 0.08)
b, a = signal.bilinear([omega**2], [1, 2 * 0.05 * omega, omega**2], fs=1.0)
rows["resonance"] = signal.lfilter(b, a, x)[:60]

# An encoder of 16 bits (away from 0, where rounding decides which step is read) on a shaft at 900 samples per revolution, smoothed over 2 degrees
# (five samples) and at 2000 samples per revolution (eleven samples) to either side.
for rate in (900, 2000):
    turn = 2 * np.pi * np.arange(rate + 40) / rate + 0.0123
    step = 2 * np.pi / 65536
    angle = np.floor((turn + 0.02 * np.sin(2 * turn)) / step) * step
    half = round(2 * np.pi / 180 * (len(angle) - 1) / (angle[-1] - angle[0]))
    smooth = signal.savgol_filter(angle, 2 * half + 1, 2, mode="interp")
    rows[f"angle_{rate}"] = smooth[:: rate // 30]

# Orders of a wave with sharp crests on a shaft with fluctuating speed: a cubic spline of the
# wave over the angle, and the DFT of 1024 points of each of three revolutions. The wave does not
# close after one revolution, so the number of points matters to the RMS over revolutions.
turn = 2 * np.pi * np.arange(3001) / 1000
theta = turn + 0.02 * np.sin(2 * turn)
wave = np.exp(2 * np.cos(theta - 0.5)) * (1 + 0.1 * np.cos(theta / 3))
points = 2 * np.pi * np.arange(3 * 1024) / 1024
spline = interpolate.CubicSpline(theta, wave)(points).reshape(3, -1)
orders = 2 / 1024 * np.fft.fft(spline, axis=1)[:, 1:21]
rows["orders_re"] = orders.mean(axis=0).real
rows["orders_im"] = orders.mean(axis=0).imag
rows["orders_rms"] = np.sqrt((np.abs(orders) ** 2).mean(axis=0))

# Segments of 64 that overlap by half.
for window in ("hann", "flattop"):
    rows[f"welch_{window}"] = signal.welch(x, 50.0, window, 64, scaling="density")[1]
frequency, density = signal.welch(x, 50.0, "hann", 64)
share = density / density.sum()
centroid = (frequency * share).sum()
spread = np.sqrt(((frequency - centroid) ** 2 * share).sum())
rows["spectral_shape"] = [centroid, spread, stats.entropy(density) / np.log(len(density))]

power = np.abs(signal.stft(x, window="hann", nperseg=16, detrend="constant", boundary=None, padded=False)[2]) ** 2
rows["spectral_kurtosis"] = (power**2).mean(axis=1) / power.mean(axis=1) ** 2 - 2

magnitude = np.abs(np.fft.fft(x - x.mean()))
rows["cepstrum"] = np.fft.ifft(np.log(np.maximum(magnitude, 1e-4 * magnitude.max()))).real[:121]

# Bands of the kurtogram at a sample rate of 100: the analytic signal without the line through
# its ends, filtered and brought to the centre of the band at every sample.
line = x[0] + (x[-1] - x[0]) * i / (len(x) - 1)
analytic = np.fft.fft(signal.hilbert(x - line))
analytic[0] = 0
bins = np.fft.fftfreq(len(x), 0.01)


def complex_envelope(centre, width):
    distance = np.abs(bins - centre) / width
    weight = np.where((distance < 1) & (bins >= 0), np.cos(np.pi / 2 * distance) ** 2, 0)
    # The Nyquist bin counts as positive, fftfreq calls it negative.
    weight[120] = np.cos(np.pi / 2 * abs(50 - centre) / width) ** 2 if 50 - centre < width else 0
    return np.fft.ifft(analytic * weight)


rows["envelope"] = np.abs(complex_envelope(30.0, 20.0))
rows["envelope_spectrum"] = np.sqrt(
    2 * signal.periodogram(rows["envelope"], 100.0, "hann", scaling="spectrum")[1]
)
rows["envelope_spectrum"][[0, -1]] /= np.sqrt(2)

# The cells of the kurtogram over four times the input, one after the other, each with as many
# points as the next power of two above twice its bins.
long = np.concatenate([x, x[::-1], x, -x])
long = long - np.linspace(long[0], long[-1], len(long))
transform = np.fft.fft(long)
cells = []
for count in (1, 2, 3, 4, 6):
    width = len(long) / 2 / count
    points = 2 ** int(np.ceil(np.log2(np.ceil(2 * width))))
    margin = int(np.ceil(2 * points / width))
    for band in range(count):
        centre = (band + 0.5) * width
        k = np.arange(1, len(long) // 2 + 1)
        k = k[np.abs(k - centre) < width]
        # Values at equal steps over the record, by the sum that the inverse transform is.
        time = np.arange(margin, points - margin) / points
        weight = np.cos(np.pi / 2 * (k - centre) / width) ** 2 * np.where(k == len(long) // 2, 1, 2)
        c = np.exp(2j * np.pi * np.outer(time, k - int(centre))) @ (transform[k] * weight)
        power = np.abs(c) ** 2
        cells.append((power**2).mean() / power.mean() ** 2 - 2)
rows["kurtogram"] = cells

absolute = np.abs(x)
rms = np.sqrt((x**2).mean())
rows["statistics"] = [
    x.mean(),
    rms,
    absolute.max(),
    np.ptp(x),
    absolute.max() / rms,
    rms / absolute.mean(),
    absolute.max() / absolute.mean(),
    absolute.max() / np.sqrt(absolute).mean() ** 2,
    stats.skew(x),
    stats.kurtosis(x, fisher=False),
]

lines = [f"# numpy {np.__version__}, scipy {scipy.__version__}"]
lines += [",".join([name, *(repr(float(v)) for v in values)]) for name, values in rows.items()]
pathlib.Path(__file__).with_name("reference.csv").write_text("\n".join(lines) + "\n")
