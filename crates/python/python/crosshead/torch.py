"""Recordings for PyTorch."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch

from .errors import InputError


class AngleWindows(torch.utils.data.Dataset):
    """Recordings of one length over the crank angle, with their labels."""

    def __init__(
        self,
        signals: list[np.ndarray],
        first: np.ndarray,
        y: np.ndarray,
        samples_per_revolution: int,
        revolutions: int | None,
        start: str,
        classes: Sequence[str] | None,
        seed: int,
    ) -> None:
        if start not in ("random", "top-dead-centre"):
            raise InputError(f"start: found {start!r}, expected random or top-dead-centre")
        shortest = min((signal.shape[1] for signal in signals), default=0) // samples_per_revolution
        revolutions = max(shortest - 1, 1) if revolutions is None else revolutions
        if not 1 <= revolutions <= shortest:
            raise InputError(f"revolutions: found {revolutions}, expected 1 to {shortest}")
        self.samples_per_revolution = samples_per_revolution
        self.revolutions = revolutions
        self.classes: list[str] | None = None
        """The classes in the order of their indices; none where labels are numbers."""
        if y.dtype.kind in "fi":
            self._y = torch.as_tensor(y, dtype=torch.float32)
        else:
            self.classes = [str(name) for name in (sorted(set(y)) if classes is None else classes)]
            index = {name: i for i, name in enumerate(self.classes)}
            unknown = sorted(set(y) - set(index))
            if unknown:
                raise InputError(f"classes: {unknown[0]!r} is not among {', '.join(self.classes)}")
            self._y = torch.as_tensor([index[name] for name in y])
        self._signals, self._first, self._start = signals, first, start
        self._random = np.random.default_rng(seed)

    def __len__(self) -> int:
        return len(self._signals)

    def __getitem__(self, index: int) -> tuple[torch.Tensor, torch.Tensor]:
        signal, length = self._signals[index], self.revolutions * self.samples_per_revolution
        spare = signal.shape[1] - length
        begin = (
            int(self._random.integers(spare + 1)) if self._start == "random" else self._top_dead_centre(index, spare)
        )
        # A piece of its own: what the dataset holds cannot be written to.
        return torch.tensor(signal[:, begin : begin + length]), self._y[index]

    def _top_dead_centre(self, index: int, spare: int) -> int:
        begin = -int(self._first[index]) % self.samples_per_revolution
        if begin > spare:
            raise InputError("revolutions: the recording is too short to begin at top dead centre")
        return begin
