# %% [markdown]
# # Explain a gap, and train again
#
# The recordings in `data/recordings/example-hidden-effect` were made by another program, whose machine does something that the
# model of the data sheet does not. What does that cost a model trained on simulated recordings, and is it repaired when the
# missing effect is found and added?
#
# Takes six minutes of processor time.

# %%
import os
import tempfile

import crosshead as ch
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from sklearn.ensemble import ExtraTreesRegressor

CASES = int(os.environ.get("CASES", 300))
BUNDLE = "../../data/recordings/example-hidden-effect"
FOLDER = tempfile.mkdtemp()

# %% [markdown]
# ## 1. Calibrate: the model does not fit
#
# Misfits are in units of the noise: 1 is a model from which nothing is left but noise.

# %%
cal = ch.calibrate(BUNDLE, out=f"{FOLDER}/calibrated", progress=False)
print(f"misfit {cal.fit['calibrated']:.2f}, adequate: {cal.model_is_adequate}")

# %% [markdown]
# ## 2. Explain
#
# The effects of the catalogue are tried one after another. What is believed must predict the held-out runs.

# %%
ex = ch.explain_gap(BUNDLE, out=f"{FOLDER}/explained", progress=False)
print(ex.verdict)
for effect in ex.effects:
    print(effect["effect"], effect["places"])
print(f"misfit {ex.gap['before']:.2f} before, {ex.gap['after']:.2f} after")

# %% [markdown]
# ## 3. Prediction
#
# The pressure and the acceleration of the first run, recorded, and simulated by the machine before and after.

# %%
recorded = pd.read_parquet(f"{BUNDLE}/run01.parquet")
run = {"speed": "350 rpm", "cylinder.suction": "0.105 MPa", "cylinder.discharge": "0.393 MPa"}
run["joints.small_end.clearance"] = "0.1 mm"
figure, axes = plt.subplots(2, 1, figsize=(8, 5), sharex=True, layout="constrained")
measured = recorded["crank_angle_rad"].to_numpy()
channels = ["cylinder_pressure_pa", "crosshead_acceleration_m_s2"]


def over_angle(angle, samples):
    """The mean over revolutions at each degree."""
    bins = (np.degrees(angle) + 0.5).astype(int) % 360
    return np.bincount(bins, samples, 360) / np.bincount(bins, minlength=360)


for name, axis in zip(channels, axes):
    axis.plot(over_angle(measured, recorded[name]), "k", label="recorded")
    axis.set_ylabel(name)
for words, machine in [("before", cal.machine), ("after", ex.machine)]:
    simulated = ch.simulate(machine, sample_rate=20000, progress=False, **run)
    for name, axis in zip(channels, axes):
        curve = over_angle(simulated.crank_angle_rad, simulated.channels[name].astype(float))
        axis.plot(curve, linewidth=0.8, label=words)
        truth = over_angle(measured, recorded[name].to_numpy(float))
        print(f"{words}, {name}: RMS error {np.sqrt(np.mean((curve - truth) ** 2)) / np.std(truth):.1%} of the curve's deviation")
axes[1].set_xlabel("crank angle, degrees"), axes[0].legend();

# %% [markdown]
# ## 4. Train before and after
#
# The clearance of the small end from features, by a regression that has seen simulated recordings alone: of the calibrated
# machine, and of the machine with the effect. Each run of the bundle is cut into windows of ten revolutions.

# %%
SWEEP = f"""
name: retrain
machine: {os.path.abspath("../../data/machines/single-stage.yaml")}
seed: 1
run: {{revolutions: 10, transient: 10, sample_rate: 20 kHz, chaos: false}}
cases:
  - random:
      count: {CASES}
      axes:
        joints: [[small_end]]
        clearance: {{log_uniform: [0.05 mm, 0.4 mm]}}
        speed: {{uniform: [350 rpm, 650 rpm]}}
        cylinder.discharge: {{uniform: [0.30 MPa, 0.40 MPa]}}
"""
with open(f"{FOLDER}/sweep.yaml", "w") as file:
    file.write(SWEEP)
TRUTH_MM = {"run07": 0.2}
for words, machine in [("before", cal.machine), ("after", ex.machine)]:
    channels = list(cal.noise)
    ds = ch.generate(f"{FOLDER}/sweep.yaml", machine=machine, channels=channels, out=f"{FOLDER}/{words}", progress=False)
    T = ch.features(BUNDLE, like=ds, progress=False)
    parts = [ds.xy(split, "clearance_small_end_m") for split in ds.splits]
    X, y = np.vstack([x for x, *_ in parts]), np.concatenate([y for _, y, _ in parts])
    model = ExtraTreesRegressor(300, random_state=0).fit(X, np.log(1e3 * y))
    found = np.exp(model.predict(T.X))
    truth = np.array([TRUTH_MM.get(file.split("/")[-1].split(".")[0], 0.1) for file in T.table["file"]])
    error = found / truth - 1
    print(
        f"{words}: clearance within 25 % in {np.sum(np.abs(error) < 0.25)} of {len(truth)} windows, "
        f"median error {np.median(np.abs(error)):.1%}; domain gap {ch.domain_gap(ds, T).auc:.2f}"
    )
