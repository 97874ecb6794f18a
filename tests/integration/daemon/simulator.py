# A simulated device of scansim, as a process beside the daemon.
# SPDX-License-Identifier: Apache-2.0
"""Needs SCANSIM (path of the simulator)."""
import os
import re
import signal
import subprocess
import time

SIMULATOR = os.environ["SCANSIM"]


class Simulator:
    """`scansim DEVICE ...`; on TCP it takes a free port."""

    def __init__(self, test, device, *options, tcp=True):
        command = [SIMULATOR, device, *map(str, options)]
        if tcp:
            command += ["--tcp", "127.0.0.1:0"]
        self.process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        test.addCleanup(self.stop)
        self.where = self._heading()

    def _heading(self):
        line = self.process.stderr.readline()
        found = re.search(r" on (?:tcp )?(\S+)", line)
        if not found:
            raise AssertionError(f"the simulator did not start: {line}")
        return found.group(1)

    def stop(self):
        """Messages sent and dropped."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        _, text = self.process.communicate(timeout=30)
        found = re.search(r"(\d+) messages sent, (\d+) dropped", text or "")
        return tuple(map(int, found.groups())) if found else (0, 0)


def read_xyz(text):
    """Scan lines as lists of points in thousandths; blank rows part lines."""
    lines = [[]]
    for row in text.splitlines():
        if row.startswith("#"):
            continue
        if row.strip():
            lines[-1].append(tuple(round(float(v) * 1000) for v in row.split()))
        elif lines[-1]:
            lines.append([])
    return [line for line in lines if line]


def cpu_seconds(pid):
    with open(f"/proc/{pid}/stat") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def descriptors(pid):
    return len(os.listdir(f"/proc/{pid}/fd"))


def memory_kib(pid):
    with open(f"/proc/{pid}/status") as file:
        return int(re.search(r"VmRSS:\s+(\d+)", file.read()).group(1))


def wait_for(condition, what, seconds=60):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        result = condition()
        if result:
            return result
        time.sleep(0.01)
    raise AssertionError(f"never: {what}")
