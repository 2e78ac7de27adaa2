"""Features of recordings, measured or simulated."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any

import numpy as np

from . import _crosshead
from .dataset import Dataset, matrix
from .folder import paths
from .kinds import AnyPath, Progress
from .progress import shown


def features(
    recordings: AnyPath | Iterable[AnyPath],
    *,
    like: Dataset | AnyPath | None = None,
    columns: str | Iterable[str] = (),
    sample_rate: str | float | None = None,
    unit: str | None = None,
    speed: str | None = None,
    crank_angle: str | None = None,
    tacho: str | None = None,
    top_dead_centre: str | None = None,
    machine: AnyPath | None = None,
    window: str | None = None,
    chaos: bool = True,
    allow_outside: bool = False,
    progress: Progress = None,
) -> Features:
    """Computes the features of recordings, a row for each window.

    recordings: one path or several: CSV, WAV, MAT, HDF5, Parquet or MCAP files, bundles, datasets.
    like: a `Dataset` or its folder. The features are then those of the dataset, from windows of its length. Recordings of
        another rate, length or of other channels raise `InputError`.
    columns: columns to take. By default every column of numbers.
    sample_rate: ``"20 kHz"``, if the file does not say.
    unit: unit of the columns that have none, or what 1 in the file is.
    speed: speed of the crank, ``"500 rpm"``, if neither a crank angle nor the file has it.
    crank_angle: column of the crank angle.
    tacho: column of pulses, one per revolution.
    top_dead_centre: reading of the crank angle at top dead centre.
    machine: path of the machine file, for the indicated power.
    window: length of a window, ``"2 s"`` or ``"10 revolutions"``.
    chaos: whether the kind of motion is judged from the signals, which takes most of the time.
    allow_outside: whether a bundle may name recordings outside of its folder.
    """
    asked = {
        "columns": [columns] if isinstance(columns, str) else list(columns),
        "sample_rate": f"{sample_rate} Hz" if isinstance(sample_rate, (int, float)) else sample_rate,
        "unit": unit,
        "speed": speed,
        "crank_angle": crank_angle,
        "tacho": tacho,
        "top_dead_centre": top_dead_centre,
        "machine": None if machine is None else os.fspath(machine),
        "window": window,
        "chaos": chaos,
        "allow_outside": allow_outside,
    }
    dataset = like if like is None or isinstance(like, Dataset) else Dataset(like)
    folder = None if dataset is None else str(dataset.folder)
    with shown(progress) as report:
        table, recordings, warnings = _crosshead.features(paths(recordings), asked, folder, report)
    return Features(table, recordings, warnings, None if dataset is None else dataset.feature_names)


class Features:
    """Features of recordings. `X` is the matrix for a classifier, `table` the Arrow table."""

    def __init__(
        self, table: _crosshead.Table, recordings: list[str], warnings: list[str], names: list[str] | None = None
    ) -> None:
        self.table = table
        """The table, a row for each window: `file`, `window`, `start_s`, what the files say of them, the features."""
        self.groups = np.array(recordings)
        """The recording of each window, or its group where the recordings are a dataset."""
        self.warnings = warnings
        """What looks wrong with windows."""
        if names is None:
            roles = table.roles
            features = [name for name in table.names if roles.get(name) == "feature"]
            names = [name for name in features if table[name].dtype != object]
        self.names = names
        """Names of the features that are numbers: the columns of `X`."""

    @property
    def X(self) -> np.ndarray:
        """The features that are numbers, a row for each window, NaN where one is missing."""
        return matrix(self.table, self.names)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        if copy is False:
            raise ValueError("features stand in columns: a matrix of them is a copy")
        return np.asarray(self.X, dtype=dtype)

    def __len__(self) -> int:
        return len(self.table)

    def __repr__(self) -> str:
        return f"<crosshead.Features: {len(self)} windows, {len(self.names)} features>"
