"""Progress on standard error, by tqdm where it is installed."""

from __future__ import annotations

import contextlib
import warnings
from collections.abc import Iterator
from typing import Any

from .kinds import Progress


@contextlib.contextmanager
def shown(progress: Progress) -> Iterator[Any]:
    """A function ``(what, done, total, message)`` that draws the progress; none where it is not wanted.

    ``progress=True`` and ``None`` draw with tqdm, if it is installed. ``False`` draws nothing. Any other value is called
    itself, twenty times a second.
    """
    if callable(progress):
        yield progress
        return
    bars = _Bars.new() if progress is not False else None
    try:
        yield bars
    finally:
        if bars is not None:
            bars.close()


class _Bars:
    """A bar for each stage, one after the other."""

    def __init__(self, tqdm: Any) -> None:
        self._tqdm = tqdm
        self._bar: Any = None
        self._what: str | None = None

    @classmethod
    def new(cls) -> _Bars | None:
        try:
            with warnings.catch_warnings():
                # In a notebook without widgets tqdm draws text, and says so.
                warnings.simplefilter("ignore")
                from tqdm.auto import tqdm
        except ImportError:
            return None
        return cls(tqdm)

    def __call__(self, what: str, done: int, total: int | None, message: str) -> None:
        if not what:
            return
        if what != self._what:
            self.close()
            # Work that is short draws nothing.
            self._bar = self._tqdm(total=total, desc=what, initial=done, delay=1.0, leave=False)
            self._what = what
        if message:
            self._bar.set_postfix_str(message, refresh=False)
        if done != self._bar.n:
            self._bar.update(done - self._bar.n)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None
