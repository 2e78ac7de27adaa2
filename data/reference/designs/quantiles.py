"""Quantiles of the standard normal distribution, for the tests of crates/sweep.

Run: python quantiles.py > quantiles.csv        (made with mpmath 1.3.0)

Columns: probability, quantile. The probability is exactly the double that is printed;
the quantile solves Phi(x) = p with 50 digits and is then rounded.
"""

import mpmath

mpmath.mp.dps = 50
probabilities = [2.0**-53, 1e-12, 1e-6, 1e-3, 0.01, 0.02425, 0.05, 0.074, 0.076, 0.1, 0.25, 0.4, 0.4999, 0.5]
probabilities += [0.6, 0.75, 0.9, 0.924, 0.926, 0.975, 0.99, 0.999, 1 - 1e-6, 1 - 1e-12, 1 - 2.0**-53]

print("probability,quantile")
for p in probabilities:
    exact = mpmath.mpf(p)
    # Newton with the right precision, started from the other tail where that is closer.
    start = -mpmath.sqrt(-2 * mpmath.log(min(exact, 1 - exact))) / 1.2 if p != 0.5 else 0
    x = mpmath.findroot(lambda x: mpmath.ncdf(x) - min(exact, 1 - exact), start)
    print(f"{p!r},{float(x if exact <= 0.5 else -x)!r}")
