"""Makes matlab-v7.mat and matlab-v6.mat with SciPy, a writer that is not ours.

    pip install numpy scipy==1.17.1 && python make.py

Times, a vector, a matrix of two channels, whole numbers, a speed, and what is to be passed over.
"""
import numpy as np
from scipy.io import savemat

n = 200
t = np.arange(n) / 1000
variables = {
    "t_s": t.reshape(-1, 1),
    "acc_m_s2": np.sin(2 * np.pi * 50 * t).reshape(1, -1),
    "raw": np.column_stack([np.arange(n), -np.arange(n)]).astype(np.int16),
    "X097RPM": np.array([[1796]], dtype=np.uint16),
    "fs": 1000.0,
    "note": "text",
    "cell": np.array([1, "a"], dtype=object),
    "phasor": np.exp(1j * t),
}
for name, compressed in [("matlab-v7.mat", True), ("matlab-v6.mat", False)]:
    savemat(name, variables, do_compression=compressed, oned_as="column")
    # The date in the heading would change from run to run.
    with open(name, "r+b") as file:
        file.write(b"MATLAB 5.0 MAT-file, SciPy".ljust(116))
