"""Recordings over the crank angle."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from . import _crosshead
from .errors import InputError
from .folder import paths
from .kinds import AnyPath

# What says at which angle each sample was taken, as far as it is there.
ABOUT = ["crank_angle_rad", "speed_rpm", "sample_rate_hz", "samples_per_revolution", "start_angle_rad"]


def over_crank_angle(
    recordings: AnyPath | Iterable[AnyPath], channels: Iterable[str], samples_per_revolution: int = 512
) -> tuple[list[np.ndarray], np.ndarray]:
    """Recordings resampled over the crank angle, without aliasing: `signals, first`.

    recordings: Parquet files with a row for each recording and columns `speed_rpm` and `sample_rate_hz`. Without a column
        `crank_angle_rad` these give the angle, which then begins at 0.
    channels: names of the columns with the samples.
    signals: an array of float32 for each recording, channels by points; whole revolutions.
    first: the point, counted from top dead centre, at which each of them begins.
    """
    files = paths(recordings)
    chosen = list(channels)
    there = next(iter(_crosshead.ParquetFiles(files)), None)
    names = [] if there is None else there.names
    for name in chosen:
        if name not in names:
            raise InputError(f"channels: found {name!r}, expected some of {', '.join(names)}")
    about = [name for name in ABOUT if name in names]
    columns = [*about, *(name for name in chosen if name not in about)]
    signals: list[np.ndarray] = []
    first: list[int] = []
    for table in _crosshead.ParquetFiles(files, columns):
        for samples, begins in _crosshead.over_crank_angle(table, chosen, samples_per_revolution):
            signals.append(samples)
            first.append(begins)
    return signals, np.array(first)
