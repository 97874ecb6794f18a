# What the tests of drivers on simulated devices share.
# SPDX-License-Identifier: Apache-2.0
import json
import os
import subprocess
import time

from harness import TOOL, DaemonTest, Daemon, Recording
from simulator import cpu_seconds, descriptors, memory_kib, read_xyz

LONG = os.environ.get("SCANSION_LONG") == "1"


def exported(path):
    """Scan lines of a recording as lists of points in thousandths."""
    result = subprocess.run([TOOL, "export", path, "--format", "xyz", "-o", "-"], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    return read_xyz(result.stdout)


def recordings(daemon):
    """Without the raw bytes that lie beside them."""
    return [path for path in daemon.files() if path.endswith(".mcap")]


def gaps_of(path):
    """(first, count) of each gap; count None: unknown."""
    result = subprocess.run([TOOL, "info", "--json", path], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    info = json.loads(result.stdout)
    assert info["gaps"] == len(info["gap_list"])
    return [(gap["first"], gap["count"]) for gap in info["gap_list"]]


def listens(address):
    """Whether anybody takes connections there; asking so takes no connection away."""
    port = f":{int(address.rsplit(':', 1)[1]):04X}"
    with open("/proc/net/tcp") as table:
        return any(row.split()[1].endswith(port) and row.split()[3] == "0A" for row in table)


class Watched:
    """A daemon over many losses of its device: how soon they were noticed and healed, and what that cost."""

    def __init__(self, daemon, is_there):
        self.daemon, self.is_there = daemon, is_there
        self.noticed = self.back = 0.0
        self.away_cpu = self.away_s = 0.0
        self.begin = self.end = None  # memory, KiB
        self.held = []  # descriptors, whenever the device comes back: streaming opens and closes others

    def use(self):
        return memory_kib(self.daemon.process.pid)

    def is_streaming(self):
        return self.daemon.device()["state"] == "streaming"

    def run(self, cycles):
        for cycle in range(cycles):
            self.daemon.until(self.is_streaming, "lines come")
            if cycle == min(10, cycles - 1):
                self.begin = self.use()
            self.daemon.until(lambda: not self.is_there(), "unplugged")
            gone = time.monotonic()
            self.daemon.until(lambda: not self.is_streaming(), "the loss is noticed")
            self.noticed = max(self.noticed, time.monotonic() - gone)
            cpu, since = cpu_seconds(self.daemon.process.pid), time.monotonic()
            while not self.is_there():
                time.sleep(0.005)
            returned = time.monotonic()
            self.held.append(descriptors(self.daemon.process.pid))
            self.away_cpu += cpu_seconds(self.daemon.process.pid) - cpu
            self.away_s += returned - since
            self.daemon.until(self.is_streaming, "back")
            self.back = max(self.back, time.monotonic() - returned)
        lines = self.daemon.device()["lines"]
        self.daemon.until(lambda: self.daemon.device()["lines"] > lines, "lines of the last run")
        self.end = self.use()

    def check(self, test, cycles):
        test.assertLess(self.noticed, 1.0)
        test.assertLess(self.back, 2.0)
        test.assertLessEqual(self.held[-1], self.held[0] + 1, "descriptors")
        test.assertLess(self.end, self.begin * 1.1 + 4096, "memory")
        if cycles >= 20:
            test.assertLess(self.away_cpu / self.away_s, 0.05, "processor time while gone")
        print(f"{cycles} losses: noticed within {self.noticed * 1000:.0f} ms, back within {self.back * 1000:.0f} ms, "
              f"{100 * self.away_cpu / self.away_s:.1f} % CPU in {self.away_s:.0f} s while gone, "
              f"descriptors {self.held[0]} -> {self.held[-1]}, rss {self.begin} -> {self.end} KiB", flush=True)


class PortDriverTest(DaemonTest):
    def difference(self, got, want):
        """The first line that differs; assertEqual of long lists takes hours."""
        self.assertEqual(len(got), len(want), "lines")
        at = next((i for i, (a, b) in enumerate(zip(got, want)) if a != b), None)
        if at is not None:
            point = next((p for p in zip(got[at], want[at]) if p[0] != p[1]), (got[at][-1:], want[at][-1:]))
            self.fail(f"line {at}: {len(got[at])} points for {len(want[at])}, {point[0]} instead of {point[1]}")

    def raw_path(self):
        return os.path.join(self.folder, "d.raw")

    def record(self, device, lines):
        """Runs the daemon until so many lines are written; the recording's path."""
        daemon = self.daemon([dict(device, raw=self.raw_path())]).start()
        status = daemon.until_written(lines)
        daemon.stop(self)
        (path,) = recordings(daemon)
        self.check_sound(path)
        return path, status

    def check_transcript(self, device, path, lines):
        """The raw transcript gives the same recording bytes."""
        again = {k: v for k, v in device.items() if k not in ("tcp", "udp", "port", "file", "raw")}
        again["transcript"] = self.raw_path()
        daemon = Daemon(self.folder, [again], directory=os.path.join(self.folder, "again"))
        self.addCleanup(daemon.kill)
        daemon.start()
        daemon.until_written(lines)
        daemon.until_state("finished")
        daemon.stop(self)
        (copy,) = recordings(daemon)
        self.assertEqual(os.path.basename(path), os.path.basename(copy))
        with open(path, "rb") as a, open(copy, "rb") as b:
            self.assertTrue(a.read() == b.read(), "the transcript gives other bytes")

    def check_known_gaps(self, daemon, want, rate, pitch):
        """Every line after a loss stands where the gap says, and is the line that the device sent there. `want`: the lines the
        device goes through again and again; `pitch`: way from line to line in thousandths."""
        place, sizes = None, []
        for path in recordings(daemon):
            self.check_sound(path)
            gaps = gaps_of(path)
            first = Recording(path).groups[0][1]
            lines = exported(path)
            ys = [line[0][1] for line in lines]
            self.assertEqual(ys, list(range(ys[0], ys[0] + pitch * len(ys), pitch)))
            number = ys[0] // pitch
            if place is None:
                self.assertEqual((gaps, first), ([], 0))
            else:
                lost = number - place - 1
                self.assertEqual(gaps, [(0, lost)] if lost else [])
                self.assertEqual(first, lost)
                sizes.append(lost)
            for i, line in enumerate(lines):
                self.assertEqual([(x, z) for x, _, z in line], [(x, z) for x, _, z in want[(number + i) % len(want)]], path)
            place = number + len(lines) - 1
        print(f"{len(sizes)} gaps of {min(sizes)} to {max(sizes)} lines ({min(sizes) / rate:.2f} to {max(sizes) / rate:.2f} s), "
              "each of the right size", flush=True)
        return sizes

    def check_counters(self, status):
        link = status["link"]
        self.assertEqual(link["frames"], link["accepted"] + sum(link["rejected"].values()))
        return link
