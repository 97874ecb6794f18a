# scansiond on a simulated Gocator profiler. SCANSION_LONG=1: 200 losses and returns.
# SPDX-License-Identifier: Apache-2.0
import unittest

from port_driver_kit import LONG, PortDriverTest, Watched, exported, gaps_of, listens, recordings
from simulator import Simulator

CYCLES = 200 if LONG else 3


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

    def unplugged(self, fault):
        want = self.counts(self.scan(97, points=20))
        simulator = Simulator(self, "gocator", "--scan", self.scan_path, "--loop", "--rate", 200, "--seed", 3, "--fault", fault)
        daemon = self.daemon([self.device(simulator)]).start()
        watched = Watched(daemon, lambda: listens(simulator.where))
        watched.run(CYCLES)
        daemon.stop(self)
        watched.check(self, CYCLES)
        return daemon, want

    def test_unplugged_sensor_that_goes_on(self):
        daemon, want = self.unplugged("unplug:at=1.5,for=0.4,every=2.5,jitter=0.4,power=1")
        sizes = self.check_known_gaps(daemon, want, 200, 100)
        self.assertEqual(len(sizes), len(recordings(daemon)) - 1)
        self.assertGreaterEqual(len(sizes), CYCLES)

    def test_unplugged_sensor_that_starts_anew(self):
        daemon, _ = self.unplugged("unplug:at=1.5,for=0.4,every=2.5,jitter=0.4")
        files = recordings(daemon)
        self.assertGreater(len(files), CYCLES)
        place = -1
        for path in files:  # how many frames there would have been nobody knows; the way goes on
            self.check_sound(path)
            self.assertEqual(gaps_of(path), [] if place < 0 else [(0, None)])
            ys = [line[0][1] // 100 for line in exported(path)]
            self.assertEqual(ys, list(range(place + 1, place + 1 + len(ys))))
            place = ys[-1]

    def test_cut_connections(self):
        want = self.counts(self.scan(97, points=20))
        simulator = Simulator(self, "gocator", "--scan", self.scan_path, "--loop", "--rate", 200, "--fault", "cut:at=1,every=2,jitter=0.5")
        daemon = self.daemon([self.device(simulator)]).start()
        daemon.until(lambda: daemon.device()["gaps"] >= 3, "gaps")
        daemon.stop(self)
        self.check_known_gaps(daemon, want, 200, 100)

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
