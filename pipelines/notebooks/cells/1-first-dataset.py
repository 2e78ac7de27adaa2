# %% [markdown]
# # A first dataset
#
# One run of a compressor with a worn small end, then a small dataset of worn and healthy machines: made, looked at, classified.
# Takes half a minute.

# %%
import os
import tempfile

import crosshead as ch
import matplotlib.pyplot as plt
import numpy as np

CASES = int(os.environ.get("CASES", 120))
MACHINE = "../../data/machines/single-stage.yaml"

# %% [markdown]
# ## One run
#
# Any value of the machine file can be changed by its path, with its unit. The picture has the recorded channels over the crank
# angle, and the path of the pin in its bearing: it leaves the bush twice in a revolution, and strikes the other side.

# %%
run = ch.simulate(MACHINE, **{"joints.small_end.clearance": "0.2 mm"})
run.plot();

# %%
{name: (samples.dtype, len(samples)) for name, samples in run.channels.items()}, run.summary["chambers"]

# %% [markdown]
# ## A dataset
#
# A sweep file says which joints are worn, by how much, and at which speeds.

# %%
folder = tempfile.mkdtemp()
sweep = f"""
name: first
machine: {os.path.abspath(MACHINE)}
seed: 1
run: {{revolutions: 8, transient: 10, chaos: false}}
cases:
  - random:
      count: {CASES}
      axes:
        joints: [[], [big_end], [small_end], [big_end, small_end]]
        clearance: {{log_uniform: [0.1 mm, 0.3 mm]}}
        speed: {{uniform: [400 rpm, 600 rpm]}}
"""
with open(f"{folder}/sweep.yaml", "w") as file:
    file.write(sweep)
ds = ch.generate(f"{folder}/sweep.yaml", out=f"{folder}/dataset", progress=False)
ds

# %% [markdown]
# Labels, conditions, unknowns and features are told apart. Tables are Arrow tables: polars, pandas and duckdb read them as they are.

# %%
import pandas as pd

pd.DataFrame.from_arrow(ds.cases).head()

# %%
X, y, groups = ds.xy("train")
column = ds.feature_names.index("crosshead_acceleration.kurtosis")
faults = sorted(set(y))
plt.figure(figsize=(7, 3), layout="constrained")
plt.boxplot([X[y == fault, column] for fault in faults], tick_labels=faults)
plt.ylabel("kurtosis of the acceleration");

# %% [markdown]
# ## The recordings
#
# Over the crank angle two machines at different speeds can be laid over each other.

# %%
signals, first, fault = ds.over_crank_angle("train", samples_per_revolution=512, channels=["crosshead_acceleration_m_s2"])
angle = np.arange(512) * 360 / 512
plt.figure(figsize=(8, 3), layout="constrained")
for name in faults:
    which = int(np.flatnonzero(fault == name)[0])
    revolution = np.roll(signals[which][0, :512], first[which])
    plt.plot(angle, revolution, linewidth=0.8, label=name)
plt.xlabel("crank angle, degrees"), plt.ylabel("acceleration, m/s²"), plt.legend();

# %% [markdown]
# ## A classifier
#
# Cases of one group differ in noise alone and are in one split only, so the test set is new to the classifier.

# %%
from sklearn.ensemble import ExtraTreesClassifier
from sklearn.metrics import ConfusionMatrixDisplay

model = ExtraTreesClassifier(300, random_state=0).fit(X, y)
X_test, y_test, _ = ds.xy("test")
print(f"right: {np.mean(model.predict(X_test) == y_test):.2f} of {len(y_test)}")
ConfusionMatrixDisplay.from_predictions(y_test, model.predict(X_test), xticks_rotation=30);
