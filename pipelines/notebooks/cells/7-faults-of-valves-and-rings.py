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
def matrix(split, operating_point=True):
    """Features, and beside them the conditions."""
    X, y, _ = ds.xy(split)
    conditions = ds.conditions(split)
    columns = [conditions[name] for name in conditions.names] if operating_point else []
    return np.column_stack([X, *columns]), y


models = {
    "extremely randomised trees": lambda: ExtraTreesClassifier(500, class_weight="balanced", n_jobs=-1, random_state=0),
    "gradient boosting": lambda: HistGradientBoostingClassifier(class_weight="balanced", random_state=0),
}
results = {}
for name, model in models.items():
    for words, operating_point in [("with the operating point", True), ("features alone", False)]:
        found = model().fit(*matrix("train", operating_point)).predict(matrix("test", operating_point)[0])
        truth = matrix("test")[1]
        results[name, words] = found
        print(
            f"{name}, {words}: {np.mean(found == truth):.3f} of {len(truth)} right, "
            f"balanced {balanced_accuracy_score(truth, found):.3f}"
        )

# %% [markdown]
# ## The classes that are confused

# %%
found = max((found for found in results.values()), key=lambda found: balanced_accuracy_score(truth, found))
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
