"""Machine files."""

from __future__ import annotations

import json
import os
from typing import Any

from . import _crosshead
from .errors import InputError
from .kinds import AnyMachine, AnyPath


class Machine:
    """A machine file: a compressor with its sensors, every value with its unit.

    ``Machine("machine.yaml")`` reads one. ``machine.replace(**{"joints.big_end.clearance": "0.2 mm"})`` gives the same
    machine with other values; a value is a text with its unit, a number where the key has none, or what YAML would have
    there.
    """

    def __init__(self, path: AnyPath | _crosshead.Machine) -> None:
        self._rust = path if isinstance(path, _crosshead.Machine) else _crosshead.Machine(os.fspath(path))

    @classmethod
    def from_yaml(cls, text: str) -> Machine:
        """The machine file with the content `text`."""
        return cls(_crosshead.Machine.from_yaml(text))

    @classmethod
    def from_bundle(cls, folder: AnyPath) -> Machine:
        """The machine that a bundle of recordings states, as nobody has calibrated it, at the conditions of its first run."""
        return cls(_crosshead.Machine.from_bundle(os.fspath(folder)))

    @classmethod
    def of(cls, machine: AnyMachine) -> Machine:
        """`machine` itself, the machine of a calibration or an explanation, or the file at this path."""
        if isinstance(machine, Machine):
            return machine
        if isinstance(machine, (str, os.PathLike)):
            return cls(machine)
        if hasattr(machine, "machine"):
            return machine.machine
        raise InputError(
            f"machine: found {type(machine).__name__}, expected a Machine, a path, or something with a machine"
        )

    @property
    def name(self) -> str:
        """Its name."""
        return self._rust.name

    @property
    def speed_rpm(self) -> float:
        """Speed of the crank, or reference speed of a free one, rpm."""
        return self._rust.speed_rpm

    @property
    def sample_rate_hz(self) -> float | None:
        """Sample rate of its recorder, Hz; none where the file states none."""
        return self._rust.sample_rate_hz

    @property
    def channels(self) -> list[str]:
        """Names of the recorded channels, each ending in its unit."""
        return self._rust.channels

    def __getitem__(self, path: str) -> Any:
        """The value at a path of the file, as it is written: ``machine["joints.big_end.clearance"]``."""
        value = self._rust._get(path)
        if value is None:
            raise KeyError(path)
        return json.loads(value)

    def replace(self, **values: Any) -> Machine:
        """The same machine with other values, each at its path."""
        return Machine(self._rust._with(json.dumps(values)))

    def to_yaml(self) -> str:
        """The content of its file."""
        return self._rust.to_yaml()

    def save(self, path: AnyPath) -> None:
        """Writes its file."""
        self._rust.save(os.fspath(path))

    def __repr__(self) -> str:
        return f"<crosshead.Machine: {self.name}, {self.speed_rpm:.4g} rpm>"
