"""Points of Sobol's sequence as scipy makes them, for the tests of crates/sweep.

Run: python sobol.py > sobol.csv        (made with scipy 1.17.1, numpy 2.4.6)

Columns: index of the point, dimension (from 0), coordinate times 2^52. Unscrambled, all
64 dimensions; the first 40 points, then some far out. The direction numbers of scipy are
those of Joe and Kuo (2008), new-joe-kuo-6.21201. A coordinate of a point below 2^30 has at
most 30 binary digits, so every value is exact and the test compares whole numbers.
"""

from scipy.stats import qmc

DIMENSIONS, DIGITS = 64, 52


def write(index, point):
    for dimension, digits in enumerate(point):
        print(f"{index},{dimension},{int(digits)}")


print("index,dimension,digits")
for start, count in [(0, 40), (1000, 3), (2**20 + 12345, 2)]:
    engine = qmc.Sobol(DIMENSIONS, scramble=False, bits=30)
    if start > 0:
        engine.fast_forward(start)
    for i, point in enumerate(engine.random(count)):
        write(start + i, point * 2**DIGITS)

# Beyond 2^32 scipy's fast_forward stops with an error; its table of direction numbers does not.
far = 2**34 + 987654321
directions = qmc.Sobol(DIMENSIONS, scramble=False, bits=DIGITS)._sv
point = directions[:, 0] * 0
for k in range(DIGITS):
    if (far ^ far >> 1) >> k & 1:
        point ^= directions[:, k]
write(far, point)
