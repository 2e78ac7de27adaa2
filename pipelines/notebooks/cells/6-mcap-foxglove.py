# %% [markdown]
# # Recordings in Foxglove
#
# With `format: mcap` a dataset has a file for each case that Foxglove, PlotJuggler and the tools of ROS 2 open. In Foxglove:
# open a file of `mcap/`, then choose *Import layout* and [foxglove-layout.json](foxglove-layout.json). Its panels are made for
# the channels of `data/machines/single-stage.yaml`.
#
# Takes some seconds.

# %%
import json
import os
import tempfile
from pathlib import Path

import crosshead as ch
import matplotlib.pyplot as plt
import numpy as np
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

CASES = min(int(os.environ.get("CASES", 6)), 6)
FOLDER = tempfile.mkdtemp()

# %%
sweep = f"""
name: recordings
machine: {os.path.abspath("../../data/machines/single-stage.yaml")}
format: mcap
seed: 1
run: {{revolutions: 10, transient: 10, chaos: false}}
cases:
  - random:
      count: {CASES}
      axes:
        joints: [[], [small_end]]
        clearance: {{log_uniform: [0.1 mm, 0.3 mm]}}
        speed: {{uniform: [400 rpm, 600 rpm]}}
splits: {{train: 100 %}}
"""
with open(f"{FOLDER}/sweep.yaml", "w") as file:
    file.write(sweep)
ds = ch.generate(f"{FOLDER}/sweep.yaml", out=f"{FOLDER}/dataset", progress=False)
files = sorted((ds.folder / "mcap").iterdir())
[(path.name, path.stat().st_size) for path in files]

# %% [markdown]
# ## Read in Python
#
# The package `mcap` reads them. The labels of a case stand in its metadata, the sweep that made it is attached.

# %%
def read(path):
    """Labels, and the channels as arrays."""
    with open(path, "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        labels = next(record.metadata for record in reader.iter_metadata() if record.name == "labels")
        messages = [message for *_, message in reader.iter_decoded_messages("/crosshead")]
    return labels, {name: np.array([getattr(message, name) for message in messages]) for name in messages[0].__slots__}


recordings = [read(path) for path in files]
labels, channels = recordings[0]
{name: labels[name] for name in ["fault", "speed_rpm", "sample_rate_hz"]}, [name for name in channels if name != "stamp"]

# %%
figure, axes = plt.subplots(2, 1, figsize=(8, 4), layout="constrained")
for labels, channels in recordings[:3]:
    order = np.argsort(channels["crank_angle_rad"])
    angle = np.degrees(channels["crank_angle_rad"][order])
    for axis, name in zip(axes, ["crosshead_acceleration_m_s2", "cylinder_pressure_pa"]):
        axis.plot(angle, channels[name][order], ".", markersize=1, label=labels["fault"])
        axis.set_ylabel(name)
axes[1].set_xlabel("crank angle, degrees"), axes[0].legend(markerscale=8);

# %% [markdown]
# ## The layout
#
# Each path of a panel is a topic and a field of its messages.

# %%
panels = json.loads(Path("foxglove-layout.json").read_text())["configById"]
{name: [path["value"] for path in panel.get("paths", [])] or panel.get("topicPath") for name, panel in panels.items()}
