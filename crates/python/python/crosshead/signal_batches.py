"""Recordings of a sweep as they are simulated, nothing on disk."""

from __future__ import annotations

import contextlib
import warnings
from collections.abc import Iterator
from typing import Any

from . import _crosshead
from .kinds import Progress
from .progress import shown


class SignalBatches(Iterator[_crosshead.Table]):
    """The recordings of a sweep with their labels: an iterator of Arrow tables in the order of cases, as `Dataset.signals` has
    them, simulated as they are asked for. Some cases are simulated ahead, so that memory is bounded and no core rests.

    The simulation ends with the last batch, with `close()`, at the end of a ``with`` block, and when nobody holds the
    iterator any more. pyarrow, polars and duckdb read it as a stream: ``pyarrow.RecordBatchReader.from_stream(batches)``.
    """

    def __init__(self, rust: _crosshead.SignalBatches, progress: Progress = False) -> None:
        self._rust = rust
        self._open = contextlib.ExitStack()
        self._report = self._open.enter_context(shown(progress))
        for mistake in rust.mistakes:
            warnings.warn(mistake, stacklevel=3)

    @property
    def name(self) -> str:
        """Name of the sweep."""
        return self._rust.name

    @property
    def cases(self) -> int:
        """Cases of the sweep."""
        return self._rust.cases

    @property
    def done(self) -> int:
        """Cases whose rows were handed out, failed ones included."""
        return self._rust.done

    @property
    def names(self) -> list[str]:
        """Names of the columns."""
        return self._rust.columns.names

    @property
    def roles(self) -> dict[str, str]:
        """Role of each column that has one: `label`, `condition`, `unknown` or `signal`."""
        return self._rust.columns.roles

    @property
    def failed(self) -> list[dict[str, str]]:
        """The cases so far that could not be simulated: dicts with `case_id` and `reason`. They have no rows."""
        return [{"case_id": case, "reason": reason} for case, reason in self._rust.failed]

    @property
    def warnings(self) -> list[dict[str, str]]:
        """What is doubtful about cases so far: dicts with `case_id` and `warning`."""
        return [{"case_id": case, "warning": warning} for case, warning in self._rust.warnings]

    def __iter__(self) -> SignalBatches:
        return self

    def __next__(self) -> _crosshead.Table:
        try:
            table = self._rust.next()
            if table is not None and self._report is not None:
                self._report("cases", self.done, self.cases, "")
        except BaseException:
            self.close()
            raise
        if table is None:
            self.close()
            raise StopIteration
        return table

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> Any:
        return self._rust.__arrow_c_stream__(requested_schema)

    def close(self) -> None:
        """Ends the simulation, after the cases under way. There are no more batches."""
        self._rust.close()
        self._open.close()

    def __enter__(self) -> SignalBatches:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<crosshead.SignalBatches: {self.name}, {self.done} of {self.cases} cases>"
