"""Installs the programs that are compared, under target/, without changing the system.

Each installer gives the command to start, or raises with one line that says why there is none.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
WORK = TARGET / "peers"
VENV = WORK / "venv"
PYTHON = VENV / "bin" / "python"
INTEGRATORS = HERE / "integrators"
OPTIMISED = ["-O3", "-march=native"]


class Missing(Exception):
    """A program that cannot be installed, and why."""


def call(*command, reason, **keywords):
    """Runs a command quietly; where it fails, `reason` and its last line are the error."""
    words = [str(word) for word in command]
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=1800, **keywords)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise Missing(f"{reason}: {error}") from None
    if done.returncode:
        lines = [line for line in (done.stderr + done.stdout).splitlines() if line.strip()]
        raise Missing(f"{reason}: {lines[-1].strip() if lines else 'no message'}")
    return done.stdout


def pip(*packages):
    """Installs packages into the virtual environment, if they are not there."""
    if not PYTHON.exists():
        call(sys.executable, "-m", "venv", VENV, reason="no virtual environment")
    # One by one: of several, one that is there is enough for pip.
    show = [PYTHON, "-m", "pip", "show", "--quiet"]
    if any(subprocess.run([*show, package], capture_output=True).returncode for package in packages):
        call(PYTHON, "-m", "pip", "install", "--quiet", "--constraint",
             INTEGRATORS / "requirements.txt", *packages, reason="pip")


def site_packages():
    return Path(call(PYTHON, "-c", "import site; print(site.getsitepackages()[0])",
                     reason="no site-packages").strip())


def debian(name, header, *packages):
    """Folder like /usr with a library: the system's where it has the header, else one into which
    Debian's packages are unpacked."""
    root = WORK / name
    if not (root / "usr/include" / header).exists():
        if (Path("/usr/include") / header).exists():
            return Path("/usr")
        root.mkdir(parents=True, exist_ok=True)
        call("apt-get", "download", *packages, cwd=root, reason=name)
        for package in root.glob("*.deb"):
            call("dpkg", "-x", package, root, reason=name)
    return root / "usr"


def sundials():
    """Compiler flags and static libraries of SUNDIALS."""
    root = debian("sundials", "cvode/cvode.h", "libsundials-dev")
    include, library = root / "include", root / "lib"
    parts = ["cvode", "nvecserial", "sunlinsoldense", "sunmatrixdense", "sunnonlinsolnewton",
             "generic"]
    found = [next(library.rglob(f"libsundials_{part}.a"), None) for part in parts]
    if None in found:
        raise Missing("SUNDIALS has no static libraries here")
    return [f"-I{include}"], found


def cvode():
    flags, libraries = sundials()
    program = WORK / "cvode"
    call("gcc", *OPTIMISED, *flags, INTEGRATORS / "cvode.c", *libraries, "-lm", "-o", program,
         reason="cvode.c")
    return [program]


def crosshead():
    command = ["cargo", "build", "--quiet", "--release", "--package", "crosshead-simulate", "--features",
               "bench", "--example", "time_revolutions"]
    call(*command, cwd=ROOT, reason="time_revolutions")
    return [TARGET / "release" / "examples" / "time_revolutions"]


def crosshead_ensemble():
    """The widest lanes that the example has on this machine, and the command."""
    program = TARGET / "release" / "examples" / "time_revolutions"
    for width in ("8", "4", "2"):
        trial = [program, "--width", width, "--revolutions", "1"]
        if program.exists() and subprocess.run(trial, capture_output=True).returncode == 0:
            return [program], width
    raise Missing("the example has no lanes yet")


def diffsol():
    folder = WORK / "diffsol"
    call("cargo", "build", "--quiet", "--release", "--manifest-path",
         INTEGRATORS / "diffsol" / "Cargo.toml", "--target-dir", folder, reason="diffsol")
    return [folder / "release" / "with-diffsol"]


def numbalsoda():
    """Its wheels are for Python 3.10 and older, but hold no code of Python's own interface: the
    newest one is unpacked as it is, so no Fortran compiler is needed."""
    pip("numpy", "numba", "pyarrow")
    if not (site_packages() / "numbalsoda").exists():
        wheels = WORK / "wheels"
        call(PYTHON, "-m", "pip", "download", "--quiet", "--no-deps", "--only-binary=:all:",
             "--python-version", "3.10", "--platform", "manylinux2010_x86_64", "--dest", wheels,
             "numbalsoda==0.3.4", reason="numbalsoda")
        wheel = next(wheels.glob("numbalsoda*.whl"))
        call(PYTHON, "-m", "zipfile", "-e", wheel, site_packages(), reason="numbalsoda")
    return [INTEGRATORS / "with_numbalsoda.py"]


def scipy():
    pip("numpy", "numba", "scipy", "pyarrow")
    return [INTEGRATORS / "with_scipy.py"]


def simbody():
    root = debian("simbody", "simbody/Simbody.h", "libsimbody3.7", "libsimbody-dev", "liblapack3",
                  "libblas3", "libgfortran5", "libquadmath0")
    program, libraries = WORK / "with_simbody", root / "lib" / "x86_64-linux-gnu"
    paths = [libraries, libraries / "lapack", libraries / "blas"]
    # The old kind of path in the program also serves what its libraries need.
    link = ["-Wl,--disable-new-dtags", *[f"-Wl,-rpath,{path}" for path in paths],
            "-Wl,--allow-shlib-undefined"]
    call("g++", *OPTIMISED, "-w", f"-I{root / 'include' / 'simbody'}",
         INTEGRATORS / "with_simbody.cpp", f"-L{libraries}", "-lSimTKsimbody", "-lSimTKmath",
         "-lSimTKcommon", *link, "-o", program, reason="simbody")
    return [program]


def mujoco():
    pip("mujoco")
    folder, program = site_packages() / "mujoco", WORK / "mujoco"
    library = next(folder.glob("libmujoco.so*"), None)
    if library is None:
        raise Missing("the mujoco wheel has no library")
    call("gcc", *OPTIMISED, f"-I{folder / 'include'}", INTEGRATORS / "with_mujoco.c", library,
         f"-Wl,-rpath,{folder}", "-lm", "-o", program, reason="with_mujoco.c")
    return [program]


def exudyn():
    pip("numpy", "numba", "exudyn")
    return [INTEGRATORS / "with_exudyn.py"]


SOURCES = {
    "cvode": cvode,
    "crosshead": crosshead,
    "crosshead_ensemble": crosshead_ensemble,
    "diffsol": diffsol,
    "numbalsoda": numbalsoda,
    "scipy": scipy,
    "simbody": simbody,
    "mujoco": mujoco,
    "exudyn": exudyn,
}


def install(wanted, say):
    """Command by name of all that install; a line for each that does not."""
    WORK.mkdir(parents=True, exist_ok=True)
    installed = {"python": [PYTHON]}
    for name, source in SOURCES.items():
        if not wanted(name):
            continue
        say(f"installing {name}")
        try:
            found = source()
        except Missing as missing:
            say(f"left out: {name} ({missing})")
            continue
        if isinstance(found, tuple):
            found, installed["width"] = found
        installed[name] = found
    if shutil.which("gen-dataset", path=TARGET / "release"):
        installed["gen-dataset"] = [TARGET / "release" / "gen-dataset"]
    return installed
