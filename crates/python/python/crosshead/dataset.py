"""Datasets that `generate` or the program `gen-dataset` has written."""

from __future__ import annotations

import functools
import json
import os
import pathlib
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from . import _crosshead
from .errors import InputError
from .kinds import AnyPath, Json
from .page import Page, page

if TYPE_CHECKING:
    from .torch import AngleWindows


class Dataset:
    """A finished dataset. Its files are compared with their checksums as they are opened."""

    def __init__(self, folder: AnyPath) -> None:
        self.folder = pathlib.Path(folder)
        """Its folder."""
        said = _crosshead.open_dataset(os.fspath(folder))
        self.name = said.name
        """Its name."""
        self.manifest: Json = json.loads(said.manifest)
        """The content of `manifest.json`."""
        self.splits = said.splits
        """The splits that have rows: `train`, `validation`, `test`."""
        self.sample_rate_hz = said.sample_rate_hz
        """Samples per second of its recordings, Hz."""
        self.samples_per_revolution = said.samples_per_revolution
        """Samples per revolution of its signals, where they are over the crank angle; `sample_rate_hz` is then that of the
        recordings before, of which the features are."""
        self.revolutions_per_window = said.revolutions_per_window
        """Revolutions of the crank in a window."""
        self.channels = said.channels
        """Names of the recorded channels, each ending in its unit."""
        self._columns = said.features

    def _named(self, role: str, numbers: bool = False) -> list[str]:
        kinds = ("a real number", "a whole number")
        return [name for name, kind, of, *_ in self._columns if of == role and (not numbers or kind in kinds)]

    @property
    def feature_names(self) -> list[str]:
        """Names of the features that are numbers, in the order of the columns of `xy`."""
        return self._named("feature", numbers=True)

    @property
    def roles(self) -> dict[str, str]:
        """Role of each column of the table of features: `identifier`, `label`, `condition`, `unknown` or `feature`."""
        return {name: role for name, _, role, *_ in self._columns if role}

    @property
    def failed(self) -> list[Json]:
        """The cases that could not be simulated: dicts with `case_id`, `reason`, `command`."""
        return self.manifest["failed"]

    def _files(self, subset: str, split: str | None = None) -> list[str]:
        """Paths of the tables of a subset, of one split or of all."""
        if split is not None and split not in self.splits:
            raise InputError(f"split: found {split!r}, expected one of {', '.join(self.splits)}")
        prefix = f"{subset}/{split}-" if split else f"{subset}/"
        listed = (file["path"] for file in self.manifest["files"])
        found = [str(self.folder / path) for path in listed if path.startswith(prefix) and path.endswith(".parquet")]
        if not found:
            raise InputError(f"{self.folder}: no table of {subset}: its recordings are in another format")
        return found

    def table(self, split: str | None = None, columns: Sequence[str] | None = None) -> _crosshead.Table:
        """The table of features, a row for each window, as an Arrow table: of one split or of all, some columns or all."""
        return _crosshead.ParquetFiles(self._files("features", split), columns).read()

    @functools.cached_property
    def features(self) -> _crosshead.Table:
        """The table of features of all splits as an Arrow table, a row for each window."""
        return self.table()

    @functools.cached_property
    def cases(self) -> _crosshead.Table:
        """The cases as an Arrow table, a row for each: `case_id`, `group`, `split`, labels, conditions and unknowns."""
        described = [name for name, _, role, *_ in self._columns if role in ("label", "condition", "unknown")]
        table = self.table(columns=["case_id", "group", "split", *described])
        _, first = np.unique(table["case_id"].astype(str), return_index=True)
        keep = np.zeros(len(table), dtype=bool)
        keep[first] = True
        return table.filter(keep.tolist())

    def labels(self, split: str | None = None) -> _crosshead.Table:
        """What is to be found out, as an Arrow table, a row for each window."""
        return self.table(split, self._named("label"))

    def conditions(self, split: str | None = None) -> _crosshead.Table:
        """At what the machine ran, as an Arrow table, a row for each window."""
        return self.table(split, self._named("condition"))

    def unknowns(self, split: str | None = None) -> _crosshead.Table | None:
        """What varied without being known, as an Arrow table, a row for each window; none where nothing did."""
        names = self._named("unknown")
        return self.table(split, names) if names else None

    def xy(self, split: str = "train", target: str = "fault") -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Features, labels and groups of a split for a classifier or a regression: `X, y, groups`.

        X: features that are numbers alone, a row for each window, NaN where one is missing; `feature_names` names the columns.
        y: the label `target`: `fault`, or a clearance for a regression.
        groups: windows of one group differ in noise and sensors alone, so that no cross-validation may split them.
        """
        names = self._named("label")
        if target not in names:
            raise InputError(f"target: found {target!r}, expected a label: {', '.join(names)}")
        table = self.table(split)
        return matrix(table, self.feature_names), table[target], table["group"]

    @overload
    def signals(
        self, split: str | None = None, *, case: None = None, columns: Sequence[str] | None = None
    ) -> _crosshead.ParquetFiles: ...
    @overload
    def signals(
        self, split: str | None = None, *, case: str, columns: Sequence[str] | None = None
    ) -> _crosshead.Table: ...
    def signals(
        self, split: str | None = None, *, case: str | None = None, columns: Sequence[str] | None = None
    ) -> _crosshead.ParquetFiles | _crosshead.Table:
        """The recordings, a row for each window, with labels and conditions: as a stream of Arrow record batches, decoded as
        they are asked for. polars, pyarrow and duckdb read it as a table; a loop over it gives one table after the other.

        split: one split, or all.
        case: one case alone, in memory.
        columns: some columns, or all.
        """
        if case is None:
            return _crosshead.ParquetFiles(self._files("signals", split), columns)
        for path in self._files("signals", split):
            cases = _crosshead.ParquetFiles([path], ["case_id"]).read()["case_id"]
            (rows,) = np.nonzero(cases == case)
            if len(rows):
                span = (int(rows[0]), int(rows[-1]) + 1)
                return _crosshead.ParquetFiles([path], columns, span).read()
        raise InputError(f"case: found {case!r}, which is not in {self.folder}")

    def over_crank_angle(
        self,
        split: str = "train",
        samples_per_revolution: int = 512,
        channels: Iterable[str] | None = None,
        target: str = "fault",
    ) -> tuple[list[np.ndarray], np.ndarray, np.ndarray]:
        """The recordings of a split over the crank angle: `signals, first, y`.

        signals: an array of float32 for each window, channels by points; `samples_per_revolution` points in each revolution,
            resampled without aliasing. Whole revolutions.
        first: the point, counted from top dead centre, at which each of them begins.
        y: the label `target` of each.
        channels: which, by default all but the crank angle.
        """
        chosen = list(channels) if channels is not None else [c for c in self.channels if c != "crank_angle_rad"]
        for name in chosen:
            if name not in self.channels:
                raise InputError(f"channels: found {name!r}, expected some of {', '.join(self.channels)}")
        angle = [name for name in self.channels if name == "crank_angle_rad"]
        sampling = ["samples_per_revolution", "start_angle_rad"] if self.samples_per_revolution else ["sample_rate_hz"]
        columns = [target, "speed_rpm", *sampling, *angle, *(c for c in chosen if c not in angle)]
        signals: list[np.ndarray] = []
        first: list[int] = []
        y: list[Any] = []
        for table in self.signals(split, columns=columns):
            for samples, begins in _crosshead.over_crank_angle(table, chosen, samples_per_revolution):
                signals.append(samples)
                first.append(begins)
            y.extend(table[target])
        return signals, np.array(first), np.array(y)

    def torch(
        self,
        split: str = "train",
        samples_per_revolution: int = 512,
        *,
        revolutions: int | None = None,
        channels: Iterable[str] | None = None,
        target: str = "fault",
        start: str = "random",
        classes: Sequence[str] | None = None,
        seed: int = 0,
    ) -> AngleWindows:
        """A `torch.utils.data.Dataset` of recordings of one length over the crank angle: `(signal, label)`.

        signal: float32, channels by points. label: index of the class in `classes`, or the number where it is one.
        revolutions: length of each. By default one less than a window has, so that it can begin anywhere.
        start: `random` begins anywhere, another place at every access; `top-dead-centre` always there.
        classes: the classes in their order, of another split for example. By default those that are there, sorted.
        """
        from .torch import AngleWindows

        signals, first, y = self.over_crank_angle(split, samples_per_revolution, channels, target)
        return AngleWindows(signals, first, y, samples_per_revolution, revolutions, start, classes, seed)

    def page(self, out: AnyPath | None = None) -> Page:
        """Writes its page, and returns it."""
        return page(os.fspath(self.folder), out)

    def __repr__(self) -> str:
        counts = self.manifest["counts"]
        return f"<crosshead.Dataset: {self.name}, {counts['cases']} cases, splits {', '.join(self.splits)}>"


def matrix(table: _crosshead.Table, names: Sequence[str]) -> np.ndarray:
    """Columns of numbers side by side, NaN where one is missing."""
    if not names:
        return np.empty((len(table), 0))
    return np.column_stack([table[name] for name in names])
