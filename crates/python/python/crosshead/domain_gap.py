"""How far simulated recordings differ from measured ones, as a classifier sees it."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from .dataset import Dataset
from .errors import InputError
from .features import Features, numbers_of


# Rows that are judged in one call.
_ROWS = 20_000

# Numbers from which several threads share the work.
_SHARED = 1_000_000


@dataclasses.dataclass(frozen=True)
class Tell:
    """A feature that tells simulated windows from measured ones."""

    feature: str
    auc: float
    """Area under the curve of this feature alone: 0.5 tells nothing, 1 everything."""
    loss: float
    """What the classifier's area loses when this feature is shuffled."""
    simulated: float
    """Median of the simulated windows."""
    measured: float
    """Median of the measured windows."""


@dataclasses.dataclass(frozen=True)
class DomainGap:
    """How well a classifier tells simulated windows from measured ones."""

    auc: float
    """Area under the curve on held-out windows: 0.5 where nothing tells them apart, 1 where everything does."""
    folds: list[float]
    """The same of each fold."""
    features: list[Tell]
    """The features that give it away, the most telling first."""

    def __str__(self) -> str:
        lines = [f"AUC {self.auc:.3f} (folds {', '.join(f'{auc:.3f}' for auc in self.folds)})"]
        for tell in self.features[:10]:
            lines.append(
                f"  {tell.feature}: alone {tell.auc:.3f}, loss {tell.loss:.3f}, "
                f"simulated {tell.simulated:.4g}, measured {tell.measured:.4g}"
            )
        return "\n".join(lines)


def domain_gap(
    dataset: Dataset | Features, measured: Features, *, folds: int = 5, seed: int = 0, classifier: Any = None
) -> DomainGap:
    """Trains a classifier to tell the windows of a dataset from measured ones, and tests it on windows that it has not seen.

    dataset: a `Dataset`, all splits; or `Features` of simulated recordings.
    measured: `Features` of recordings: ``crosshead.features("test.parquet", like=dataset)``.
    folds: folds of the cross-validation. Windows of one group or one recording stay together.
    classifier: of scikit-learn; by default gradient boosting, which takes missing values as they are.
    """
    from sklearn.ensemble import HistGradientBoostingClassifier
    from sklearn.model_selection import StratifiedKFold
    from threadpoolctl import threadpool_limits

    if not isinstance(measured, Features):
        raise InputError("measured: expected Features, as `crosshead.features(recordings, like=dataset)` gives them")
    names = dataset.feature_names if isinstance(dataset, Dataset) else dataset.names
    simulated, of_simulated = numbers_of(dataset, names)
    real, of_real = numbers_of(measured, names)
    units = _units(of_simulated, len(simulated)), _units(of_real, len(real), row_each=True)
    x = np.vstack([simulated, real])
    y = np.repeat([0, 1], [len(simulated), len(real)])
    groups = np.concatenate([units[0], units[1] + len(simulated)])
    if min(len(set(units[0])), len(set(units[1]))) < folds:
        raise InputError(f"folds: found {folds}, expected at most the number of recordings on either side")
    model = classifier or HistGradientBoostingClassifier(random_state=seed)
    random = np.random.default_rng(seed)
    # Folds of groups, each group counted once and stratified by side.
    kinds, first = np.unique(groups, return_index=True)
    areas: list[float] = []
    losses = []
    # So few numbers are worked on faster by one thread than by several that wait for each other.
    threads = 1 if x.size < _SHARED else None
    with threadpool_limits(threads, user_api="openmp"):
        for _, held_out in StratifiedKFold(folds, shuffle=True, random_state=seed).split(kinds, y[first]):
            test = np.isin(groups, kinds[held_out])
            model.fit(x[~test], y[~test])
            area = _area(_scores(model, x[test]), y[test])
            areas.append(area)
            losses.append(area - _shuffled(model, x[test], y[test], random))
    # Whichever way a feature points; a missing value tells as one below all others does.
    alone = _area(np.where(np.isfinite(x), x, -np.inf).T, y)
    alone = np.maximum(alone, 1 - alone)
    tells = [
        Tell(name, float(alone[i]), float(loss), _median(simulated[:, i]), _median(real[:, i]))
        for i, (name, loss) in enumerate(zip(names, np.mean(losses, axis=0)))
    ]
    tells.sort(key=lambda tell: (-round(tell.loss, 6), -tell.auc))
    return DomainGap(float(np.mean(areas)), [float(area) for area in areas], tells)


def _units(groups: np.ndarray, rows: int, row_each: bool = False) -> np.ndarray:
    """A whole number for each group. Rows of one file of several recordings are recordings of their own."""
    kinds, numbers = np.unique(groups.astype(str), return_inverse=True)
    if row_each and len(kinds) < rows and len(kinds) == 1:
        return np.arange(rows)
    return numbers


def _scores(model: Any, x: np.ndarray) -> np.ndarray:
    if hasattr(model, "decision_function"):
        return model.decision_function(x)
    return model.predict_proba(x)[:, 1]


def _shuffled(model: Any, x: np.ndarray, y: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """The area with each column shuffled, one after the other. Several copies are judged at once: a call costs more than its
    rows."""
    rows, columns = x.shape
    at_once = max(1, _ROWS // rows)
    areas = []
    for begin in range(0, columns, at_once):
        some = range(begin, min(begin + at_once, columns))
        copies = np.tile(x, (len(some), 1, 1))
        for copy, column in zip(copies, some):
            random.shuffle(copy[:, column])
        areas.append(_area(_scores(model, copies.reshape(-1, columns)).reshape(len(some), rows), y))
    return np.concatenate(areas)


def _area(scores: np.ndarray, y: np.ndarray) -> Any:
    """Area under the curve of each row of scores, by the ranks of the measured windows (Mann and Whitney 1947)."""
    from scipy.stats import rankdata

    measured = int(y.sum())
    ranks = rankdata(scores, axis=-1)[..., y == 1].sum(axis=-1)
    return (ranks - measured * (measured + 1) / 2) / (measured * (len(y) - measured))


def _median(values: np.ndarray) -> float:
    return float(np.nanmedian(values)) if np.isfinite(values).any() else float("nan")
