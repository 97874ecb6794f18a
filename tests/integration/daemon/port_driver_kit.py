# What the tests of drivers on simulated devices share.
# SPDX-License-Identifier: Apache-2.0
import os
import subprocess

from harness import TOOL, DaemonTest, Daemon
from simulator import read_xyz

LONG = os.environ.get("SCANSION_LONG") == "1"


def exported(path):
    """Scan lines of a recording as lists of points in thousandths."""
    result = subprocess.run([TOOL, "export", path, "--format", "xyz", "-o", "-"], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    return read_xyz(result.stdout)


def recordings(daemon):
    """Without the raw bytes that lie beside them."""
    return [path for path in daemon.files() if path.endswith(".mcap")]


class PortDriverTest(DaemonTest):
    def difference(self, got, want):
        """The first line that differs; assertEqual of long lists takes hours."""
        self.assertEqual(len(got), len(want), "lines")
        at = next((i for i, (a, b) in enumerate(zip(got, want)) if a != b), None)
        if at is not None:
            point = next((p for p in zip(got[at], want[at]) if p[0] != p[1]), (got[at][-1:], want[at][-1:]))
            self.fail(f"line {at}: {len(got[at])} points for {len(want[at])}, {point[0]} instead of {point[1]}")

    def record(self, device, lines, raw=True):
        """Runs the daemon until so many lines are written; the recording's path."""
        if raw:
            device = dict(device, raw=os.path.join(self.folder, "d.raw"))
        daemon = self.daemon([device]).start()
        status = daemon.until_written(lines)
        daemon.stop(self)
        (path,) = recordings(daemon)
        self.check_sound(path)
        return path, status

    def check_transcript(self, device, path, lines):
        """The raw transcript gives the same recording bytes."""
        again = {k: v for k, v in device.items() if k not in ("tcp", "udp", "port", "file", "raw")}
        again["transcript"] = os.path.join(self.folder, "d.raw")
        daemon = Daemon(self.folder, [again], directory=os.path.join(self.folder, "again"))
        self.addCleanup(daemon.kill)
        daemon.start()
        daemon.until_written(lines)
        daemon.until_state("finished")
        daemon.stop(self)
        (copy,) = recordings(daemon)
        with open(path, "rb") as a, open(copy, "rb") as b:
            self.assertTrue(a.read() == b.read(), "the transcript gives other bytes")

    def check_counters(self, status):
        link = status["link"]
        self.assertEqual(link["frames"], link["accepted"] + sum(link["rejected"].values()))
        return link
