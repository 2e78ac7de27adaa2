"""The machine of machine.h in numba: the same equations, in scaled state.

Offsets are in clearances and rates in thousands of them a second, so one number serves as the
absolute tolerance of every component.
"""

import math
import os
import sys
import time
from pathlib import Path

import numpy as np
from numba import njit

REVOLUTION = 0.12
SAMPLES = 1200  # of a revolution, 10 kHz
SPEED = 2.0 * math.pi / REVOLUTION
R, L, CENTRE = 0.120, 0.600, 0.220
ROD_MASS, ROD_INERTIA, CROSSHEAD_MASS, GRAVITY = 12.0, 0.60, 18.0, 9.81
SUCTION, DISCHARGE, BACK, EXPONENT = 0.105e6, 0.393e6, 0.0, 1.4
HEAD, AREA = 0.024, math.pi * 0.050**2
DEPTH, FRICTION, SLIP = 1e-5, 0.05, 0.01
RADIUS_BIG, RADIUS_SMALL = 0.050, 0.035
STIFFNESS_BIG, STIFFNESS_SMALL = 2.4e10, 2.0e10
CLEARANCE = 3e-4  # of the timed machine; the sweep varies it
DAMPING = 2e4
RATE = 1e3
FILLED = (DISCHARGE / SUCTION) ** (-1.0 / EXPONENT) * (2.0 * R + HEAD)
EMPTIED = (DISCHARGE / SUCTION) ** (1.0 / EXPONENT) * HEAD


@njit(inline="always")
def contact(ex, ey, dx, dy, clearance, radius, stiffness, omega_journal, omega_bearing):
    """Force on the journal and the normal, each x and y."""
    r2 = ex * ex + ey * ey
    if r2 <= clearance * clearance:
        return 0.0, 0.0, 0.0, 0.0
    r = math.sqrt(r2)
    nx, ny, delta = ex / r, ey / r, r - clearance
    approach = nx * dx + ny * dy
    slip = nx * dy - ny * dx + omega_journal * radius - omega_bearing * (radius + r)
    s = min(delta / DEPTH, 1.0)
    push = stiffness * delta * math.sqrt(delta) + DAMPING * s * s * (3.0 - 2.0 * s) * approach
    if push <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    drag = FRICTION * push * slip / math.sqrt(slip * slip + SLIP * SLIP)
    return -push * nx + drag * ny, -push * ny - drag * nx, nx, ny


@njit(inline="always")
def pressure(distance, toward):
    if toward:
        if distance <= FILLED:
            return DISCHARGE
        if distance >= 2.0 * R + HEAD:
            return SUCTION
        return SUCTION * ((2.0 * R + HEAD) / distance) ** EXPONENT
    if distance <= HEAD:
        return DISCHARGE
    if distance >= EMPTIED:
        return SUCTION
    return DISCHARGE * (HEAD / distance) ** EXPONENT


@njit(inline="always", error_model="numpy")
def derivative(t, y, dy, half, clearance):
    """Writes the derivative in half revolution `half` (negative: that of the time) into `dy`, and
    gives the crosshead's acceleration back."""
    angle = SPEED * t
    toward = half % 2 == 1 if half >= 0 else angle % (2.0 * math.pi) >= math.pi
    sine, cosine = math.sin(angle), math.cos(angle)
    rate = RATE * clearance
    bx, by, sx, sy = y[0] * clearance, y[1] * clearance, y[2] * clearance, y[3] * clearance
    dbx, dby, dsx, dsy = y[4] * rate, y[5] * rate, y[6] * rate, y[7] * rate
    pin_x, pin_y = R * cosine, R * sine
    eye_x, eye_y = pin_x - bx, pin_y - by
    up = -(eye_y + sy) / L
    along = math.sqrt(1.0 - up * up)
    turn = -(SPEED * pin_x - dby + dsy) / (L * along)
    crosshead = eye_x + L * along + sx

    fbx, fby, nbx, nby = contact(bx, by, dbx, dby, clearance, RADIUS_BIG, STIFFNESS_BIG, SPEED,
                                 turn)
    fsx, fsy, nsx, nsy = contact(sx, sy, dsx, dsy, clearance, RADIUS_SMALL, STIFFNESS_SMALL, 0.0,
                                 turn)
    # Points of contact, from the rod's centre of mass.
    qbx = -CENTRE * along + bx + RADIUS_BIG * nbx
    qby = -CENTRE * up + by + RADIUS_BIG * nby
    qsx = (L - CENTRE) * along + sx + RADIUS_SMALL * nsx
    qsy = (L - CENTRE) * up + sy + RADIUS_SMALL * nsy
    turning = (-(qbx * fby - qby * fbx) - (qsx * fsy - qsy * fsx)) / ROD_INERTIA
    ax, ay = -(fbx + fsx) / ROD_MASS, -(fby + fsy) / ROD_MASS - GRAVITY
    gas = pressure(HEAD + R + L - crosshead, toward) - BACK
    acceleration = (fsx - gas * AREA) / CROSSHEAD_MASS

    # Acceleration of a point of the rod's axis per distance from its centre of mass.
    gx = -turning * up - turn * turn * along
    gy = turning * along - turn * turn * up
    dy[0], dy[1], dy[2], dy[3] = y[4] * RATE, y[5] * RATE, y[6] * RATE, y[7] * RATE
    dy[4] = (-SPEED * SPEED * pin_x - (ax - CENTRE * gx)) / rate
    dy[5] = (-SPEED * SPEED * pin_y - (ay - CENTRE * gy)) / rate
    dy[6] = (acceleration - (ax + (L - CENTRE) * gx)) / rate
    dy[7] = -(ay + (L - CENTRE) * gy) / rate
    return acceleration


@njit
def accelerations(first, states, half, clearance, out):
    """The crosshead's acceleration of consecutive samples, the first of which has number `first`."""
    rates = np.empty(8)
    for i in range(len(states)):
        t = (first + i) * REVOLUTION / SAMPLES
        out[i] = derivative(t, states[i], rates, half, clearance)


def times(first, count):
    """Times of `count` consecutive samples, s."""
    return np.arange(first, first + count) * (REVOLUTION / SAMPLES)


def serve(run):
    """Answers lines of METHOD TOLERANCE REVOLUTIONS FILE: writes the samples, prints CPU
    milliseconds a revolution. `run(method, tolerance, revolutions, clearance)` gives the samples.
    One process for many lines, so that compiling counts nowhere."""
    # Compiled integrators write messages to standard output: answers go another way.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    for line in sys.stdin:
        method, tolerance, revolutions, path = line.split()
        run(method, 1e-3, 1, CLEARANCE)
        start, runs, spent = time.process_time(), 0, 0.0
        while spent < 0.2:
            samples = run(method, float(tolerance), int(revolutions), CLEARANCE)
            spent = time.process_time() - start
            runs += 1
        Path(path).write_bytes(samples.astype("<f8").tobytes())
        print(f"{1e3 * spent / runs / int(revolutions):.6f}", file=answers, flush=True)
