"""A Slurm cluster of two nodes on this machine: Debian's daemons with a configuration of their own.

With `network=True` each node has a network namespace, and a cable that can be pulled.
"""

import contextlib
import os
import pathlib
import shutil
import signal
import subprocess
import time

from common import expect, say, wait_until

PACKAGES = ["slurmctld", "slurmd", "slurm-client", "munge"]

CONFIGURATION = """
ClusterName=test
SlurmctldHost={host}({controller})
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket={folder}/run/munge.sock
SlurmUser=root
SlurmdUser=root
SlurmctldPort=16817
SlurmctldPidFile={folder}/run/slurmctld.pid
SlurmdPidFile={folder}/run/slurmd.%n.pid
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool/%n
SlurmctldLogFile={folder}/log/slurmctld.log
SlurmdLogFile={folder}/log/slurmd.%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
SchedulerParameters=bf_interval=2,sched_interval=2,batch_sched_delay=0,sched_min_interval=0
ReturnToService=2
SlurmctldTimeout=10
SlurmdTimeout=10
MessageTimeout=5
InactiveLimit=0
KillWait=2
MinJobAge=600
MaxArraySize=1001
SlurmdParameters=config_overrides
NodeName=n1 NodeHostname={host} NodeAddr={first} Port=16818 CPUs={processors} RealMemory=2000 State=UNKNOWN
NodeName=n2 NodeHostname={host} NodeAddr={second} Port=16819 CPUs={processors} RealMemory=2000 State=UNKNOWN
PartitionName=sweep Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
"""


def install():
    """Installs the daemons; nothing is started by that."""
    if shutil.which("slurmctld") and shutil.which("munged"):
        return
    begun = time.monotonic()
    command = ["apt-get", "install", "-y", "--no-install-recommends", *PACKAGES]
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    subprocess.run(command, check=True, env=environment, stdout=subprocess.DEVNULL)
    say(f"Slurm installed in {time.monotonic() - begun:.1f} s")


class Cluster:
    """Two nodes, n1 and n2, of two processors each unless another number is given."""

    def __init__(self, folder, network=False, processors=2):
        self.folder = pathlib.Path(folder).resolve()
        self.network, self.processors = network, processors
        self.spaces = {"n1": "sweep0", "n2": "sweep1"} if network else {}

    def __enter__(self):
        for name in ["state", "spool", "log", "run"]:
            (self.folder / name).mkdir(parents=True)
        if self.network:
            self.lay_cable()
        first, second = ("10.99.0.1", "10.99.0.2") if self.network else ("127.0.0.1",) * 2
        host = os.uname().nodename.split(".")[0]
        configuration = self.folder / "slurm.conf"
        configuration.write_text(
            CONFIGURATION.format(
                host=host,
                controller=first,
                folder=self.folder,
                first=first,
                second=second,
                processors=self.processors,
            )
        )
        self.environment = {**os.environ, "SLURM_CONF": str(configuration)}
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o600)
        run, log = self.folder / "run", self.folder / "log"
        begun = time.monotonic()
        self.start(
            "munged",
            "--force",
            f"--key-file={key}",
            f"--socket={run}/munge.sock",
            f"--pid-file={run}/munged.pid",
            f"--log-file={log}/munged.log",
            f"--seed-file={run}/munge.seed",
        )
        # A relative path here would start the daemons and hang every job.
        self.start("slurmctld", "-f", str(configuration), node="n1")
        for node in ["n1", "n2"]:
            self.start("slurmd", "-N", node, "-f", str(configuration), node=node)
        idle = lambda: "2 idle" in self.client("sinfo", "-h", "-o", "%D %t", check=False)
        wait_until(idle, 60, "two idle nodes")
        say(f"cluster of two nodes: {time.monotonic() - begun:.1f} s")
        return self

    def __exit__(self, *_):
        for pid in self.payloads("n1") | self.payloads("n2"):
            kill(pid)
        for file in (self.folder / "run").glob("*.pid"):
            with contextlib.suppress(ValueError):
                kill(int(file.read_text()))
        for space in self.spaces.values():
            subprocess.run(["ip", "netns", "delete", space], check=False)

    def lay_cable(self):
        for space in self.spaces.values():
            subprocess.run(["ip", "netns", "delete", space], check=False, capture_output=True)
            ip("netns", "add", space)
        ip("-n", "sweep0", "link", "add", "veth0", "type", "veth", "peer", "name", "veth1", "netns", "sweep1")
        for number, space in enumerate(["sweep0", "sweep1"]):
            ip("-n", space, "addr", "add", f"10.99.0.{number + 1}/24", "dev", f"veth{number}")
            ip("-n", space, "link", "set", "lo", "up")
            ip("-n", space, "link", "set", f"veth{number}", "up")

    def cable(self, state):
        """Pulls the cable (`down`) or puts it back (`up`)."""
        ip("-n", "sweep1", "link", "set", "veth1", state)

    def inside(self, node, arguments):
        space = self.spaces.get(node)
        # `ip netns exec` would hide the control groups that slurmd looks for.
        return (["nsenter", f"--net=/run/netns/{space}"] if space else []) + list(arguments)

    def start(self, *arguments, node=None):
        subprocess.run(self.inside(node, arguments), check=True, env=self.environment)

    def client(self, *arguments, check=True):
        """What a command prints that a user gives on the first node."""
        done = subprocess.run(
            self.inside("n1", arguments), env=self.environment, capture_output=True, text=True
        )
        expect(done.returncode == 0 or not check, f"{arguments}: {done.stdout}{done.stderr}")
        return done.stdout

    def payloads(self, node):
        """Processes of jobs on `node`, and the daemons that watch over each."""
        found = set()
        for process in pathlib.Path("/proc").glob("[0-9]*"):
            with contextlib.suppress(OSError):
                variables = (process / "environ").read_bytes().split(b"\0")
                ours = f"SLURM_CONF={self.folder}/slurm.conf".encode() in variables
                if ours and f"SLURMD_NODENAME={node}".encode() in variables:
                    found.add(int(process.name))
        parents = set()
        for pid in found:
            with contextlib.suppress(OSError):
                parent = int(pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")")[-1].split()[1])
                name = pathlib.Path(f"/proc/{parent}/comm").read_text().strip()
                if name == "slurmstepd":
                    parents.add(parent)
        return found | parents

    def crash(self, node):
        """Everything on `node` ends at once."""
        kill(int((self.folder / "run" / f"slurmd.{node}.pid").read_text()))
        pids = self.payloads(node)
        for pid in pids:
            kill(pid)
        return len(pids)

    def end_tasks(self, node):
        """The tasks on `node` end, the scripts before what they run; the node stays."""
        pids = {}
        for pid in self.payloads(node):
            with contextlib.suppress(OSError):
                pids[pid] = pathlib.Path(f"/proc/{pid}/comm").read_text().strip()
        ended = [pid for pid, name in pids.items() if name != "slurmstepd"]
        for pid in sorted(ended, key=lambda pid: pids[pid] != "slurm_script"):
            kill(pid)
        return len(ended)

    def hurry(self):
        """Tasks that were queued again wait for two minutes; not here."""
        for line in self.client("squeue", "-h", "-r", "-t", "PD", "-o", "%i %r").splitlines():
            job, reason = line.split(maxsplit=1)
            if reason == "BeginTime":
                self.client("scontrol", "update", f"jobid={job}", "starttime=now", check=False)


def ip(*arguments):
    subprocess.run(["ip", *arguments], check=True)


def kill(pid):
    with contextlib.suppress(ProcessLookupError):
        os.kill(pid, signal.SIGKILL)
