"""The effect that a model lacks and recordings show."""

from __future__ import annotations

from collections.abc import Iterable

from . import _crosshead
from .calibrate import settings_of
from .folder import paths
from .kinds import AnyMachine, AnyPath, Json, Progress
from .machine import Machine
from .progress import shown
from .results import Results


def explain_gap(
    bundle: AnyPath,
    *,
    machine: AnyMachine | None = None,
    out: AnyPath | None = None,
    hold_out: list[str] | None = None,
    leave_out: Iterable[str] = (),
    allow_outside: bool = False,
    progress: Progress = None,
) -> Explanation:
    """Finds which effects of the catalogue a calibrated model lacks.

    bundle: a folder with `recordings.yaml`.
    machine: a `Machine` or the path of its file. By default the machine section of the bundle.
    out: folder to write into. By default a temporary one. An interrupted explanation continues in its folder.
    hold_out: runs that are predicted and not fitted to.
    leave_out: runs that are not used.
    allow_outside: whether the bundle may name recordings outside of its folder.
    """
    folder = Explanation.new_folder(out)
    own = None
    if machine is not None:
        folder.path.mkdir(parents=True, exist_ok=True)
        own = str((folder.path / "nominal-machine.yaml").absolute())
        Machine.of(machine).save(own)
    settings = settings_of(bundle=paths(bundle), machine=own, hold_out=hold_out, leave_out=list(leave_out))
    with shown(progress) as report:
        _crosshead.explain_gap(settings, str(folder.path), allow_outside, report)
    return Explanation(folder)


class Explanation(Results):
    """Which effects a model lacks. `Explanation("explained")` opens a folder that `crosshead explain-gap` has written."""

    FILE = "gap.json"

    @property
    def verdict(self) -> str:
        """`no-gap`, `explained`, `partly-explained` or `unexplained`."""
        return self.results["verdict"]

    @property
    def effects(self) -> list[Json]:
        """The effects that were added, in order: dicts with `effect`, `places`, `probability`, `parameters`, `rivals`."""
        return self.results["effects"]

    @property
    def gap(self) -> Json:
        """Misfits over the noise, before and after, of the fitted and of the held-out runs."""
        return self.results["gap"]

    def __repr__(self) -> str:
        effects = ", ".join(effect["effect"] for effect in self.effects) or "no effect"
        return f"<crosshead.Explanation: {self.verdict}, {effects}>"
