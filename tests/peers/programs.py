"""The programs that are compared: how each is started, its methods and tolerances."""

import dataclasses
import math
import select
import subprocess
from pathlib import Path

REVOLUTIONS = 20
TIMEOUT = 120.0  # s, of one run


def tolerances(coarse, fine, per_decade=2):
    """Tolerances from 10^coarse down to 10^fine."""
    count = round((coarse - fine) * per_decade)
    return [f"{10.0 ** (coarse - i / per_decade):.3g}" for i in range(count + 1)]


@dataclasses.dataclass
class Program:
    """A program and what it computes."""

    name: str
    command: list
    methods: list
    tolerances: list
    what: str
    served: bool = False  # answers lines from standard input instead of being started anew
    process: subprocess.Popen = None

    def points(self):
        """Every method at every tolerance."""
        return [(method, tolerance) for method in self.methods for tolerance in self.tolerances]

    def measure(self, point, path):
        """CPU milliseconds a revolution of a run that writes its samples to `path`; infinite where
        it fails or takes too long."""
        words = [*point, str(REVOLUTIONS), str(path)]
        path.unlink(missing_ok=True)
        try:
            found = self.ask(words) if self.served else self.start(words)
            return float(found) if path.exists() else math.inf
        except (ValueError, OSError, subprocess.SubprocessError):
            return math.inf

    def start(self, words):
        if self.name.startswith("crosshead"):
            method, tolerance, revolutions, path = words
            words = ["--width", method, "--tolerance", tolerance, "--revolutions", revolutions,
                     "--out", path]
        return subprocess.run([*self.command, *words], timeout=TIMEOUT, check=True,
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout

    def ask(self, words):
        if self.process is None:
            self.process = subprocess.Popen(self.command, stdin=subprocess.PIPE,
                                            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        self.process.stdin.write((" ".join(words) + "\n").encode())
        self.process.stdin.flush()
        ready, _, _ = select.select([self.process.stdout], [], [], TIMEOUT)
        answer = self.process.stdout.readline() if ready else b""
        if not answer:
            self.close()
        return answer

    def close(self):
        if self.process is not None:
            self.process.kill()
            self.process.wait()
            self.process = None


def programs(installed, quick):
    """Those of `installed` (name: command), the yardstick first."""
    here = Path(__file__).resolve().parent / "integrators"
    step = 1 if quick else 2
    usual = tolerances(-3, -12, step)
    steps = [f"{1e-4 / 2**i:.6g}" for i in range(3 if quick else 6)]
    python = [*installed.get("python", []), "-u"]
    known = [
        Program("cvode_bdf", installed.get("cvode"), ["bdf", "bdf-events"],
                tolerances(-3, -13, step), "SUNDIALS CVODE, BDF; C"),
        Program("cvode_adams", installed.get("cvode"), ["adams", "adams-events"], usual,
                "SUNDIALS CVODE, Adams; C"),
        Program("crosshead", installed.get("crosshead"), ["0"], tolerances(-2, -11, step),
                "this project, one machine alone"),
        Program("crosshead_ensemble", installed.get("crosshead_ensemble"),
                [installed.get("width", "")], tolerances(-2, -11, step),
                "this project, per trajectory of the ensemble"),
        Program("diffsol", installed.get("diffsol"),
                ["tsit45", "tsit45-events", "bdf", "bdf-events", "esdirk34", "tr_bdf2"],
                tolerances(-3, -11, step), "diffsol, best of Tsit45, BDF, ESDIRK34, TR-BDF2; Rust"),
        Program("numbalsoda", installed.get("numbalsoda"),
                ["dop853", "dop853-restart", "lsoda", "lsoda-restart"], usual,
                "numbalsoda, best of DOP853 and LSODA; numba", served=True),
        Program("scipy_lsoda", installed.get("scipy"), ["LSODA", "LSODA-restart"],
                tolerances(-3, -10, step), "SciPy solve_ivp LSODA; numba", served=True),
        Program("scipy_odeint", installed.get("scipy"), ["odeint", "odeint-restart"], usual,
                "SciPy odeint (LSODA, the older interface); numba", served=True),
        Program("scipy_dop853", installed.get("scipy"), ["DOP853-restart"],
                tolerances(-3, -9, 1), "SciPy solve_ivp DOP853; numba", served=True),
        Program("simbody", installed.get("simbody"), ["merson", "cpodes"], tolerances(-3, -9, 1),
                "Simbody bodies, best of Runge-Kutta-Merson and CPodes; forces in C++"),
        Program("mujoco", installed.get("mujoco"), ["rk4"], steps,
                "MuJoCo bodies and joints, RK4 of fixed step; contact and gas in a C callback"),
        Program("mujoco_python", installed.get("mujoco") and [here / "with_mujoco.py"], ["rk4"],
                steps, "the same from Python; callback in numba", served=True),
        Program("exudyn", installed.get("exudyn"), ["RK44", "RK67"], steps,
                "Exudyn, explicit solvers of fixed step; forces in a numba callback", served=True),
    ]
    for program in known:
        if program.command and program.served:
            program.command = [*python, *program.command]
    return [program for program in known if program.command]
