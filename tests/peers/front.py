"""Errors of acceleration signals, and cost at a given error from a Pareto front."""

import array
import math
import sys

SAMPLES = 1200  # of a revolution
ERRORS = ("1e-3", "1e-6", "1e-8", "1e-9")


def read(path):
    """Samples of a file of little-endian f64."""
    samples = array.array("d")
    samples.frombytes(path.read_bytes())
    if sys.byteorder == "big":
        samples.byteswap()
    return samples


def counted(sample):
    """Whether a sample counts: on a dead centre the gas may be on either side of its jump."""
    return sample % (SAMPLES // 2) != 0


def relative_error(samples, reference):
    """RMS of the difference over the RMS of the reference, over the second half of the run: the
    motion has settled by then, so an error is the method's own and not that of the start."""
    if len(samples) != len(reference):
        return math.inf
    half = range(len(reference) // 2, len(reference))
    off = sum((samples[i] - reference[i]) ** 2 for i in half if counted(i))
    size = sum(reference[i] ** 2 for i in half if counted(i))
    return math.sqrt(off / size) if math.isfinite(off) else math.inf


def pareto(points):
    """The points (key, error, cost) that no other beats in both, by falling error."""
    front = []
    for point in sorted(points, key=lambda point: (point[2], point[1])):
        if math.isfinite(point[1]) and (not front or point[1] < front[-1][1]):
            front.append(point)
    return front


def bracket(front, error):
    """The points of a front on both sides of an error: two, one where the cheapest is better
    already, none where it is not reached."""
    if not front or front[-1][1] > error:
        return []
    at = next(i for i, point in enumerate(front) if point[1] <= error)
    return front[max(at - 1, 0):at + 1]


def cost(points, costs, error):
    """Cost at an error from its bracket and newly measured costs by key: interpolated in the
    logarithms."""
    if len(points) < 2:
        return costs[points[0][0]]
    (coarse, error0, _), (fine, error1, _) = points
    share = math.log(error / error0) / math.log(error1 / error0)
    return math.exp(math.log(costs[coarse]) * (1 - share) + math.log(costs[fine]) * share)
