"""One run of a machine."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _crosshead
from .kinds import AnyMachine, Json, Progress
from .machine import Machine
from .progress import shown


if TYPE_CHECKING:
    from matplotlib.figure import Figure


def simulate(
    machine: AnyMachine,
    *,
    revolutions: int = 20,
    transient: int = 10,
    sample_rate: str | float | None = None,
    tolerance: float = 1e-9,
    seed: int = 0,
    progress: Progress = None,
    **values: Any,
) -> Run:
    """Simulates one run of a machine and records its sensors.

    machine: a `Machine`, a path of its file, or a `Calibration`.
    revolutions: revolutions to record.
    transient: revolutions to leave out before.
    sample_rate: rate of the recording, ``"20 kHz"`` or a number in Hz. By default that of the machine file, or 10 kHz.
    tolerance: relative local error of the integration.
    seed: seed of the sensors' noise.
    values: other values of the machine file, by path: ``**{"joints.small_end.clearance": "0.2 mm"}``.
    """
    rate = f"{sample_rate} Hz" if isinstance(sample_rate, (int, float)) else sample_rate
    machine = Machine.of(machine)
    with shown(progress) as report:
        run = _crosshead.simulate(
            machine._rust, json.dumps(values), revolutions, transient, rate, tolerance, seed, report
        )
    return Run(run)


class Run:
    """What a run left behind."""

    def __init__(self, rust: _crosshead.Run) -> None:
        self._rust = rust

    @property
    def table(self) -> _crosshead.Table:
        """The recorded channels over time as an Arrow table: `t_s`, and each channel in float32."""
        return self._rust.table

    @property
    def channels(self) -> dict[str, np.ndarray]:
        """The recorded channels as NumPy arrays of float32, by name. They read the memory of the table."""
        table = self._rust.table
        return {name: table[name] for name in table.names if name != "t_s"}

    @property
    def t_s(self) -> np.ndarray:
        """Time of each sample since the first, s."""
        return self._rust.table["t_s"]

    @property
    def crank_angle_rad(self) -> np.ndarray:
        """True crank angle at each sample, from 0 to 2π, rad."""
        return self._rust.crank_angle_rad

    @property
    def motion(self) -> _crosshead.Table:
        """The motion itself, as no sensor sees it, as an Arrow table: position, velocity and acceleration of each crosshead
        pin, pressures, offsets and contact forces in each joint with clearance; SI."""
        return self._rust.motion

    @property
    def summary(self) -> Json:
        """Indicated power and mean pressure of each chamber, rod loads, overall vibration; SI."""
        return json.loads(self._rust._summary)

    @property
    def name(self) -> str:
        """Name of the machine."""
        return self._rust.name

    @property
    def speed_rpm(self) -> float:
        """Mean speed of the crank over the record, rpm."""
        return self._rust.speed_rpm

    @property
    def sample_rate_hz(self) -> float:
        """Samples per second, Hz."""
        return self._rust.sample_rate_hz

    @property
    def clearances_m(self) -> dict[str, float]:
        """Radial clearance of each joint that has one, m."""
        return dict(self._rust.clearances_m)

    @property
    def energy_residual(self) -> float | None:
        """Energy that the ledger of the run misses, as a share of the energy turned over."""
        return self._rust.energy_residual

    @property
    def warnings(self) -> list[str]:
        """What looks wrong: joints whose surfaces penetrate each other too deeply."""
        return self._rust.warnings

    def plot(self) -> Figure:
        """Draws the recorded channels over the crank angle, and the journal's orbit in each joint with clearance. Needs
        matplotlib; returns its figure."""
        from .plot import plot_run

        return plot_run(self)

    def __repr__(self) -> str:
        table = self._rust.table
        return f"<crosshead.Run: {self.name}, {self.speed_rpm:.4g} rpm, {len(table)} samples at {self.sample_rate_hz:g} Hz>"
