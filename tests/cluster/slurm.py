"""A Slurm cluster of one machine: munged, slurmctld and slurmd as this user, below one folder."""

import os
import shutil
import subprocess
import time
from pathlib import Path

from harness import free_port, wait_until

CONF = """
ClusterName=reef
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
SlurmctldPort={controller}
SlurmdPort={daemon}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
MpiDefault=none
ReturnToService=2
SchedulerType=sched/builtin
SchedulerParameters=sched_interval=2
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


class Slurm:
    """Runs until it is stopped."""

    NEEDED = ("slurmctld", "slurmd", "munged", "sbatch")

    @classmethod
    def missing(cls):
        """Programs that are not installed."""
        return [name for name in cls.NEEDED if not shutil.which(name) and not Path("/usr/sbin", name).exists()]

    def __init__(self, folder):
        self.folder, self.processes = folder, []
        for name in ("state", "spool"):
            (folder / name).mkdir()
        key = folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        folder.chmod(0o755)
        facts = {"host": os.uname().nodename, "user": "root", "cpus": os.cpu_count(), "folder": folder}
        conf = folder / "slurm.conf"
        conf.write_text(CONF.format(controller=free_port(), daemon=free_port(), **facts))
        os.environ["SLURM_CONF"] = str(conf)
        files = [f"--{name}={folder}/munge.{end}" for name, end in (("socket", "socket"), ("pid-file", "pid"))]
        files += [f"--log-file={folder}/munge.log", f"--seed-file={folder}/munge.seed", f"--key-file={key}", "--force"]
        self.start("munged", "--foreground", *files)
        wait_until((folder / "munge.socket").exists, "munged listens")
        self.start("slurmctld", "-D")
        self.start("slurmd", "-D", "-N", facts["host"])
        wait_until(self.is_idle, "the node is idle")

    def start(self, program, *options):
        path = shutil.which(program) or f"/usr/sbin/{program}"
        with open(self.folder / f"{program}.out", "w") as output:
            self.processes.append(subprocess.Popen([path, *options], stdout=output, stderr=output))

    def is_idle(self):
        dead = [process.args[0] for process in self.processes if process.poll() is not None]
        assert not dead, f"{dead} ended; see {self.folder}"
        time.sleep(0.2)
        shown = subprocess.run(["sinfo", "--noheader", "--format=%T"], capture_output=True, text=True, check=False)
        return shown.stdout.strip() == "idle"

    def stop(self):
        """Ends the daemons."""
        for process in reversed(self.processes):
            process.terminate()
            process.wait()
