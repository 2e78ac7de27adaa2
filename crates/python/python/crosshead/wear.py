"""Which joints are worn, and how much."""

from __future__ import annotations

import os
from collections.abc import Iterable

from . import _crosshead
from .errors import InputError
from .kinds import AnyMachine, AnyPath, Json, Progress
from .machine import Machine
from .progress import shown
from .results import Results


def estimate_wear(
    bundle: AnyPath,
    *,
    machine: AnyMachine,
    out: AnyPath | None = None,
    worn_from: float = 1.5,
    leave_out: Iterable[str] = (),
    allow_outside: bool = False,
    overwrite: bool = False,
    progress: Progress = None,
) -> Wear:
    """Estimates the radial clearance of each joint from recordings of a machine in one state.

    bundle: a folder with `recordings.yaml`. Clearances that it states are not used.
    machine: the healthy machine: a `Machine`, the path of its file, or a `Calibration`.
    out: folder to write into. By default a temporary one.
    worn_from: a joint counts as worn from this many times its normal clearance.
    leave_out: runs that are not used.
    allow_outside: whether the bundle may name recordings outside of its folder.
    overwrite: whether an estimation in `out` is replaced. One of the same inputs that was stopped is continued otherwise.
    """
    if not 1 < worn_from < float("inf"):
        raise InputError(f"worn_from: found {worn_from}, expected a number above 1")
    folder = Wear.new_folder(out)
    with shown(progress) as report:
        _crosshead.estimate_wear(
            os.fspath(bundle),
            Machine.of(machine)._rust,
            str(folder.path),
            worn_from,
            list(leave_out),
            allow_outside,
            overwrite,
            report,
        )
    return Wear(folder)


class Wear(Results):
    """The estimated clearance of each joint. `Wear("wear")` opens a folder that `crosshead estimate-wear` has written."""

    FILE = "wear.json"

    @property
    def joints(self) -> dict[str, Json]:
        """The joints by path: dicts with `verdict`, `clearance_m`, `low_m`, `high_m`, `reason`."""
        return self.results["joints"]

    def __repr__(self) -> str:
        joints = ", ".join(f"{joint}: {one.get('verdict')}" for joint, one in self.joints.items())
        return f"<crosshead.Wear: {joints}>"
