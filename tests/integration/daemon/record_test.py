# scansion record: a device recorded without a daemon; its transcript gives the same recording.
# SPDX-License-Identifier: Apache-2.0
import json
import os
import signal
import subprocess
import unittest

from harness import TOOL
from port_driver_kit import PortDriverTest, exported
from simulator import Simulator, wait_for


class Record(PortDriverTest):
    def path(self, name):
        return os.path.join(self.folder, name)

    def record(self, *words, code=0):
        result = subprocess.run([TOOL, "record", *map(str, words)], capture_output=True, text=True, timeout=60)
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return json.loads(result.stdout) if "--json" in words and code in (0, 1) else result.stderr

    def counts(self, scan):
        return [[tuple(round(float(v) * 1000) for v in point) for point in line] for line in scan]

    def same(self, one, two):
        with open(one, "rb") as a, open(two, "rb") as b:
            self.assertTrue(a.read() == b.read(), f"{one} and {two} differ")

    def test_transcripts_give_the_same_recording(self):
        want = self.counts(self.scan(200, points=50))
        for device, driver, keys in (("gocator", "lmi-gocator", ["spacing=0.1", "backlash=correct", "least_turning=10"]),
                                     ("stream", "stream", ["fields=line x y z", "pause_ms=700"]),
                                     ("scip", "hokuyo-scip", ["start=500", "end=580", "spacing=0.1"])):
            with self.subTest(driver):
                more = ["--fields", "line x y z"] if device == "stream" else []
                simulator = Simulator(self, device, "--scan", self.scan_path, "--rate", 200, *more)
                live, raw, again = self.path(device + ".mcap"), self.path(device + ".raw"), self.path(device + "-again.mcap")
                report = self.record("--driver", driver, f"tcp={simulator.where}", *keys, "name=d", "--raw", raw, "-o", live,
                                     "--lines", 200, "--json")
                self.assertEqual((report["files"], report["lines"], report["gaps"], report["raw_dropped"]), ([live], 200, 0, 0))
                self.check_sound(live)
                if device != "scip":
                    self.difference(exported(live), want)
                played = self.record("--driver", driver, f"transcript={raw}", *keys, "name=d", "-o", again, "--json")
                self.assertEqual(played["lines"], 200)
                self.same(live, again)

    def test_a_transcript_that_ends_with_a_loss_ends(self):
        self.scan(50)
        simulator = Simulator(self, "gocator", "--scan", self.scan_path, "--rate", 200)
        raw, live, again = self.path("l.raw"), self.path("l.mcap"), self.path("l-again.mcap")
        self.record("--driver", "lmi-gocator", f"tcp={simulator.where}", "name=d", "--raw", raw, "-o", live, "--lines", 50, "--json")
        with open(raw) as file:
            *events, closed = file.readlines()
        self.assertTrue(closed.startswith("C "))
        with open(raw, "w") as file:
            file.writelines([*events, "L" + closed[1:].rstrip() + " the cable was pulled\n", closed])
        self.assertEqual(self.record("--driver", "lmi-gocator", f"transcript={raw}", "name=d", "-o", again, "--json")["lines"], 50)
        self.same(live, again)

    def test_a_device_of_the_configuration(self):
        scan = self.scan(30)
        config = self.path("c.toml")
        with open(config, "w") as out:
            for name in ("a", "b"):
                out.write(f'[[device]]\nname = "{name}"\ndriver = "replay"\nfile = "{self.scan_path}"\n')
        self.assertIn("has 2 devices; name one", self.record("--config", config, code=2))
        self.assertIn('has no device "c"', self.record("c", "--config", config, code=2))
        self.assertIn("has no bytes to write", self.record("b", "--config", config, "--raw", self.path("r"), code=2))
        report = self.record("b", "--config", config, "-o", self.path("out"), "--json")
        (path,) = report["files"]
        self.assertEqual(os.path.dirname(path), self.path("out"))
        self.assertTrue(os.path.basename(path).startswith("b-"))
        self.check_points(path, scan)

    def test_mistakes(self):
        out, raw = self.path("x.mcap"), self.path("x.raw")
        self.assertIn("unknown", self.record("--driver", "toaster", code=2))
        self.assertIn("is no KEY=VALUE", self.record("--driver", "stream", "tcp", code=2))
        self.assertIn("command line:", self.record("--driver", "stream", "tpc=1:2", code=78))
        self.assertIn("exactly one of port, tcp", self.record("--driver", "stream", code=78))
        for name in (out, raw):
            with open(name, "w") as file:
                file.write("x")
        self.assertIn("is there already", self.record("--driver", "stream", "tcp=127.0.0.1:1", "-o", out, code=73))
        self.assertIn("is there already", self.record("--driver", "stream", "tcp=127.0.0.1:1", "--raw", raw, code=73))
        self.assertIn("no line came", self.record("--driver", "stream", "tcp=127.0.0.1:1", "-o", self.folder, "--seconds", 0.5, code=69))

    def test_bounded_transcript_says_so_and_can_be_played(self):
        self.scan(97, points=500)
        simulator = Simulator(self, "stream", "--scan", self.scan_path, "--loop", "--rate", 500)
        raw, live, again = self.path("r.raw"), self.path("r.mcap"), self.path("again.mcap")
        report = self.record("--driver", "stream", f"tcp={simulator.where}", "raw_limit_mb=1", "name=d", "--raw", raw, "-o", live,
                             "--lines", 400, "--json", code=1)
        self.assertGreater(report["raw_dropped"], 0)
        self.assertLess(os.path.getsize(raw), (1 << 20) + 100)
        with open(raw) as file:
            self.assertTrue(file.read().endswith("# the bound of this transcript is reached; what came later is not here\n"))
        played = self.record("--driver", "stream", f"transcript={raw}", "name=d", "-o", again, "--json")
        self.assertGreater(played["lines"], 50)
        whole = exported(live)
        part = exported(again)
        self.difference(part[:-1], whole[: len(part) - 1])

    def test_stops_on_a_signal_and_keeps_later_runs_beside_the_first(self):
        self.scan(97, points=20)
        simulator = Simulator(self, "stream", "--scan", self.scan_path, "--loop", "--rate", 100, "--fault", "cut:at=1")
        out = self.path("r.mcap")
        process = subprocess.Popen([TOOL, "record", "--driver", "stream", f"tcp={simulator.where}", "-o", out, "--json"],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        second = self.path("r-002.mcap")
        wait_for(lambda: os.path.exists(second) and os.path.getsize(second) > 2000, "the second run")
        process.send_signal(signal.SIGINT)
        text, _ = process.communicate(timeout=10)
        self.assertEqual(process.returncode, 0)
        self.assertEqual(json.loads(text)["files"], [out, second])
        for path in (out, second):
            self.check_sound(path)


if __name__ == "__main__":
    unittest.main()
