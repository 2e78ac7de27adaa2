from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

__version__: str

_Progress = Callable[[str, int, int | None, str], object] | None

class Column:
    def __len__(self) -> int: ...
    @property
    def __array_interface__(self) -> dict[str, Any]: ...

class Table:
    """Columns of numbers, texts and recordings, with units, descriptions and roles.

    Every library that knows Arrow's PyCapsule interface reads it without a copy: `polars.DataFrame(table)`,
    `pyarrow.table(table)`, `pandas.DataFrame.from_arrow(table)`, `duckdb.sql("from table")`.
    """

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...
    @property
    def names(self) -> list[str]:
        """Names of the columns, in order."""
    @property
    def units(self) -> dict[str, str]:
        """Unit of each column that has one."""
    @property
    def descriptions(self) -> dict[str, str]:
        """What each column means."""
    @property
    def roles(self) -> dict[str, str]:
        """Role of each column that has one: `identifier`, `label`, `condition`, `unknown`, `feature` or `signal`."""
    def __len__(self) -> int: ...
    def __contains__(self, name: str) -> bool: ...
    def __getitem__(self, name: str) -> np.ndarray[Any, Any]:
        """A column as a NumPy array: numbers without gaps are not copied."""
    def filter(self, keep: Sequence[bool]) -> Table:
        """The rows for which `keep` is true."""
    def select(self, names: Sequence[str]) -> Table:
        """The table with these columns alone, in this order."""

class ParquetFiles:
    """Some columns of Parquet files, one after the other, decoded as they are asked for."""

    def __init__(
        self, paths: Sequence[str], columns: Sequence[str] | None = None, rows: tuple[int, int] | None = None
    ) -> None: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...
    def __iter__(self) -> Iterator[Table]: ...
    def read(self) -> Table:
        """All of it in memory."""

class TableIterator:
    def __iter__(self) -> TableIterator: ...
    def __next__(self) -> Table: ...

class Description:
    name: str
    manifest: str
    splits: list[str]
    sample_rate_hz: float
    samples_per_revolution: int | None
    revolutions_per_window: int
    channels: list[str]
    features: list[tuple[str, str, str | None, str | None, str]]
    signals: list[tuple[str, str, str | None, str | None, str]]

class Machine:
    def __init__(self, path: str) -> None: ...
    @staticmethod
    def from_yaml(text: str) -> Machine: ...
    @staticmethod
    def from_bundle(folder: str) -> Machine: ...
    name: str
    speed_rpm: float
    sample_rate_hz: float | None
    channels: list[str]
    def _with(self, values: str) -> Machine: ...
    def _get(self, path: str) -> str | None: ...
    def to_yaml(self) -> str: ...
    def save(self, path: str) -> None: ...

class Run:
    table: Table
    motion: Table
    crank_angle_rad: np.ndarray[Any, np.dtype[np.float64]]
    name: str
    speed_rpm: float
    sample_rate_hz: float
    energy_residual: float | None
    seconds: float
    throws: list[str]
    clearances_m: list[tuple[str, float]]
    warnings: list[str]
    _summary: str

def simulate(
    machine: Machine,
    values: str,
    revolutions: int,
    transient: int,
    sample_rate: str | None,
    tolerance: float,
    seed: int,
    progress: _Progress,
) -> Run: ...
def generate(
    sweep: str,
    machine: Machine | None,
    calibration: str | None,
    uncertainty: str,
    undetermined: str,
    channels: Sequence[str] | None,
    out: str,
    existing: str,
    threads: int | None,
    progress: _Progress,
) -> tuple[str, list[str]]: ...

class SignalBatches:
    name: str
    cases: int
    mistakes: list[str]
    done: int
    failed: list[tuple[str, str]]
    warnings: list[tuple[str, str]]
    columns: Table
    def next(self) -> Table | None: ...
    def close(self) -> None: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...

def signal_batches(
    sweep: str,
    machine: Machine | None,
    calibration: str | None,
    uncertainty: str,
    undetermined: str,
    channels: Sequence[str] | None,
    threads: int | None,
) -> SignalBatches: ...
def calibrate(
    calibration: str, machine: Machine | None, out: str, allow_outside: bool, overwrite: bool, progress: _Progress
) -> None: ...
def explain_gap(calibration: str, out: str, allow_outside: bool, progress: _Progress) -> None: ...
def estimate_wear(
    bundle: str,
    machine: Machine,
    out: str,
    worn_from: float,
    leave_out: Sequence[str],
    allow_outside: bool,
    overwrite: bool,
    progress: _Progress,
) -> None: ...
def features(
    paths: Sequence[str], asked: dict[str, Any], like: str | None, progress: _Progress
) -> tuple[Table, list[str], list[str]]: ...
def domain_gap(
    names: list[str],
    simulated: tuple[list[list[float]], list[str]],
    measured: tuple[list[list[float]], list[str]],
    folds: int,
    seed: int,
) -> tuple[float, list[float], list[tuple[str, float, float, float | None, float | None]]]: ...
def open_dataset(folder: str) -> Description: ...
def over_crank_angle(
    table: Table, channels: Sequence[str], points: int
) -> list[tuple[np.ndarray[Any, np.dtype[np.float32]], int]]: ...
def page(folder: str, out: str) -> None: ...
def program(name: str, arguments: Sequence[str]) -> int: ...
def set_program(path: str) -> None: ...
