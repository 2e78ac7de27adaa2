"""Which joints are worn, and how much."""

from __future__ import annotations

import os
import pathlib
from collections.abc import Iterable

from . import _crosshead
from .errors import InputError
from .folder import Folder
from .kinds import AnyMachine, AnyPath, Json, Progress
from .machine import Machine
from .page import Page, page
from .progress import shown


def estimate_wear(
    bundle: AnyPath,
    *,
    machine: AnyMachine,
    out: AnyPath | None = None,
    worn_from: float = 1.5,
    leave_out: Iterable[str] = (),
    allow_outside: bool = False,
    progress: Progress = None,
) -> Wear:
    """Estimates the radial clearance of each joint from recordings of a machine in one state.

    bundle: a folder with `recordings.yaml`. Clearances that it states are not used.
    machine: the healthy machine: a `Machine`, the path of its file, or a `Calibration`.
    out: folder to write into. By default a temporary one.
    worn_from: a joint counts as worn from this many times its normal clearance.
    leave_out: runs that are not used.
    allow_outside: whether the bundle may name recordings outside of its folder.
    """
    if not 1 < worn_from < float("inf"):
        raise InputError(f"worn_from: found {worn_from}, expected a number above 1")
    folder = Folder(out)
    if (folder.path / "wear.json").exists():
        raise InputError(f"{folder.path / 'wear.json'} is already there; `Wear(folder)` opens it")
    with shown(progress) as report:
        _crosshead.estimate_wear(
            os.fspath(bundle),
            Machine.of(machine)._rust,
            str(folder.path),
            worn_from,
            list(leave_out),
            allow_outside,
            report,
        )
    return Wear(folder)


class Wear:
    """The estimated clearance of each joint. `Wear("wear")` opens a folder that `crosshead estimate-wear` has written."""

    def __init__(self, folder: AnyPath | Folder) -> None:
        self._folder = folder if isinstance(folder, Folder) else Folder(folder)
        self.results: Json = self._folder.read("wear.json")
        """The content of `wear.json`."""

    @property
    def folder(self) -> pathlib.Path:
        """The folder of its files."""
        return self._folder.path

    @property
    def joints(self) -> dict[str, Json]:
        """The joints by path: dicts with `verdict`, `clearance_m`, `low_m`, `high_m`, `reason`."""
        return self.results["joints"]

    @property
    def machine(self) -> Machine:
        """The machine with the estimated clearances."""
        return Machine(self.folder / "machine.yaml")

    def page(self, out: AnyPath | None = None) -> Page:
        """Writes its page, and returns it."""
        return page(os.fspath(self.folder), out)

    def __repr__(self) -> str:
        joints = ", ".join(f"{joint}: {one.get('verdict')}" for joint, one in self.joints.items())
        return f"<crosshead.Wear: {joints}>"
