"""The machine in absolute coordinates, for programs that bring the bodies themselves: forces on the
rod (x, y, moment about its centre of mass) and on the crosshead, as in with_mujoco.c."""

import math

import numpy as np
from machine import (AREA, BACK, CENTRE, CLEARANCE, CROSSHEAD_MASS, GRAVITY, HEAD, L, R, RADIUS_BIG,
                     RADIUS_SMALL, ROD_INERTIA, ROD_MASS, SPEED, STIFFNESS_BIG, STIFFNESS_SMALL,
                     contact, pressure)
from numba import njit

MASSES = np.array([ROD_MASS, ROD_MASS, ROD_INERTIA, CROSSHEAD_MASS])
WEIGHT = np.array([0.0, -ROD_MASS * GRAVITY, 0.0, 0.0])
TURN = -SPEED * R / L
POSE = np.array([R + CENTRE, 0.0, 0.0, R + L])
RATES = np.array([0.0, SPEED * R + CENTRE * TURN, TURN, 0.0])


@njit("void(f8, f8[::1], f8[::1], f8[::1])", error_model="numpy")
def forces(t, q, v, out):
    """Adds to `out` the forces of both joints and of the gas."""
    c, s, rest = math.cos(q[2]), math.sin(q[2]), L - CENTRE
    angle = SPEED * t
    px, py = R * math.cos(angle), R * math.sin(angle)
    fbx, fby, nbx, nby = contact(
        px - q[0] + CENTRE * c, py - q[1] + CENTRE * s, -SPEED * py - v[0] - CENTRE * s * v[2],
        SPEED * px - v[1] + CENTRE * c * v[2], CLEARANCE, RADIUS_BIG, STIFFNESS_BIG, SPEED, v[2])
    fsx, fsy, nsx, nsy = contact(
        q[3] - q[0] - rest * c, -q[1] - rest * s, v[3] - v[0] + rest * s * v[2],
        -v[1] - rest * c * v[2], CLEARANCE, RADIUS_SMALL, STIFFNESS_SMALL, 0.0, v[2])
    bx, by = px + RADIUS_BIG * nbx - q[0], py + RADIUS_BIG * nby - q[1]
    sx, sy = q[3] + RADIUS_SMALL * nsx - q[0], RADIUS_SMALL * nsy - q[1]
    gas = pressure(HEAD + R + L - q[3], angle % (2.0 * math.pi) >= math.pi) - BACK
    out[0] -= fbx + fsx
    out[1] -= fby + fsy
    out[2] -= bx * fby - by * fbx + sx * fsy - sy * fsx
    out[3] += fsx - gas * AREA


def acceleration(t, q, v):
    """The crosshead's."""
    out = np.zeros(4)
    forces(t, q, v, out)
    return out[3] / CROSSHEAD_MASS
