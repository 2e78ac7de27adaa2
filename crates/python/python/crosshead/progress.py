"""Progress on standard error, by tqdm where it is installed."""

import contextlib
import warnings


@contextlib.contextmanager
def shown(progress):
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

    def __init__(self, tqdm):
        self._tqdm, self._bar, self._what = tqdm, None, None

    @classmethod
    def new(cls):
        try:
            with warnings.catch_warnings():
                # In a notebook without widgets tqdm draws text, and says so.
                warnings.simplefilter("ignore")
                from tqdm.auto import tqdm
        except ImportError:
            return None
        return cls(tqdm)

    def __call__(self, what, done, total, message):
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

    def close(self):
        if self._bar is not None:
            self._bar.close()
            self._bar = None
