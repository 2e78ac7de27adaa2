"""Pictures of runs, by matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ._crosshead import Table
    from .simulate import Run


def plot_run(run: Run) -> Figure:
    """The recorded channels over the crank angle, and the orbit in each joint with clearance."""
    import matplotlib.pyplot as plt

    angle = np.degrees(run.crank_angle_rad)
    units = run.table.units
    channels = {name: samples for name, samples in run.channels.items() if units.get(name) != "rad"}
    joints = run.clearances_m
    figure = plt.figure(figsize=(10, 2.2 * max(len(channels), 1) + (3.2 if joints else 0)), layout="constrained")
    rows = figure.add_gridspec(
        len(channels) + bool(joints), 1, height_ratios=[1] * len(channels) + [1.5] * bool(joints)
    )
    first = None
    for row, (name, samples) in enumerate(channels.items()):
        axes = first = figure.add_subplot(rows[row], sharex=first)
        axes.plot(*_revolutions(angle, samples), linewidth=0.7)
        axes.set_ylabel(f"{_words(name, units.get(name))}\n{units.get(name, '')}")
        axes.grid(alpha=0.3)
    if first is not None:
        first.set_xlabel("crank angle, degrees")
        first.set_xlim(0, 360)
        first.set_xticks(range(0, 361, 45))
    if joints:
        _plot_orbits(figure.add_subfigure(rows[-1]), run.motion, joints)
    figure.suptitle(f"{run.name}, {run.speed_rpm:.4g} rpm")
    return figure


def _plot_orbits(figure: Any, motion: Table, joints: dict[str, float]) -> None:
    """The journal's centre from the bearing's, and the circle of the clearance."""
    for axes, (joint, clearance) in zip(np.atleast_1d(figure.subplots(1, len(joints))), joints.items()):
        throw, _, name = joint.rpartition(".")
        column = f"{throw}.true_{name}" if throw else f"true_{name}"
        if f"{column}_offset_x_m" not in motion:
            axes.set_visible(False)
            continue
        x, y = (1e6 * motion[f"{column}_offset_{axis}_m"] for axis in "xy")
        around = np.linspace(0, 2 * np.pi, 200)
        axes.plot(1e6 * clearance * np.cos(around), 1e6 * clearance * np.sin(around), "k--", linewidth=0.8)
        axes.plot(x, y, linewidth=0.4)
        axes.set_aspect("equal")
        axes.set_title(f"{joint.replace('_', ' ')}, journal, µm", fontsize=9)


def _revolutions(angle: np.ndarray, samples: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angle and samples with a gap where a revolution ends, so that no line goes back."""
    ends = np.flatnonzero(np.abs(np.diff(angle)) > 180) + 1
    return np.insert(angle, ends, np.nan), np.insert(samples.astype(float), ends, np.nan)


def _words(name: str, unit: str | None) -> str:
    """The name of a channel without its unit."""
    suffix = {"m/s^2": "_m_s2", "m/s": "_m_s", "Pa": "_pa", "N": "_n", "rad": "_rad", "rad/s": "_rad_s", "m": "_m"}
    return name.removesuffix(suffix.get(unit or "", "")).replace("_", " ")
