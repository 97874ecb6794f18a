# Hokuyo scanners: simulator -> daemon -> recording, on a pseudo terminal and on TCP, undisturbed and disturbed.
# SPDX-License-Identifier: Apache-2.0
"""Needs SCANSIOND, SCANSION and SCANSIM. SCANSION_LONG=1: 200 unplugs instead of 4, more noise."""
import datetime
import json
import math
import os
import signal
import subprocess
import termios
import time
import unittest

from harness import Recording, TOOL
from port_driver_kit import PortDriverTest, Watched
from simulator import cpu_seconds

SIM = os.environ.get("SCANSIM")
LONG = os.environ.get("SCANSION_LONG") == "1"
STANDOFF = 300.0


class Simulator:
    """scansim scip, on a link or a TCP port of its own."""

    def __init__(self, test, scan, *options, tcp=False):
        self.link = os.path.join(test.folder, "tty")
        where = ["--tcp", "127.0.0.1:0"] if tcp else ["--pty", self.link]
        self.log = open(os.path.join(test.folder, "sim.txt"), "a+")
        self.process = subprocess.Popen([SIM, "scip", "--scan", scan, *where, *options], stderr=subprocess.PIPE, text=True)
        line = self.process.stderr.readline()  # "scansim: scip on tcp 127.0.0.1:PORT"
        test.assertIn("scip on", line)
        self.address = line.split()[-1] if tcp else None
        test.addCleanup(self.stop)

    def device(self, **options):
        way = {"tcp": self.address} if self.address else {"port": self.link}
        return {"name": "d", "driver": "hokuyo-scip", **way, **options}

    def stop(self):
        if self.process.poll() is None:
            self.process.terminate()
            self.process.wait(10)
        self.process.stderr.close()
        self.log.close()


def part(lines):
    """A bump that moves: what a plate with it looks like, and the distances a sensor over its middle must see."""
    scan = []
    for line in range(lines):
        centre = -80.0 + 160.0 * line / max(1, lines - 1)
        scan.append([(-100.0, 0.0), (centre - 15.0, 0.0), (centre, 12.0), (centre + 15.0, 0.0), (100.0, 0.0)])
    return scan


def seen(profile, top=12.0):
    """By hand and apart from the simulator: for each step the nearest crossing of its ray with the profile, whole mm."""
    out = {}
    for step in range(1081):
        angle = 2 * math.pi * (step - 540) / 1440
        sine, cosine = math.sin(angle), math.cos(angle)
        if cosine <= 1e-9:
            continue
        best = None
        for (x1, z1), (x2, z2) in zip(profile, profile[1:]):
            # x = r sin, z = H - r cos on the line from 1 to 2.
            denominator = sine * (z2 - z1) + cosine * (x2 - x1)
            if abs(denominator) < 1e-12:
                continue
            height = top + STANDOFF
            r = ((x1 * (z2 - z1)) + (height - z1) * (x2 - x1)) / denominator
            x = r * sine
            if r > 0 and min(x1, x2) - 1e-9 <= x <= max(x1, x2) + 1e-9:
                best = r if best is None else min(best, r)
        if best is not None:
            out[step] = best
    return out


class ScipTest(PortDriverTest):
    def setUp(self):
        super().setUp()
        if not (SIM and TOOL):
            self.skipTest("SCANSIM and SCANSION are not given")

    def write_part(self, lines):
        path = os.path.join(self.folder, "part.xyz")
        with open(path, "w") as file:
            for number, profile in enumerate(part(lines)):
                file.write("".join(f"{x:.3f} {number} {z:.3f}\n" for x, z in profile) + "\n")
        return path

    def points(self, path):
        result = subprocess.run([TOOL, "export", path, "--format", "xyz", "-o", "-"], capture_output=True, text=True, check=True)
        lines = []
        for block in result.stdout.split("\n\n"):
            rows = [tuple(map(float, row.split())) for row in block.splitlines() if row and not row.startswith("#")]
            if rows:
                lines.append(rows)
        return lines

    def info(self, path):
        return json.loads(subprocess.run([TOOL, "info", path, "--json"], capture_output=True, text=True, check=True).stdout)

    def check_profile(self, rows, profile):
        """Every step's range is the profile's, to the half millimetre that the sensor rounds away (and the micrometre of the file)."""
        want = seen(profile)
        got = {}
        for x, _, z in rows:
            r = math.hypot(x, z)
            step = round(540 + math.atan2(x, -z) / (2 * math.pi) * 1440)
            self.assertAlmostEqual(r, round(r), delta=0.011, msg="a whole number of millimetres")
            got[step] = round(r)
        edge = {min(want), max(want)}
        self.assertEqual(set(got) - edge, set(want) - edge)
        for step, r in got.items():
            if step in want:
                self.assertLessEqual(abs(r - want[step]), 0.501, f"step {step}")

    def run_whole(self, tcp, rate, lines):
        scan = self.write_part(lines)
        sim = Simulator(self, scan, "--rate", rate, tcp=tcp)
        device = sim.device(spacing=1.0)
        path, _ = self.record(device, lines)
        recorded = self.points(path)
        self.assertEqual(len(recorded), lines)
        self.assertEqual(self.info(path)["gaps"], 0)
        for number, (rows, profile) in enumerate(zip(recorded, part(lines))):
            self.assertTrue(all(abs(y - number) < 1e-6 for _, y, _ in rows))
            self.check_profile(rows, profile)
        self.check_transcript(device, path, lines)

    def test_everything_arrives_at_the_device_rate(self):
        for tcp in (False, True):
            with self.subTest(tcp=tcp):
                self.setUp()
                self.run_whole(tcp, "40", 60)

    def test_everything_arrives_at_maximum_speed(self):
        for tcp in (False, True):
            with self.subTest(tcp=tcp):
                self.setUp()
                self.run_whole(tcp, "max", 1000)

    def test_noise_is_refused_and_counted(self):
        scan = self.write_part(40)
        for rate in ("1e-4", "1e-3") + (("3e-3",) if LONG else ()):
            with self.subTest(rate=rate):
                self.setUp()
                scan = self.write_part(40)
                sim = Simulator(self, scan, "--rate", "400", "--loop", "--fault", f"flip:at=1,rate={rate}", "--fault",
                                f"drop:at=1,rate={rate}", "--fault", "duplicate:at=1,rate=0.01")
                daemon = self.daemon([sim.device(start=530, end=550)]).start()
                daemon.until(lambda: daemon.device()["lines"] > 1500, "1500 lines")
                link = daemon.device()["link"]
                self.assertEqual(link["frames"], link["accepted"] + sum(link["rejected"].values()))
                self.assertGreater(sum(link["rejected"].values()), 0)
                daemon.stop(self)
                allowed = [{round(r) for r in seen(p).values()} for p in part(40)]
                anything = set().union(*allowed)
                for path in daemon.files():
                    if path.endswith(".mcap"):
                        for rows in self.points(path):
                            self.assertTrue(all(round(math.hypot(x, z)) in anything for x, _, z in rows))
                sim.stop()

    def test_unplugged_again_and_again(self):
        turns = 200 if LONG else 4
        scan = self.write_part(50)
        sim = Simulator(self, scan, "--rate", "40", "--loop", "--seed", "5", "--fault",
                        "unplug:at=1.5,for=0.7,every=3,jitter=0.3")
        daemon = self.daemon([sim.device(start=500, end=580)]).start()
        watched = Watched(daemon, lambda: os.path.islink(sim.link))
        watched.run(turns)
        daemon.stop(self)
        watched.check(self, turns)
        recordings = [f for f in daemon.files() if f.endswith(".mcap")]
        self.assertGreaterEqual(len(recordings), turns)
        infos = [self.info(f) for f in recordings]
        self.assertEqual([i["gaps"] for i in infos], [0] + [1] * (len(infos) - 1))
        for before, after, path in zip(infos, infos[1:], recordings[1:]):
            away_s = (self.time_of(after["started"]) - self.time_of(before["ended"])).total_seconds()
            lost = Recording(path).groups[0][1]  # the first line's index: those before it are the gap
            self.assertLessEqual(abs(lost - (away_s / 0.025 - 1)), 1.5, f"{away_s} s away, gap of {lost}")

    def time_of(self, text):
        return datetime.datetime.fromisoformat(text.replace("Z", "+00:00"))

    def test_absent_device_costs_little_and_is_taken_when_it_comes(self):
        link = os.path.join(self.folder, "tty")
        daemon = self.daemon([{"name": "d", "driver": "hokuyo-scip", "port": link}]).start()
        daemon.until_state("backing off")
        before, begin = cpu_seconds(daemon.process.pid), time.monotonic()
        daemon.until(lambda: time.monotonic() - begin > 2.0, "two seconds")
        self.assertLess((cpu_seconds(daemon.process.pid) - before) / (time.monotonic() - begin), 0.05)
        self.assertEqual(daemon.files(), [])
        Simulator(self, self.write_part(5), "--rate", "40", "--loop")
        came = time.monotonic()
        daemon.until_state("streaming")
        self.assertLess(time.monotonic() - came, 2.0)
        daemon.stop(self)

    def test_mute_device_goes_stale_and_recovers(self):
        sim = Simulator(self, self.write_part(50), "--rate", "40", "--loop", "--fault", "mute:at=1.5,for=2.6")
        daemon = self.daemon([sim.device(start=500, end=580)]).start()
        daemon.until_state("streaming")
        daemon.until_state("stale")
        daemon.until_state("streaming")
        daemon.until(lambda: daemon.device()["gaps"] == 1, "the gap is counted")
        daemon.stop(self)
        (path,) = [f for f in daemon.files() if f.endswith(".mcap")]
        self.check_sound(path)

    def test_starts_on_a_sensor_that_measures_already_and_on_an_old_mode(self):
        for option in ("--streaming", "--scip1"):
            with self.subTest(option=option):
                self.setUp()
                sim = Simulator(self, self.write_part(5), "--rate", "40", "--loop", option)
                begin = time.monotonic()
                daemon = self.daemon([sim.device()]).start()
                daemon.until_written(10)
                self.assertLess(time.monotonic() - begin, 5.0)
                daemon.stop(self)

    def test_single_scans_where_there_is_no_continuous_measuring(self):
        sim = Simulator(self, self.write_part(50), "--rate", "20", "--loop", "--single")
        path, _ = self.record(sim.device(), 70)
        recorded = self.points(path)
        self.assertGreaterEqual(len(recorded), 70)
        first = next(k for k in range(3) if set(seen(part(50)[k])) >= set(self.steps(recorded[0])))
        missing = 0
        for number, rows in enumerate(recorded):  # y counts lost ones
            place = round(rows[0][1])
            missing = place - number
            self.check_profile(rows, part(50)[(first + place) % 50])
        self.assertLess(missing, 10, "scans are asked for often enough")
        self.check_transcript(sim.device(), path, 70)

    def steps(self, rows):
        return [round(540 + math.atan2(x, -z) / (2 * math.pi) * 1440) for x, _, z in rows]

    def test_echoes(self):
        # A shelf over a floor.
        path = os.path.join(self.folder, "shelf.xyz")
        with open(path, "w") as file:
            for y in range(5):
                file.write("".join(f"{x} {y} {z}\n" for x, z in [(-500, 0), (500, 0), (500, 200), (0, 200)]) + "\n")
        for mode, echo, heights in (("ND", "nearest", {-300, -500}), ("ND", "farthest", {-500}), ("NE", "strongest", {-300, -500})):
            with self.subTest(mode=mode, echo=echo):
                sim = Simulator(self, path, "--rate", "100", "--loop", tcp=True)
                daemon = self.daemon([sim.device(mode=mode, echo=echo, start=500, end=580)],
                                     directory=os.path.join(self.folder, mode + echo)).start()
                daemon.until_written(20)
                self.assertEqual(sum(daemon.device()["link"]["rejected"].values()), 0)
                daemon.stop(self)
                sim.stop()
                (recording,) = [f for f in daemon.files() if f.endswith(".mcap")]
                self.assertEqual({round(z / 10) * 10 for rows in self.points(recording) for _, _, z in rows}, heights)

    def test_bit_rate_is_changed(self):
        sim = Simulator(self, self.write_part(5), "--rate", "40", "--loop", "--fault", "unplug:at=1.5,for=0.3")
        daemon = self.daemon([sim.device(baud=19200, change_baud=115200)]).start()
        daemon.until_written(5)
        self.assertEqual(self.rate_of(sim.link), termios.B115200)
        daemon.until(lambda: daemon.device()["gaps"] == 1, "back after a power cycle")
        self.assertEqual(self.rate_of(sim.link), termios.B115200)
        daemon.stop(self)

    def rate_of(self, link):
        descriptor = os.open(link, os.O_RDONLY | os.O_NOCTTY | os.O_NONBLOCK)
        try:
            return termios.tcgetattr(descriptor)[5]
        finally:
            os.close(descriptor)

    def test_raw_bytes_are_dumped_on_a_signal(self):
        sim = Simulator(self, self.write_part(5), "--rate", "40", "--loop")
        daemon = self.daemon([sim.device()]).start()
        daemon.until_written(5)
        daemon.signal(signal.SIGUSR1)
        dump = os.path.join(daemon.directory, "d-dump.raw")
        daemon.until(lambda: os.path.exists(dump), "the dump is there")
        with open(dump) as file:
            text = file.read()
        self.assertTrue(text.startswith("# scansion raw transcript 1\n"))
        self.assertIn("99b\\n", text)
        daemon.stop(self)


if __name__ == "__main__":
    unittest.main(verbosity=2)
