# %% [markdown]
# # Valves, rings, joints and sensors: which fault is it?
#
# A baseline for `pipelines/valve-and-ring-faults.yaml`: leaking and sticking valves, leaking and rubbing rings, worn joints, and
# sensors that read wrong, beside healthy machines. Contacts, masses, valves and noise differ from case to case. Training and test
# are both simulated: these figures say how far the classes can be told apart, not how well that works on a real machine.
#
# Takes ten minutes on two cores. `DATASET` names a dataset that is there already.

# %%
import os
import tempfile

import crosshead as ch
import matplotlib.pyplot as plt
import numpy as np
from sklearn.ensemble import ExtraTreesClassifier, HistGradientBoostingClassifier
from sklearn.metrics import ConfusionMatrixDisplay, balanced_accuracy_score, confusion_matrix, recall_score
from threadpoolctl import threadpool_limits

CASES = int(os.environ.get("CASES", 3072))
FOLDER = tempfile.mkdtemp()

# %%
if "DATASET" in os.environ:
    ds = ch.Dataset(os.environ["DATASET"])
else:
    with open("../valve-and-ring-faults.yaml") as file:
        sweep = file.read().replace("../data", os.path.abspath("../../data"))
    with open(f"{FOLDER}/sweep.yaml", "w") as file:
        file.write(sweep.replace("count: 256", f"count: {max(CASES // 12, 2)}"))
    ds = ch.generate(f"{FOLDER}/sweep.yaml", out=f"{FOLDER}/dataset", progress=False)
ds

# %% [markdown]
# ## Features and operating point
#
# Speed and pressures of the plant are known. Whoever leaves them out cannot know how large an amplitude should be.


# %%
OPERATING_POINT = ["speed_rpm", "suction_pressure_pa", "discharge_pressure_pa"]


def matrix(split, operating_point=True):
    """Features, and beside them speed and pressures."""
    X, y, _ = ds.xy(split)
    conditions = ds.conditions(split)
    columns = [conditions[name] for name in OPERATING_POINT] if operating_point else []
    return np.column_stack([X, *columns]), y


def tried(words, model, operating_point):
    """What a model says of the test split."""
    found = model.fit(*matrix("train", operating_point)).predict(matrix("test", operating_point)[0])
    right, balanced = np.mean(found == truth), balanced_accuracy_score(truth, found)
    print(f"{words}: {right:.3f} of {len(truth)} right, mean over classes {balanced:.3f}")
    return found


_, truth = matrix("test")
trees = ExtraTreesClassifier(500, class_weight="balanced", random_state=0)
boosting = HistGradientBoostingClassifier(class_weight="balanced", random_state=0)
tried("trees, features alone", trees, operating_point=False)
tried("trees, with the operating point", trees, operating_point=True)
# So few rows are worked on faster by one thread than by several that wait for each other.
with threadpool_limits(1, user_api="openmp"):
    found = tried("gradient boosting, with the operating point", boosting, operating_point=True)

# %% [markdown]
# ## The classes that are confused

# %%
classes = sorted(set(truth) | set(found))
figure, axes = plt.subplots(figsize=(9, 8), layout="constrained")
ConfusionMatrixDisplay.from_predictions(truth, found, labels=classes, ax=axes, xticks_rotation=90, colorbar=False);

# %%
counts = confusion_matrix(truth, found, labels=classes)
wrong = counts - np.diag(np.diag(counts))
for place in np.argsort(-wrong, axis=None)[:8]:
    row, column = np.unravel_index(place, wrong.shape)
    if wrong[row, column]:
        print(f"{classes[row]} taken for {classes[column]}: {wrong[row, column]} of {counts[row].sum()}")

# %% [markdown]
# How many of each class are found:

# %%
recalls = recall_score(truth, found, labels=classes, average=None, zero_division=0)
plt.figure(figsize=(7, 4), layout="constrained")
plt.barh(classes, recalls), plt.xlabel("share found"), plt.xlim(0, 1);
