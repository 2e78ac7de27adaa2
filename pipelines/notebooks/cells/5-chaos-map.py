# %% [markdown]
# # Where the motion is chaotic
#
# A journal that is loose in its bearing bounces. Whether it does so alike in every revolution depends on speed and clearance.
# This map has the largest Lyapunov exponent of each case, from the equations of motion: positive where nearby motions part
# (chaos), negative where they meet (periodic). `pipelines/chaos-map.yaml` is the larger sweep for a page.
#
# Takes four minutes of processor time.

# %%
import os
import tempfile

import crosshead as ch
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

CASES = int(os.environ.get("CASES", 120))
SPEEDS, CLEARANCES, STEPS = max(CASES // 12, 2), 12, max(CASES // 3, 3)
FOLDER = tempfile.mkdtemp()

# %% [markdown]
# ## The sweep
#
# The contact of the small end has a tenth of the usual damping: with all of it hardly any case is chaotic. Each exponent is
# followed over 100 revolutions. The diagram changes the clearance step by step, and once back.

# %%
speeds = np.linspace(400, 650, SPEEDS)
clearances = np.geomspace(0.03, 0.5, CLEARANCES)


def listed(values, unit):
    return ", ".join(f"{value:.4g} {unit}" for value in values)


sweep = f"""
name: chaos-map
machine: {os.path.abspath("../../data/machines/single-stage.yaml")}
seed: 3
run: {{revolutions: 20, transient: 50, lyapunov: {{revolutions: 100, transient: 50}}, chaos: false}}
cases:
  - grid:
      joints: [[small_end]]
      clearance: [{listed(clearances, "mm")}]
      speed: [{listed(speeds, "rpm")}]
      joints.small_end.contact.damping: [2e3 N s/m]
bifurcations:
  - name: small-end
    path: clearance
    joints: [small_end]
    from: 0.03 mm
    to: 0.5 mm
    steps: {STEPS}
    transient: 20
    revolutions: 20
    set: {{joints.small_end.contact.damping: 2e3 N s/m}}
splits: {{train: 100 %}}
"""
with open(f"{FOLDER}/sweep.yaml", "w") as file:
    file.write(sweep)
ds = ch.generate(f"{FOLDER}/sweep.yaml", out=f"{FOLDER}/dataset", progress=False)
cases = pd.DataFrame.from_arrow(ds.cases)
cases["regime_true"].value_counts()

# %% [markdown]
# ## The map

# %%
cases["clearance_mm"] = (1e3 * cases["clearance_small_end_m"]).round(4)
exponents = cases.pivot(index="clearance_mm", columns="speed_rpm", values="lyapunov_true_per_revolution")
most = np.nanmax(np.abs(exponents.to_numpy()))
plt.figure(figsize=(6, 4), layout="constrained")
plt.pcolormesh(exponents.columns, exponents.index, exponents, cmap="RdBu_r", vmin=-most, vmax=most, shading="nearest")
plt.yscale("log"), plt.xlabel("speed, rpm"), plt.ylabel("clearance of the small end, mm")
plt.colorbar(label="largest exponent, per revolution");

# %% [markdown]
# An exponent whose interval of two standard errors holds 0 is not known to be either:

# %%
turn = 60 / cases["speed_rpm"]
error = 2 * cases["lyapunov_true_standard_error_per_s"] * turn
known = cases["lyapunov_true_per_revolution"].abs() > error
chaotic = cases[known & (cases["lyapunov_true_per_revolution"] > 0)]
print(f"chaotic: {len(chaotic)} of {len(cases)} cases, not known: {np.sum(~known)}")

# %% [markdown]
# ## The bifurcation diagram
#
# Where the journal is, once in each revolution. One point: every revolution is alike; two: every other one; a cloud: chaos. Where
# up and down differ, the motion depends on where it comes from.

# %%
diagram = pd.read_parquet(f"{ds.folder}/bifurcations/small-end.parquet")
plt.figure(figsize=(8, 3.5), layout="constrained")
for direction, colour in [("up", "tab:blue"), ("down", "tab:orange")]:
    some = diagram[(diagram["direction"] == direction) & diagram["small_end_x_m"].notna()]
    samples = some["small_end_x_m"]
    values = np.repeat(some["value"], [len(row) for row in samples])
    plt.plot(1e3 * values, 1e3 * np.concatenate(samples.to_list()), ".", markersize=2, color=colour, label=direction)
plt.xlabel("clearance, mm"), plt.ylabel("offset of the journal, mm"), plt.legend();
