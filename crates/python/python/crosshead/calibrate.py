"""The model of a machine fitted to recordings of it."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterable
from typing import Any

from . import _crosshead
from .errors import InputError
from .folder import Folder, paths
from .kinds import AnyMachine, AnyPath, Json, Progress
from .machine import Machine
from .progress import shown
from .results import Results


@dataclasses.dataclass(frozen=True)
class Parameter:
    """A fitted value of the machine file; SI."""

    value: float
    low: float | None
    """Lower bound of the 95 % interval; none where the recordings do not determine the value, or the model is wrong."""
    high: float | None
    """Upper bound."""
    nominal: float
    """Value before the fit."""
    identifiable: bool
    """Whether the recordings determine it."""
    at_bound: bool
    """Whether it stands at the edge of its search range."""


def calibrate(
    bundle: AnyPath | Iterable[AnyPath],
    *,
    machine: AnyMachine | None = None,
    out: AnyPath | None = None,
    parameters: Iterable[str] | dict[str, tuple[str, str] | None] | None = None,
    relation: str | None = None,
    hold_out: list[str] | None = None,
    leave_out: Iterable[str] = (),
    optimiser: str | None = None,
    evaluations: int | None = None,
    seed: int | None = None,
    allow_outside: bool = False,
    overwrite: bool = False,
    progress: Progress = None,
) -> Calibration:
    """Fits the parameters of a machine to recordings of it.

    bundle: a folder with `recordings.yaml`, or several of one machine.
    machine: a `Machine` or the path of its file. By default the machine section of the bundle.
    out: folder to write into. By default a temporary one, which goes with the result. A folder that holds the same
        calibration is read and nothing is computed; an interrupted one continues.
    parameters: paths of the machine file to fit, or a dict of paths with their bounds,
        ``{"joints.big_end.contact.stiffness": ["1 GN/m^1.5", "100 GN/m^1.5"]}``. By default contact stiffness, damping
        and friction of each joint with clearance.
    relation: how contact parameters follow the clearance: `eq5`, `conformal`, `constant` or `fitted`.
    hold_out: runs that are predicted and not fitted to.
    leave_out: runs that are not used.
    optimiser: `default`, `cma_es`, `levenberg_marquardt` or `genetic`.
    evaluations: most evaluations of the model.
    seed: seed of the search.
    allow_outside: whether the bundle may name recordings outside of its folder.
    overwrite: whether a calibration in `out` is replaced.
    """
    fitted: Any = None if parameters is None else list(parameters)
    if isinstance(parameters, dict):
        fitted = {path: None if bounds is None else {"bounds": bounds} for path, bounds in parameters.items()}
    settings = settings_of(
        bundle=paths(bundle),
        parameters=fitted,
        relation=relation,
        hold_out=hold_out,
        leave_out=list(leave_out),
        optimiser=optimiser,
        evaluations=evaluations,
        seed=seed,
    )
    folder = Folder(out)
    own = None if machine is None else Machine.of(machine)._rust
    with shown(progress) as report:
        _crosshead.calibrate(settings, own, str(folder.path), allow_outside, overwrite, report)
    return Calibration(folder)


def settings_of(**settings: Any) -> str:
    """The keys of a calibration file that have a value, as JSON."""
    return json.dumps({key: value for key, value in settings.items() if value is not None})


class Calibration(Results):
    """A calibrated machine: what the fit found, and what stays unknown. `Calibration("calibrated")` opens a folder that
    `crosshead calibrate` has written."""

    FILE = "calibration.json"

    def __init__(self, folder: AnyPath | Folder) -> None:
        super().__init__(folder)
        if "parameters" not in self.results:
            raise InputError(f"{self.folder}: calibration.json: missing key `parameters`")

    @property
    def parameters(self) -> dict[str, Parameter]:
        """The fitted parameters by path; SI."""
        fields = [field.name for field in dataclasses.fields(Parameter)]
        found = self.results["parameters"].items()
        return {path: Parameter(**{field: one.get(field) for field in fields}) for path, one in found}

    @property
    def not_identifiable(self) -> list[str]:
        """Paths of the parameters that the recordings do not determine: they keep their nominal values."""
        return [path for path, one in self.parameters.items() if not one.identifiable]

    @property
    def noise(self) -> dict[str, Json]:
        """Noise and converter of each recorded channel, as the recordings show them: `rms` in the unit of the channel,
        `pink_share`, `bits`, `range`."""
        return self.results.get("noise", {})

    @property
    def fit(self) -> Json:
        """Misfits over the noise, before and after, of the fitted and of the held-out runs."""
        return self.results["fit"]

    @property
    def model_is_adequate(self) -> bool:
        """Whether the model explains the recordings to within 1.5 times their noise. If not, no interval is known."""
        return self.results["model_is_adequate"]

    def __repr__(self) -> str:
        misfit = self.fit.get("calibrated")
        text = f", misfit {misfit:.2f}" if misfit is not None else ""
        return f"<crosshead.Calibration: {len(self.parameters)} parameters{text}>"
