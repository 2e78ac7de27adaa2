"""Makes run01.csv: the machine of machine.yaml with a worn crosshead pin, as a monitoring system exports it.

    cargo build --release && python data/recordings/example-plant/make.py target/release/crosshead

`crosshead simulate` records guide acceleration, head-end pressure and crank angle with the noise of the sensors. The export
has g and psig, and in place of the crank angle the voltage of a keyphasor, whose pulse comes 137° after top dead centre.
The standard library is enough.
"""
import csv
import math
import pathlib
import random
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).parent
# What is not in machine.yaml, and what the estimation has to find.
CROSSHEAD_PIN = "0.012 in diametral"
KEYPHASOR = math.radians(137)
G = 9.80665
PSI = 4.4482216152605 / 0.0254**2
AMBIENT = 14.7
# The notch passes the probe in 8° of the shaft; its edges take 3° each.
NOTCH, EDGE = math.radians(8), math.radians(3)
LOW, HIGH = -9.0, -1.5


def keyphasor(angle):
    """Voltage of the probe at a crank angle, rad. The middle of the rising edge is the pulse."""
    since = (angle - KEYPHASOR + math.pi) % (2 * math.pi) - math.pi
    rise = min(max(since / EDGE + 0.5, 0.0), 1.0)
    fall = min(max((NOTCH - since) / EDGE + 0.5, 0.0), 1.0)
    return LOW + (HIGH - LOW) * min(rise, fall)


def simulated(program, folder):
    """The rows of the run."""
    command = [program, "simulate", str(HERE / "machine.yaml"), "--revolutions", "12", "--transient", "40"]
    command += ["--set", f"joints.small_end.clearance={CROSSHEAD_PIN}"]
    command += ["--seed", "1", "--format", "csv", "--quiet", "--out", folder]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    with open(pathlib.Path(folder) / "signals.csv", newline="") as file:
        return list(csv.DictReader(file))


def export(path, rows):
    """Writes the run as the monitoring system does."""
    noise = random.Random(1)
    with open(path, "w", newline="\r\n") as file:
        file.write("Machine,K-101 gas compressor\nExport,waveform\n")
        file.write(f"Run,run01\nSample rate,12800 Hz\nSamples,{len(rows)}\n\n")
        file.write("Time [s],Keyphasor [V],Guide acceleration [g],HE pressure [psig]\n")
        for i, row in enumerate(rows):
            volts = keyphasor(float(row["crank_angle_rad"])) + noise.gauss(0, 0.02)
            acceleration = float(row["housing_acceleration_y_m_s2"]) / G
            pressure = float(row["cylinder_pressure_pa"]) / PSI - AMBIENT
            file.write(f"{i / 12800:.7f},{volts:.3f},{acceleration:.4f},{pressure:.2f}\n")


with tempfile.TemporaryDirectory() as folder:
    rows = simulated(sys.argv[1], folder + "/run")
export(HERE / "run01.csv", rows)
