"""SciPy on the machine, right-hand side by numba.

METHOD is a method of `solve_ivp` (LSODA, DOP853, Radau, BDF, RK45) or `odeint`, the older interface
to LSODA; with `-restart` it begins anew at the dead centres, where the gas force jumps.
"""

import numpy as np
from machine import SAMPLES, accelerations, derivative, serve, times
from numba import njit
from scipy.integrate import odeint, solve_ivp


@njit("f8[:](f8, f8[:], i8, f8)")
def right_hand_side(t, y, half, clearance):
    dy = np.empty(8)
    derivative(t, y, dy, half, clearance)
    return dy


@njit("f8[:](f8[:], f8, i8, f8)")
def state_first(y, t, half, clearance):
    return right_hand_side(t, y, half, clearance)


def span(method, tolerance, y, first, count, half, clearance):
    """States of `count` samples from number `first` on, and one more."""
    at = times(first, count + 1)
    if method == "odeint":
        return odeint(state_first, y, at, args=(half, clearance), rtol=tolerance, atol=tolerance,
                      mxstep=1_000_000, tcrit=[at[-1]])
    found = solve_ivp(right_hand_side, (at[0], at[-1]), y, method, at, rtol=tolerance,
                      atol=tolerance, args=(half, clearance))
    return found.y.T


def run(method, tolerance, revolutions, clearance):
    method, restart, _ = method.partition("-restart")
    out = np.empty(revolutions * SAMPLES)
    length = SAMPLES // 2 if restart else len(out)
    y = np.zeros(8)
    for first in range(0, len(out), length):
        half = first // length if restart else -1
        states = span(method, tolerance, y, first, length, half, clearance)
        accelerations(first, np.ascontiguousarray(states[:-1]), half, clearance,
                      out[first:first + length])
        y = states[-1]
    return out


if __name__ == "__main__":
    serve(run)
