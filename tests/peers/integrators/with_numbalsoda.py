"""numbalsoda on the machine, all of it compiled.

METHOD is lsoda or dop853, with `-restart` to begin anew at the dead centres, where the gas force
jumps.
"""

import numpy as np
from machine import REVOLUTION, SAMPLES, accelerations, derivative, serve
from numba import carray, cfunc, njit
from numbalsoda import dop853, lsoda, lsoda_sig


@cfunc(lsoda_sig)
def right_hand_side(t, y, dy, data):
    half, clearance = carray(data, (2,))
    derivative(t, carray(y, (8,)), carray(dy, (8,)), int(half), clearance)


ADDRESS = right_hand_side.address


@njit
def solve(high_order, restart, tolerance, count, clearance):
    out = np.empty(count)
    length = SAMPLES // 2 if restart else count
    y = np.zeros(8)
    data = np.array([-1.0, clearance])
    for first in range(0, count, length):
        if restart:
            data[0] = first // length
        at = np.arange(first, first + length + 1) * (REVOLUTION / SAMPLES)
        if high_order:
            states, success = dop853(ADDRESS, y, at, data, rtol=tolerance, atol=tolerance,
                                     mxstep=10_000_000)
        else:
            states, success = lsoda(ADDRESS, y, at, data, rtol=tolerance, atol=tolerance,
                                    mxstep=10_000_000)
        if not success:
            out[first:] = np.nan
            break
        accelerations(first, states[:-1], int(data[0]), clearance, out[first:first + length])
        y = states[-1].copy()
    return out


def run(method, tolerance, revolutions, clearance):
    count = revolutions * SAMPLES
    return solve(method.startswith("dop853"), method.endswith("-restart"), tolerance, count,
                 clearance)


if __name__ == "__main__":
    serve(run)
