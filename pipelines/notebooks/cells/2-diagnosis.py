# %% [markdown]
# # Diagnosis of recordings of another program
#
# The recordings in `data/recordings/example-diagnosis` were made by another simulator, whose author did not see this one. Three
# recordings of the healthy machine are all that is known of it. A dataset is simulated for the machine calibrated to these, a
# classifier is trained on the dataset alone, and tested on 24 recordings with worn joints. No measured label is used for training.
#
# Takes eight minutes on two cores.

# %%
import csv
import os
import tempfile

import crosshead as ch
import matplotlib.pyplot as plt
import numpy as np
from sklearn.ensemble import ExtraTreesClassifier, ExtraTreesRegressor
from sklearn.metrics import ConfusionMatrixDisplay

CASES = int(os.environ.get("CASES", 2048))
ROOT = "../../data/recordings/example-diagnosis"
FOLDER = tempfile.mkdtemp()

# %% [markdown]
# ## 1. Calibrate
#
# Contact stiffness, damping and friction are fitted to the healthy recordings. The noise of the sensor is taken from them, too.

# %%
cal = ch.calibrate(f"{ROOT}/healthy", out=f"{FOLDER}/calibrated", progress=False)
for path, found in cal.parameters.items():
    print(f"{path}: {found.value:.4g} ({found.low:.4g} to {found.high:.4g}), nominal {found.nominal:.4g}")
print(f"misfit {cal.fit['calibrated']:.2f} times the noise, {cal.fit['nominal']:.1f} before; not identifiable: {cal.not_identifiable}")

# %% [markdown]
# ## 2. Generate
#
# The sweep file is `pipelines/diagnosis.yaml`: either joint of the rod worn by 0.1 to 0.4 mm, any speed and discharge pressure. What the calibration leaves open varies from case to case. Only the channels of the recordings are recorded.

# %%
with open("../diagnosis.yaml") as file:
    sweep = file.read().replace("../data", os.path.abspath("../../data"))


def dataset(name, machine, more="", cases=CASES, **options):
    """The dataset of a machine."""
    path = f"{FOLDER}/{name}.yaml"
    with open(path, "w") as file:
        file.write(sweep.replace("count: 2048", f"count: {cases}") + more)
    return ch.generate(path, machine=machine, out=f"{FOLDER}/{name}", progress=False, **options)


ds = dataset("calibrated-machine", cal)
ds

# %% [markdown]
# ## 3. The same features of the recordings
#
# `like=ds` gives the features of the dataset, and refuses recordings of another rate, length or of other channels.

# %%
T = ch.features(f"{ROOT}/labelled/recordings.parquet", like=ds, progress=False)
with open(f"{ROOT}/labels.csv") as file:
    labels = {row["id"]: row for row in csv.DictReader(file)}
rows = [labels[name] for name in T.table["id"]]
truth = np.array([row["fault"].replace("both", "big_end+small_end") for row in rows])
T

# %% [markdown]
# Can a classifier tell simulated windows from measured ones? An area of 0.5 says no, 1 says always.

# %%
print(ch.domain_gap(ds, T))

# %% [markdown]
# ## 4. Train and test


# %%
def everything(ds, target):
    """All splits: the test is elsewhere."""
    parts = [ds.xy(split, target) for split in ds.splits]
    return np.vstack([x for x, *_ in parts]), np.concatenate([y for _, y, _ in parts])


def classifier(ds):
    return ExtraTreesClassifier(300, random_state=0).fit(*everything(ds, "fault"))


model = classifier(ds)
found = model.predict(T.X)
print(f"fault right: {np.sum(found == truth)} of {len(truth)}")
print(f"worn or not right: {np.sum((found == 'none') == (truth == 'none'))} of {len(truth)}")
ConfusionMatrixDisplay.from_predictions(truth, found, xticks_rotation=30);

# %% [markdown]
# How worn: the clearance of each worn joint, from a regression of its logarithm on the cases in which that joint is worn.

# %%
right = total = 0
plt.figure(figsize=(4, 4), layout="constrained")
for joint in ["big_end", "small_end"]:
    column = f"clearance_{joint}_m"
    X, y = everything(ds, column)
    _, faults = everything(ds, "fault")
    cases = np.array([joint in fault for fault in faults])
    regression = ExtraTreesRegressor(300, random_state=0).fit(X[cases], np.log(y[cases]))
    worn = np.array([joint in fault for fault in truth])
    true = np.array([float(row[column]) for row in rows])[worn]
    estimate = np.exp(regression.predict(T.X[worn]))
    right, total = right + np.sum(np.abs(estimate / true - 1) < 0.25), total + len(true)
    plt.loglog(1e3 * true, 1e3 * estimate, "o", label=joint)
plt.plot([0.1, 0.4], [0.1, 0.4], "k-", linewidth=0.8)
plt.xlabel("true clearance, mm"), plt.ylabel("estimate, mm"), plt.legend()
print(f"severity within 25 %: {right} of {total}")

# %% [markdown]
# The features that decide:

# %%
best = np.argsort(-model.feature_importances_)[:10]
for i in best:
    print(f"{model.feature_importances_[i]:.3f}  {ds.feature_names[i]}")

# %% [markdown]
# ## 5. What matters
#
# The same with less, from a seventh of the cases each: the calibrated machine as above; without the noise of its sensor; the nominal machine
# with contact parameters that vary; the nominal machine as the data sheet has it.

# %%
nominal = ch.Machine.from_bundle(f"{ROOT}/healthy")
channels = list(cal.noise)
SPREAD = """
vary:
  joints.*.contact.stiffness: {lognormal: {factor: 1.4}}
  joints.*.contact.damping: {lognormal: {factor: 1.4}}
  joints.*.friction.coefficient: {lognormal: {factor: 1.4}}
"""
silent = cal.machine.replace(**{"sensors.crosshead_acceleration.noise.rms": "0 %"})
few = {"cases": max(CASES // 7, 24), "channels": channels}
variants = {
    "calibrated, uncertainty sampled": dataset("few", cal, cases=few["cases"]),
    "calibrated, no sensor noise": dataset("silent", silent, **few),
    "nominal with spread": dataset("spread", nominal, SPREAD, **few),
    "nominal": dataset("nominal", nominal, **few),
}
for name, variant in variants.items():
    found = classifier(variant).predict(T.X)
    gap = ch.domain_gap(variant, T)
    print(f"{name}: fault right {np.sum(found == truth)} of {len(truth)}, domain gap {gap.auc:.2f}")
