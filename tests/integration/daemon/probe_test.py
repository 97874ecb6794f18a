# A touch probe from end to end: scansim grbl -> scansiond -> recording, with everything that goes wrong on the way.
# SPDX-License-Identifier: Apache-2.0
"""Needs SCANSIOND, SCANSION and SCANSIM. SCANSION_LONG=1: 200 unplugs instead of 4, and a raster at the speed of a real machine."""
import json
import os
import random
import re
import subprocess
import time
import unittest

from harness import PATIENCE
from port_driver_kit import LONG, PortDriverTest, recordings
from simulator import cpu_seconds, descriptors, memory_kib

SIMULATOR = os.environ["SCANSIM"]
TOOL = os.environ["SCANSION"]
STEP = 0.004  # mm, one step of the simulated machine
AREA = {"x_from": 0.0, "x_to": 20.0, "y_from": 0.0, "y_to": 10.0, "pitch": 2.5, "spacing": 2.5, "top": -0.5, "bottom": -9.0}


def write_part(path, rows=5, columns=9):
    """A stepped part on the raster's grid; returns the heights by place."""
    heights = {}
    rng = random.Random(5)
    with open(path, "w") as out:
        for row in range(rows):
            for column in range(columns):
                x, y = column * 2.5, row * 2.5
                z = round((-2.0 if 6 < x < 14 else -3.5) + rng.randrange(-200, 200) / 1000, 3)
                heights[(x, y)] = z
                out.write(f"{x:.3f} {y:.3f} {z:.3f}\n")
            out.write("\n")
    return heights


class ProbeTest(PortDriverTest):
    def setUp(self):
        super().setUp()
        self.part = os.path.join(self.folder, "part.xyz")
        self.heights = write_part(self.part)
        self.link = os.path.join(self.folder, "machine")

    def simulate(self, *options, speed=None, port=None):
        port = port or ["--pty", self.link]
        fast = [f"{x}={v}" for x, v in ((110, 3000), (111, 3000), (112, 3000), (120, 400), (121, 400), (122, 400))]
        settings = [part for one in fast for part in ("--set", one)]
        rate = ["--speed", str(speed)] if speed else ["--rate", "max"]
        log = open(os.path.join(self.folder, "sim.txt"), "a")
        self.addCleanup(log.close)
        sim = subprocess.Popen([SIMULATOR, "grbl", "--scan", self.part, *port, *rate, *settings, *options], stderr=log)

        def end():
            if sim.poll() is None:
                sim.terminate()
                sim.wait()

        self.addCleanup(end)
        if port[0] == "--pty":
            deadline = time.monotonic() + PATIENCE
            while not os.path.exists(self.link) and time.monotonic() < deadline:
                time.sleep(0.01)
        return sim

    def probe(self, **options):
        return {"name": "d", "driver": "grbl-probe", "port": self.link, "feed": 300.0, **AREA, **options}

    def points(self, path):
        done = subprocess.run([TOOL, "export", path, "--format", "xyz", "-o", "-"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return [tuple(map(float, row.split())) for row in done.stdout.splitlines() if row.strip() and row[0] != "#"]

    def check_whole(self, path):
        """Every place of the grid once, at most one step below the part."""
        points = self.points(path)
        self.assertEqual(sorted((x, y) for x, y, _ in points), sorted(self.heights))
        for x, y, z in points:
            self.check_height(x, y, z)

    def check_height(self, x, y, z):
        self.assertLessEqual(z, self.heights[(x, y)] + 0.0006, (x, y))
        self.assertGreater(z, self.heights[(x, y)] - STEP - 0.0006, (x, y))

    def order(self, verb, *more):
        return subprocess.run([TOOL, verb, "d", "--socket", self.running.socket, *more], capture_output=True, text=True)

    def run_daemon(self, *devices):
        self.running = self.daemon(list(devices))
        return self.running.start()


class Raster(ProbeTest):
    def test_at_maximum_speed_and_its_transcript(self):
        for where in ({"port": self.link}, {"tcp": "127.0.0.1:47124"}):
            with self.subTest(**where):
                self.setUp()
                tcp = where.get("tcp")
                self.simulate(port=["--tcp", tcp] if tcp else None)
                device = {k: v for k, v in self.probe().items() if k != "port" or not tcp}
                device.update({"tcp": tcp} if tcp else {})
                path, _ = self.record(device, 5)
                self.check_whole(path)
                self.check_transcript(device, path, 5)

    @unittest.skipUnless(LONG, "takes minutes: SCANSION_LONG=1")
    def test_at_the_speed_of_a_real_machine(self):
        rows, columns = 13, 21
        self.heights = write_part(self.part, rows, columns)
        self.simulate(speed=1)
        device = self.probe(x_to=(columns - 1) * 2.5, y_to=(rows - 1) * 2.5)
        begin = time.monotonic()
        daemon = self.run_daemon(dict(device, raw=self.raw_path()))
        for row in range(rows):  # each row has a minute
            daemon.until(lambda: (d := daemon.device())["lines"] > row or d["state"] == "finished", f"row {row}")
        daemon.until_state("finished")
        print(f"{rows * columns} points at a real machine's speed in {time.monotonic() - begin:.0f} s, {daemon.device()['link']}")
        daemon.stop(self)
        (path,) = recordings(daemon)
        self.check_sound(path)
        self.check_whole(path)
        self.check_transcript(device, path, rows)

    def test_at_the_machines_own_speed_over_tcp(self):
        # Twenty times a real machine, so that acceleration, overshoot and Run are all there but the test is short.
        self.simulate(speed=20, port=["--tcp", "127.0.0.1:47123"])
        device = self.probe(tcp="127.0.0.1:47123")
        del device["port"]
        daemon = self.run_daemon(device)
        daemon.until_state("finished")
        daemon.stop(self)
        self.check_whole(daemon.files()[0])

    def test_grblhal(self):
        self.simulate("--dialect", "grblhal")
        daemon = self.run_daemon(self.probe())
        daemon.until_state("finished")
        daemon.stop(self)
        self.check_whole(daemon.files()[0])

    def test_machine_comes_later(self):
        daemon = self.run_daemon(self.probe())
        daemon.until_state("backing off")
        self.simulate()
        daemon.until_state("finished")
        daemon.stop(self)
        self.check_whole(daemon.files()[0])


class Stops(ProbeTest):
    def moving(self, **options):
        self.simulate(speed=10)
        daemon = self.run_daemon(self.probe(**options))
        daemon.until(lambda: daemon.device()["lines"] >= 1, "a row is done")
        return daemon

    def test_stop_holds_and_start_goes_on(self):
        daemon = self.moving()
        done = self.order("stop")
        self.assertEqual((done.returncode, done.stdout), (0, "d: held\n"), done.stderr)
        lines = daemon.device()["lines"]
        time.sleep(1.0)
        self.assertEqual(daemon.device()["state"], "held")
        self.assertEqual(daemon.device()["lines"], lines)
        self.assertEqual(self.order("start").returncode, 0)
        daemon.until_state("finished")
        daemon.stop(self)
        self.check_whole(daemon.files()[0])

    def test_release_lets_go_of_the_port(self):
        daemon = self.moving()
        done = self.order("stop", "--release")
        self.assertEqual((done.returncode, done.stdout), (0, "d: stopped\n"), done.stderr)
        self.assertIn("home it", daemon.device()["error"])
        self.assertNotEqual(self.order("stop", "--release").returncode, 2)
        daemon.stop(self)

    def test_sigterm_holds_before_the_reset(self):
        raw = os.path.join(self.folder, "machine.raw")
        daemon = self.moving(raw=raw)
        daemon.stop(self)
        with open(raw) as file:
            sent = [line.split(" ", 3)[3] for line in file if line.startswith(">")]
        hold = next(i for i, text in enumerate(sent) if "!" in text)
        reset = next(i for i, text in enumerate(sent) if "\\x18" in text)
        self.assertLess(hold, reset)

    def test_unknown_device(self):
        daemon = self.run_daemon()
        done = self.order("stop")
        self.assertEqual(done.returncode, 69)
        self.assertIn('no device "d"', done.stderr)
        daemon.stop(self)


class Resume(ProbeTest):
    def test_killed_daemon_goes_on_from_its_recording(self):
        self.simulate(speed=10, port=["--pty", self.link])
        device = self.probe(resume=True)
        daemon = self.run_daemon(device)
        daemon.until_written(2)
        daemon.kill()
        first = len(daemon.files())
        daemon.start()
        daemon.until_state("finished")
        daemon.stop(self)
        self.assertIn("of an earlier run", daemon.log_text())
        self.assertEqual(len(daemon.files()), first + 1)
        self.check_whole([path for path in daemon.files() if path.endswith(".mcap")][-1])
        # Rows of before were not probed again.
        self.assertEqual(daemon.log_text().count("lines of an earlier run"), 1)

    def test_killed_again_while_it_repeats_rows(self):
        """However little of the rows of before a run had recorded again: none is probed twice."""
        rows, columns = 40, 5
        self.heights = write_part(self.part, rows, columns)
        self.simulate(speed=20)
        device = self.probe(x_to=(columns - 1) * 2.5, y_to=(rows - 1) * 2.5, resume=True)
        self.running = daemon = self.daemon([device], recording="group_ms = 20").start()  # a row a group
        daemon.until_written(20)
        daemon.kill()
        rng = random.Random(9)
        for _ in range(6):
            begun = daemon.log_text().count("recording into")
            daemon.start(wait=False)
            daemon.until(lambda: daemon.log_text().count("recording into") > begun, "rows of before are recorded again")
            time.sleep(rng.uniform(0, 0.05))
            daemon.kill()
        daemon.start()
        daemon.until_state("finished")
        daemon.stop(self)
        found = [int(n) for n in re.findall(r"holds (\d+) lines of an earlier run", daemon.log_text())]
        self.assertEqual(len(found), 7)
        self.assertGreaterEqual(found[0], 20)
        self.assertEqual(found, sorted(found))
        self.check_whole(recordings(daemon)[-1])

    def test_unplugged_at_random_moments(self):
        """The controller has its own supply and is not reset by the port: the raster goes on where it was."""
        turns = 200 if LONG else 4
        rows = 400 if LONG else 12
        self.heights = write_part(self.part, rows=rows)
        self.simulate("--keeps-power", "--set", "131=1100", "--seed", "7", "--fault", "unplug:at=1.5,for=0.7,every=3,jitter=0.3", speed=10)
        daemon = self.run_daemon(self.probe(y_to=(rows - 1) * 2.5))
        pid = daemon.process.pid
        slowest = {"gone": 0.0, "back": 0.0, "going": 0.0, "cpu": 0.0}
        begin, held = None, []
        for turn in range(turns):
            daemon.until_state("streaming")
            daemon.until(lambda: not os.path.islink(self.link), "unplugged")
            gone = time.monotonic()
            daemon.until(lambda: daemon.device()["state"] != "streaming", "the loss is noticed")
            slowest["gone"] = max(slowest["gone"], time.monotonic() - gone)
            used, since = cpu_seconds(pid), time.monotonic()
            daemon.until(lambda: os.path.islink(self.link), "plugged in")
            back = time.monotonic()
            held.append(descriptors(pid))  # neither port nor recording
            slowest["cpu"] = max(slowest["cpu"], (cpu_seconds(pid) - used) / (back - since))
            daemon.until(lambda: daemon.device()["state"] in ("starting", "streaming"), "the port is open")
            slowest["back"] = max(slowest["back"], time.monotonic() - back)
            daemon.until_state("streaming")  # not before the machine has ended what it was doing
            slowest["going"] = max(slowest["going"], time.monotonic() - back)
            if turn == 1:
                begin = memory_kib(pid)
        end = memory_kib(pid)
        daemon.stop(self)
        print(f"slowest of {turns}: noticed {slowest['gone'] * 1000:.0f} ms, open {slowest['back'] * 1000:.0f} ms and going on "
              f"{slowest['going'] * 1000:.0f} ms after it was back, CPU while gone {slowest['cpu'] * 100:.1f} %; rss {begin} -> {end} kB, descriptors {held[0]} -> {held[-1]}")
        self.assertLess(slowest["gone"], 1.0)
        self.assertLess(slowest["back"], 2.0)
        self.assertLess(slowest["cpu"], 0.05)
        self.assertLessEqual(held[-1], held[0] + 1)
        if LONG:
            self.assertLess(end, begin * 1.2 + 4096)
        self.check_rows_of(recordings(daemon), turns)

    def check_rows_of(self, paths, turns):
        """Each loss ends a file. A row that was in work is its gap; the next file has all rows of before again, and goes on."""
        self.assertEqual(len(paths), turns + 1)
        done, interrupted = 0, 0
        for path in paths:
            self.check_sound(path)
            info = json.loads(subprocess.run([TOOL, "info", "--json", path], capture_output=True, text=True).stdout)
            gaps = [(gap["first"], gap["count"]) for gap in info["gap_list"]]
            self.assertIn(gaps, ([], [(info["lines"], 1)]), path)
            if path != paths[-1]:  # stopped at once, it may still have been at the rows of before
                self.assertGreaterEqual(info["lines"], done, path)
            done, interrupted = max(done, info["lines"]), interrupted + len(gaps)
            points = self.points(path)
            self.assertEqual(len(points), info["lines"] * 9)
            for at, (x, y, z) in enumerate(points):
                self.assertEqual((x, y), (at % 9 * 2.5, at // 9 * 2.5), path)
                self.check_height(x, y, z)
        self.assertGreater(done, turns // 4, "rows are done between the losses")
        self.assertGreater(interrupted, turns // 4, "rows are interrupted")

    def test_lost_position_needs_a_person(self):
        raw = os.path.join(self.folder, "machine.raw")
        self.simulate("--fault", "banner:at=2.5,for=1", speed=10)
        daemon = self.run_daemon(self.probe(raw=raw))
        device = daemon.until_state("closed")
        self.assertIn("position is lost", device["error"])
        time.sleep(1.0)
        self.assertEqual(daemon.device()["state"], "closed")
        with open(raw) as file:
            sent = "".join(line.split(" ", 3)[3] for line in file if line.startswith(">"))
        self.assertNotIn("$X", sent)
        self.assertNotIn("$H", sent)
        # By command it tries again, and sees by itself that the controller forgot where it is.
        self.assertEqual(self.order("start").returncode, 0)
        device = daemon.until(lambda: (d := daemon.device())["state"] == "closed" and "$22" in (d["error"] or "") and d, "refused")
        daemon.stop(self)

    def test_locked_machine_is_not_unlocked(self):
        raw = os.path.join(self.folder, "machine.raw")
        self.simulate("--set", "22=1")
        daemon = self.run_daemon(self.probe(raw=raw))
        device = daemon.until_state("closed")
        self.assertIn("home it", device["error"])
        daemon.stop(self)
        with open(raw) as file:
            self.assertNotIn("$X", file.read().replace("$H'|'$X'", ""))


if __name__ == "__main__":
    unittest.main(verbosity=2)
