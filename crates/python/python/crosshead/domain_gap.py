"""How far simulated recordings differ from measured ones, as a classifier sees it."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

from . import _crosshead
from .dataset import Dataset, matrix
from .errors import InputError
from .features import Features


@dataclasses.dataclass(frozen=True)
class TellingFeature:
    """A feature that tells simulated windows from measured ones."""

    feature: str
    auc: float
    """Area under the curve of this feature alone: 0.5 tells nothing, 1 everything."""
    loss: float
    """What the classifier's area loses when this feature is shuffled."""
    simulated: float | None
    """Median of the simulated windows; none where no window has a value."""
    measured: float | None
    """Median of the measured windows."""


@dataclasses.dataclass(frozen=True)
class DomainGap:
    """How well a classifier tells simulated windows from measured ones."""

    auc: float
    """Area under the curve on held-out windows: 0.5 where nothing tells them apart, 1 where everything does."""
    folds: list[float]
    """The same of each fold."""
    features: list[TellingFeature]
    """The features that give it away, the most telling first."""

    def __str__(self) -> str:
        lines = [f"AUC {self.auc:.3f} (folds {', '.join(f'{auc:.3f}' for auc in self.folds)})"]
        for telling in self.features[:10]:
            simulated, measured = (
                "none" if median is None else f"{median:.4g}" for median in (telling.simulated, telling.measured)
            )
            lines.append(
                f"  {telling.feature}: alone {telling.auc:.3f}, loss {telling.loss:.3f}, "
                f"simulated {simulated}, measured {measured}"
            )
        return "\n".join(lines)


def domain_gap(dataset: Dataset | Features, measured: Features, *, folds: int = 5, seed: int = 0) -> DomainGap:
    """Trains a classifier to tell the windows of a dataset from measured ones, and tests it on windows that it has not seen.

    The classifier is gradient boosting of trees, as the command ``crosshead domain-gap`` has it.

    dataset: a `Dataset`, all splits; or `Features` of simulated recordings.
    measured: `Features` of recordings: ``crosshead.features("test.parquet", like=dataset)``.
    folds: folds of the cross-validation. Windows of one group or one recording stay together.
    """
    if not isinstance(measured, Features):
        raise InputError("measured: expected Features, as `crosshead.features(recordings, like=dataset)` gives them")
    if isinstance(dataset, Dataset):
        names = dataset.feature_names
        simulated = _rows(dataset.features, names, dataset.features["group"].tolist())
    elif isinstance(dataset, Features):
        names = dataset.names
        simulated = _rows(dataset.table, names, dataset.groups.tolist())
    else:
        raise InputError(f"dataset: found {type(dataset).__name__}, expected a Dataset or Features")
    missing = [name for name in names if name not in measured.table]
    if missing:
        raise InputError(f"measured: {missing[0]} is missing: crosshead.features(recordings, like=dataset) gives it")
    real = _rows(measured.table, names, measured.groups.tolist())
    auc, areas, features = _crosshead.domain_gap(names, simulated, real, folds, seed)
    return DomainGap(auc, areas, [TellingFeature(*feature) for feature in features])


def _rows(
    table: _crosshead.Table, names: Sequence[str], groups: list[str]
) -> tuple[list[list[float]], list[str]]:
    return matrix(table, names).T.tolist(), groups
