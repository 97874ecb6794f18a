# scansiond on a simulated Gocator profiler. SCANSION_LONG=1: 200 losses and returns.
# SPDX-License-Identifier: Apache-2.0
import json
import subprocess
import unittest

from harness import TOOL
from port_driver_kit import LONG, PortDriverTest, exported, recordings
from simulator import Simulator, descriptors, memory_kib

CYCLES = 200 if LONG else 6


class Gocator(PortDriverTest):
    def device(self, simulator, **more):
        return {"name": "d", "driver": "lmi-gocator", "tcp": simulator.where, "spacing": 0.1, **more}

    def counts(self, scan):
        return [[tuple(round(float(v) * 1000) for v in point) for point in line] for line in scan]

    def check_scan(self, lines, *options, **keys):
        want = self.counts(self.scan(lines, points=200))
        simulator = Simulator(self, "gocator", "--scan", self.scan_path, *options)
        device = self.device(simulator, **keys)
        path, status = self.record(device, lines)
        self.difference(exported(path), want)
        self.assertEqual(status["gaps"], 0)
        self.check_counters(status)
        self.check_transcript(device, path, lines)

    def test_points_at_the_device_rate(self):
        self.check_scan(300, "--rate", 500)

    def test_points_at_maximum_rate(self):
        self.check_scan(5000, "--rate", "max")

    def test_even_profiles(self):
        self.check_scan(1000, "--rate", "max", "--uniform")

    def test_lines_stand_where_the_encoder_says(self):
        want = self.counts(self.scan(50))
        simulator = Simulator(self, "gocator", "--scan", self.scan_path, "--rate", "max", "--encoder-step", 25)
        device = {**self.device(simulator), "encoder": 0.004}
        del device["spacing"]
        path, _ = self.record(device, 50)
        self.difference(exported(path), want)

    def test_coarser_resolution_rounds(self):
        want = self.counts(self.scan(20))
        simulator = Simulator(self, "gocator", "--scan", self.scan_path, "--rate", "max")
        path, _ = self.record(self.device(simulator, resolution="0.01"), 20)
        for got_line, want_line in zip(exported(path), want, strict=True):
            for got, point in zip(got_line, want_line, strict=True):
                self.assertTrue(all(abs(a - b) <= 5 for a, b in zip(got, point)), (got, point))

    def test_several_sources(self):
        self.scan(50)
        simulator = Simulator(self, "gocator", "--scan", self.scan_path, "--rate", 200, "--sources", 2)
        daemon = self.daemon([self.device(simulator)]).start()
        status = daemon.until(lambda: (d := daemon.device()) and d["error"] and d, "refused")
        self.assertIn("several sources; choose one", status["error"])
        daemon.stop(self)

    def test_one_source_of_several(self):
        want = self.counts(self.scan(50))
        simulator = Simulator(self, "gocator", "--scan", self.scan_path, "--rate", "max", "--sources", 2)
        path, _ = self.record(self.device(simulator, source="bottom"), 50)
        self.difference(exported(path), want)

    def test_cut_connections_lose_a_known_number_of_frames(self):
        self.scan(20, points=20)
        every = 3.0
        simulator = Simulator(self, "gocator", "--scan", self.scan_path, "--loop", "--rate", 200, "--fault",
                              f"cut:at=1,every={every},jitter=0.5")
        daemon = self.daemon([self.device(simulator)]).start()
        pid = daemon.process.pid
        daemon.until(lambda: daemon.device()["gaps"] >= 1, "a gap")
        before = descriptors(pid), memory_kib(pid)
        status = daemon.until(lambda: (d := daemon.device())["gaps"] >= (CYCLES if LONG else 3) and d, "gaps")
        self.assertLessEqual(descriptors(pid), before[0] + 1)
        self.assertLess(memory_kib(pid), before[1] + 8192)
        self.assertGreater(status["lines"], 100)
        daemon.stop(self)
        # Every loss begins a file. The sensor counts its frames, and so lost ones leave their room: the way goes on evenly
        # over lines and gaps.
        place = 0
        for path in recordings(daemon):
            self.check_sound(path)
            gaps = json.loads(subprocess.run([TOOL, "info", "--json", path], capture_output=True, text=True).stdout)["gaps"]
            ys = [line[0][1] // 100 for line in exported(path)]
            self.assertEqual(ys, list(range(ys[0], ys[0] + len(ys))))
            self.assertEqual(gaps, int(ys[0] > place))
            place = ys[-1] + 1

    def test_noise_is_counted_and_survived(self):
        self.scan(2000, points=50)
        for fault in ("flip:rate=0.0002", "drop:rate=0.0002", "duplicate:rate=0.05", "lose:rate=0.05"):
            with self.subTest(fault):
                simulator = Simulator(self, "gocator", "--scan", self.scan_path, "--rate", 2000, "--loop", "--fault", fault)
                daemon = self.daemon([self.device(simulator)], directory=self.folder + "/" + fault[:4]).start()
                status = daemon.until(lambda: (d := daemon.device())["lines"] > 900 and d, "lines come")
                self.check_counters(status)
                daemon.stop(self)
                for path in recordings(daemon):
                    self.check_sound(path)
                simulator.stop()

    def test_sensor_that_comes_later(self):
        self.scan(50)
        simulator = Simulator(self, "gocator", "--scan", self.scan_path, "--rate", 200, "--loop", "--fault", "unplug:at=0.5,for=1.5,every=4")
        daemon = self.daemon([self.device(simulator)]).start()
        daemon.until(lambda: daemon.device()["gaps"] >= 1, "lost and back")
        daemon.stop(self)


if __name__ == "__main__":
    unittest.main()
