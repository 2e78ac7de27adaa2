# %% [markdown]
# # A convolutional network on recordings over the crank angle
#
# The same task as in [2-diagnosis](2-diagnosis.ipynb), without features: a small network in one dimension sees the acceleration
# itself. Over the crank angle all speeds have the same number of points in a revolution. It is trained on simulated recordings
# alone and tested on 24 recordings of another program.
#
# Needs PyTorch: `pip install torch`. Takes five minutes of processor time.

# %%
import csv
import os
import tempfile
import time

import crosshead as ch
import matplotlib.pyplot as plt
import numpy as np
import torch
from crosshead.torch import AngleWindows
from sklearn.metrics import ConfusionMatrixDisplay

CASES = int(os.environ.get("CASES", 800))
EPOCHS = int(os.environ.get("EPOCHS", 30))
ROOT = "../../data/recordings/example-diagnosis"
FOLDER = tempfile.mkdtemp()
CHANNEL, POINTS, REVOLUTIONS = "crosshead_acceleration_m_s2", 256, 8
torch.manual_seed(0);

# %% [markdown]
# ## 1. Simulate
#
# The machine is calibrated to its healthy recordings, as before.

# %%
cal = ch.calibrate(f"{ROOT}/healthy", progress=False)
with open("../diagnosis.yaml") as file:
    sweep = file.read().replace("../data", os.path.abspath("../../data")).replace("count: 2048", f"count: {CASES}")
with open(f"{FOLDER}/sweep.yaml", "w") as file:
    file.write(sweep)
ds = ch.generate(f"{FOLDER}/sweep.yaml", machine=cal, out=f"{FOLDER}/dataset", progress=False)
ds

# %% [markdown]
# ## 2. Windows of one length
#
# Eight revolutions of 256 points. In training each access begins at another place of the recording, so that the network cannot
# rely on where a recording begins.

# %%
options = {"samples_per_revolution": POINTS, "revolutions": REVOLUTIONS, "channels": [CHANNEL]}
train = ds.torch("train", **options)
held_out = ds.torch("test", classes=train.classes, **options)
signal, label = train[0]
plt.figure(figsize=(8, 2.5), layout="constrained")
plt.plot(np.arange(signal.shape[1]) / POINTS, signal[0], linewidth=0.6)
plt.xlabel("revolutions"), plt.ylabel("acceleration, m/s²"), plt.title(train.classes[label])
len(train), len(held_out), train.classes

# %% [markdown]
# The recordings of the other program in the same form:

# %%
with open(f"{ROOT}/labels.csv") as file:
    labels = {row["id"]: row["fault"].replace("both", "big_end+small_end") for row in csv.DictReader(file)}
signals, first = ch.over_crank_angle(f"{ROOT}/labelled/recordings.parquet", [CHANNEL], POINTS)
truth = np.array(list(labels.values()))
measured = AngleWindows(signals, first, truth, POINTS, REVOLUTIONS, "random", train.classes, seed=0)

# %% [markdown]
# ## 3. Train
#
# The acceleration grows with the square of the speed, so that each window is divided by its RMS.


# %%
class Scale(torch.nn.Module):
    """Divides each window by its RMS."""

    def forward(self, x):
        return x / x.square().mean(dim=(1, 2), keepdim=True).sqrt()


def block(inside, outside, width, stride):
    return [
        torch.nn.Conv1d(inside, outside, width, stride, padding=width // 2, bias=False),
        torch.nn.BatchNorm1d(outside),
        torch.nn.ReLU(),
    ]


model = torch.nn.Sequential(
    Scale(),
    *block(1, 16, 15, 2),
    *block(16, 32, 9, 4),
    *block(32, 64, 9, 4),
    *block(64, 64, 5, 2),
    torch.nn.AdaptiveAvgPool1d(1),
    torch.nn.Flatten(),
    torch.nn.Linear(64, len(train.classes)),
)
print(sum(weights.numel() for weights in model.parameters()), "weights")


def chances(windows, places=8):
    """Chances of each class, the mean over windows that begin at several places."""
    model.eval()
    with torch.no_grad():
        one = lambda: model(torch.stack([windows[i][0] for i in range(len(windows))])).softmax(1)
        return torch.stack([one() for _ in range(places)]).mean(0).numpy()


def share_right(windows):
    return np.mean(chances(windows).argmax(1) == [int(windows[i][1]) for i in range(len(windows))])


started = time.perf_counter()
loader = torch.utils.data.DataLoader(train, batch_size=32, shuffle=True)
optimiser = torch.optim.AdamW(model.parameters(), weight_decay=1e-2)
schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, 3e-3, epochs=EPOCHS, steps_per_epoch=len(loader))
losses = []
for epoch in range(EPOCHS):
    model.train()
    total = 0.0
    for x, y in loader:
        loss = torch.nn.functional.cross_entropy(model(x), y)
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        schedule.step()
        total += len(x) * loss.item()
    losses.append(total / len(train))
print(f"{EPOCHS} epochs in {time.perf_counter() - started:.0f} s")
plt.figure(figsize=(5, 2.5), layout="constrained")
plt.semilogy(losses), plt.xlabel("epoch"), plt.ylabel("cross entropy");

# %% [markdown]
# ## 4. Test

# %%
print(f"simulated recordings that were held out: {share_right(held_out):.3f} of {len(held_out)} right")
found = np.array(train.classes)[chances(measured).argmax(1)]
print(f"recordings of the other program: fault right {np.sum(found == truth)} of {len(truth)}")
print(f"worn or not right: {np.sum((found == 'none') == (truth == 'none'))} of {len(truth)}")
ConfusionMatrixDisplay.from_predictions(truth, found, xticks_rotation=30);
