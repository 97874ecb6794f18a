# The daemon on a SCIP sensor that is none of ours: legal oddities, each scan exactly as it was sent.
# SPDX-License-Identifier: Apache-2.0
"""Needs SCANSIOND and SCANSION."""
import math
import os
import subprocess
import unittest

from foreign_scip import Sensor, summed
from harness import TOOL
from port_driver_kit import PortDriverTest, gaps_of, recordings


class Foreign(PortDriverTest):
    def lines(self, path):
        """Step -> distance of each line, from the points alone."""
        text = subprocess.run([TOOL, "export", path, "--format", "xyz", "-o", "-"], capture_output=True, text=True, check=True).stdout
        out = []
        for block in text.split("\n\n"):
            line = {}
            for row in block.splitlines():
                if row and not row.startswith("#"):
                    x, _, z = map(float, row.split())
                    step = Sensor.AFRT + math.atan2(x, -z) / (2 * math.pi) * Sensor.ARES
                    distance = math.hypot(x, z)
                    self.assertAlmostEqual(distance, round(distance), delta=0.0075)
                    line[round(2 * step) / 2] = round(distance)  # a cluster's middle may be a half
            if line:
                out.append(line)
        return out

    def run_on(self, lines=60, keys=None, tcp=False, rejects=0, missing=0, **odd):
        """Records; every recorded line must be one the sensor sent, in order, with every distance and nothing else."""
        keys = keys or {}
        sensor = Sensor(tcp=tcp, **odd)
        self.addCleanup(sensor.stop)
        self.turn = getattr(self, "turn", 0) + 1
        folder = os.path.join(self.folder, f"rec{self.turn}")
        daemon = self.daemon([{"name": "d", "driver": "hokuyo-scip", **sensor.where, **keys}], directory=folder).start()
        status = daemon.until_written(lines)
        link = self.check_counters(status)
        if not odd.get("streams"):  # then it is met in the middle of a message, and others are of another session
            self.assertEqual(sum(link["rejected"].values()), rejects, link)
        daemon.stop(self)
        found = []
        cluster, ceiling = keys.get("cluster", 1), 4094 if keys.get("mode") == "MS" else Sensor.DMAX
        for path in recordings(daemon):
            self.check_sound(path)
            for line in self.lines(path):
                scan = next((n for n in sensor.sent if n > (found[-1] if found else 0) and self.same(line, sensor, n, cluster, ceiling, keys)), None)
                self.assertIsNotNone(scan, f"line {len(found)} was never sent, {line}")
                found.append(scan)
        self.assertGreaterEqual(len(found), lines)
        self.gap_sizes = [count for path in recordings(daemon) for _, count in gaps_of(path)]
        step = keys.get("skip", 0) + 1
        lost = sum((b - a) // step - 1 for a, b in zip(found, found[1:]))
        self.assertEqual(lost, missing, "scans between the first and the last that are missing")
        return sensor, status

    def same(self, line, sensor, scan, cluster, ceiling, keys):
        sent = sensor.sent[scan]
        further = {"farthest": lambda s, d: d + (150 if s % 3 == 0 else 0) + (150 if s % 6 == 3 else 0)}.get(keys.get("echo"), lambda s, d: d)
        want = {}
        for step, distance in sent.items():
            if Sensor.DMIN <= distance <= ceiling:
                last = min(step + cluster - 1, keys.get("end", Sensor.AMAX))
                want[(step + last) / 2] = further(step, distance)
        return len(want) == len(line) and all(abs(line.get(s, -1) - d) == 0 for s, d in want.items())

    def test_plain_and_byte_by_byte(self):
        for tcp in (False, True):
            with self.subTest(tcp=tcp):
                self.run_on(tcp=tcp)
        self.run_on(lines=40, drips=True, keys={"start": 44, "end": 120})

    def test_rows_in_another_order_with_others_between_and_their_sums_over_the_semicolon(self):
        self.run_on(shuffles=True)

    def test_commands_that_it_does_not_have(self):
        self.run_on(terse=True)

    def test_two_characters_intensities_and_echoes(self):
        for mode, more in (("MS", {}), ("ME", {}), ("ND", {}), ("NE", {}), ("ND", {"echo": "farthest"})):
            with self.subTest(mode=mode, **more):
                self.run_on(lines=40, keys={"mode": mode, "start": 44, "end": 300, **more})

    def test_clusters_and_skips(self):
        # The last cluster is a short one: 682 steps are no multiple of 3.
        self.run_on(keys={"cluster": 3})
        self.run_on(lines=30, keys={"skip": 2})
        self.run_on(keys={"cluster": 2, "start": 44, "end": 725, "mode": "MS"})

    def test_measures_already_and_does_not_hear_the_first_requests_to_stop(self):
        self.run_on(streams=True, late=True)
        self.run_on(streams=True, deaf=2)

    def test_other_modes_at_the_start(self):
        self.run_on(in_clock_mode=True, ticks=True)
        self.run_on(scip1=True, rejects=1)  # its answer to an empty line has no echo
        self.run_on(lit=True)

    def test_a_cold_laser(self):
        sensor, _ = self.run_on(cold=2)
        self.assertEqual(sensor.requests.count("BM"), 3)

    def test_the_clock_wraps(self):
        _, status = self.run_on(clock=(1 << 24) - 500, lines=100)
        self.assertEqual(status["gaps"], 0)

    def test_it_checks_itself_in_the_middle(self):
        checks = {80: "21", 81: "21", 82: "24", 83: "98"}
        self.run_on(lines=110, faults=checks, missing=4)
        self.assertEqual(self.gap_sizes, [4])

    def test_a_hardware_fault_ends_the_run(self):
        sensor = Sensor(faults={90: "51"})
        self.addCleanup(sensor.stop)
        daemon = self.daemon([{"name": "d", "driver": "hokuyo-scip", **sensor.where}]).start()
        daemon.until(lambda: "hardware fault 51" in daemon.log_text(), "the fault is told")
        daemon.until(lambda: len(recordings(daemon)) == 2, "it measures again")
        daemon.stop(self)

    def test_damaged_scans_are_gaps(self):
        def sum_is_wrong(lines):
            return [lines[0][:-1] + chr(ord(lines[0][-1]) ^ 1), *lines[1:]]

        def value_is_wrong(lines):
            return [*lines[:3], chr(ord(lines[3][0]) ^ 2) + lines[3][1:], *lines[4:]]

        def line_is_missing(lines):
            return lines[:4] + lines[5:]

        def two_lines_are_one(lines):
            return [summed(lines[0][:-1] + lines[1][:-1]), *lines[2:]]

        faults = {70: sum_is_wrong, 75: value_is_wrong, 80: line_is_missing, 85: two_lines_are_one, 90: lambda lines: lines[:-1]}
        _, status = self.run_on(lines=110, faults=faults, rejects=5, missing=5)
        self.assertEqual(self.gap_sizes, [1] * 5)
        rejected = status["link"]["rejected"]
        self.assertEqual((rejected["checksum"], rejected["count"]), (2, 3))


if __name__ == "__main__":
    unittest.main(verbosity=2)
