"""Labelled datasets and streams of recordings from sweeps."""

from __future__ import annotations

import os
import pathlib
import warnings
from collections.abc import Iterable
from typing import overload

from . import _crosshead
from .calibrate import Calibration
from .dataset import Dataset
from .errors import InputError
from .kinds import AnyMachine, AnyPath, Progress
from .machine import Machine
from .progress import shown
from .signal_batches import SignalBatches

_EXISTING = ("refuse", "resume", "overwrite")


@overload
def generate(
    sweep: AnyPath,
    *,
    machine: AnyMachine | None = None,
    out: AnyPath,
    existing: str = "refuse",
    uncertainty: str | None = None,
    undetermined: str = "nominal",
    channels: Iterable[str] | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Dataset: ...
@overload
def generate(
    sweep: AnyPath,
    *,
    machine: AnyMachine | None = None,
    out: None = None,
    uncertainty: str | None = None,
    undetermined: str = "nominal",
    channels: Iterable[str] | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> SignalBatches: ...
def generate(
    sweep: AnyPath,
    *,
    machine: AnyMachine | None = None,
    out: AnyPath | None = None,
    existing: str = "refuse",
    uncertainty: str | None = None,
    undetermined: str = "nominal",
    channels: Iterable[str] | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Dataset | SignalBatches:
    """Simulates the cases of a sweep file: writes a labelled dataset, or hands out its recordings batch by batch.

    sweep: path of the sweep file.
    machine: takes the place of the sweep's own: a `Machine`, the path of its file, or a `Calibration`. The cases then
        draw from the uncertainty that the calibration leaves.
    out: folder of the dataset. Without one nothing is written, and the result is an iterator of Arrow tables.
    existing: what happens to a dataset that is there: `refuse`, `resume` or `overwrite`.
    uncertainty: of a calibration: `sampled` draws each case from the joint distribution of what was found, `ignored`
        takes the best values. By default `sampled` where the model is adequate.
    undetermined: of a calibration: parameters that are not identifiable are drawn from their search range (`prior`) or
        keep their nominal values (`nominal`).
    channels: the channels to record, ``["crosshead_acceleration_m_s2", "crank_angle_rad"]``. By default those of the
        calibration's recordings, so that the dataset has no channel that they lack; else all of the machine.
    threads: threads that simulate. By default one per core.
    """
    if existing not in _EXISTING:
        raise InputError(f"existing: found {existing!r}, expected one of {', '.join(_EXISTING)}")
    calibration = machine if isinstance(machine, Calibration) else None
    own = None if machine is None or calibration is not None else Machine.of(machine)._rust
    if uncertainty is None:
        uncertainty = "sampled" if calibration is not None and calibration.model_is_adequate else "ignored"
    if channels is None and calibration is not None:
        channels = list(calibration.noise)
    asked = (
        os.fspath(sweep),
        own,
        None if calibration is None else str(calibration.folder.absolute()),
        uncertainty,
        undetermined,
        None if channels is None else list(channels),
    )
    if out is None:
        if existing != "refuse":
            raise InputError(f"existing: found {existing!r} without a folder, expected out, the folder of the dataset")
        return SignalBatches(_crosshead.signal_batches(*asked, threads), progress)
    with shown(progress) as report:
        folder, doubts = _crosshead.generate(*asked, os.fspath(out), existing, threads, report)
    dataset = Dataset(pathlib.Path(folder))
    failed = dataset.failed
    if failed:
        doubts.append(f"{len(failed)} of {dataset.manifest['counts']['cases']} cases failed; `dataset.failed` says why")
    for doubt in doubts:
        warnings.warn(doubt, stacklevel=2)
    return dataset
