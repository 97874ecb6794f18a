# scansiond on described streams. SCANSION_LONG=1: 200 losses and returns.
# SPDX-License-Identifier: Apache-2.0
import os
import socket
import unittest

from port_driver_kit import LONG, PortDriverTest, Watched, exported, gaps_of, listens, recordings
from simulator import Simulator

CYCLES = 200 if LONG else 3
SUMMED = {"fields": "line x y z", "checksum": "crc16-modbus"}
SUMMED_OPTIONS = ("--fields", "line x y z", "--checksum", "crc16-modbus", "--no-blank")


class Stream(PortDriverTest):
    def device(self, **more):
        return {"name": "d", "driver": "stream", **more}

    def counts(self, scan):
        return [[tuple(round(float(v) * 1000) for v in point) for point in line] for line in scan]

    def check_scan(self, lines, options, keys, rate="max", written=None):
        want = self.counts(self.scan(lines, points=100))
        simulator = Simulator(self, "stream", "--scan", self.scan_path, "--rate", rate, *options)
        device = self.device(tcp=simulator.where, **keys)
        written = written or lines
        path, status = self.record(device, written)
        self.difference(exported(path)[:written], want[:written])
        self.assertEqual((status["gaps"], status["invalid"]), (0, 0))
        link = self.check_counters(status)
        self.assertEqual(sum(link["rejected"].values()), 0)
        self.check_transcript(device, path, written)

    def test_text_with_blank_rows_at_a_rate(self):
        self.check_scan(100, (), {}, rate=100)

    def test_text_with_blank_rows_at_maximum_rate(self):
        self.check_scan(2000, (), {})

    def test_mark(self):
        self.check_scan(200, ("--mark", "END"), {"break": "mark", "mark": "END"})

    def test_number_of_points(self):
        self.check_scan(200, ("--no-blank",), {"break": "points", "points": 100})

    def test_reversal(self):
        # What ends the last line is that nothing comes any more.
        self.check_scan(50, ("--no-blank",), {"break": "reversal", "axis": "x", "pause_ms": 700})

    def test_pause(self):
        self.check_scan(6, ("--no-blank",), {"break": "pause", "pause_ms": 300}, rate=1)

    def test_summed_rows_with_numbers(self):
        self.check_scan(200, SUMMED_OPTIONS, {**SUMMED, "pause_ms": 700})

    def test_records(self):
        fields = "line:u16be x:i32le*0.0005 y:i32le*0.001 z:i32be*0.001 bad:u8"
        self.check_scan(500, ("--format", "binary", "--fields", fields, "--checksum", "crc32", "--sync", "AA55"),
                        {"format": "binary", "fields": fields, "checksum": "crc32", "sync": "AA 55", "pause_ms": 700})

    def test_serial(self):
        want = self.counts(self.scan(300))
        link = os.path.join(self.folder, "tty")
        Simulator(self, "stream", "--scan", self.scan_path, "--rate", "max", "--pty", link, "--asked", tcp=False)
        device = self.device(port=link, start="GO\r\n")
        path, _ = self.record(device, 300)
        self.difference(exported(path), want)
        self.check_transcript(device, path, 300)

    def test_udp(self):
        scan = self.scan(100)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        device = self.device(udp=f"127.0.0.1:{port}")
        daemon = self.daemon([dict(device, raw=self.raw_path())]).start()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
            daemon.until(lambda: daemon.device()["state"] in ("streaming", "stale", "starting"), "it listens")
            for line in scan:
                link.sendto("".join(" ".join(p) + "\n" for p in line).encode() + b"\n", ("127.0.0.1", port))
        self.ended(daemon, device, scan)

    def ended(self, daemon, device, scan):
        """Everything came; so it does from the transcript."""
        daemon.until_written(len(scan))
        daemon.stop(self)
        (path,) = recordings(daemon)
        self.difference(exported(path), self.counts(scan))
        self.check_transcript(device, path, len(scan))

    def test_file_with_a_last_line_without_an_end(self):
        scan = self.scan(30)
        with open(self.scan_path) as source:
            text = source.read().rstrip("\n") + "\n"
        with open(self.scan_path, "w") as out:
            out.write(text)
        device = self.device(file=self.scan_path)
        path, _ = self.record(device, 30)
        self.difference(exported(path), self.counts(scan))
        self.check_transcript(device, path, 30)

    def test_fifo(self):
        scan = self.scan(30)
        fifo = os.path.join(self.folder, "fifo")
        os.mkfifo(fifo)
        device = self.device(file=fifo)
        daemon = self.daemon([dict(device, raw=self.raw_path())]).start()
        with open(self.scan_path) as source, open(fifo, "w") as out:
            out.write(source.read())
        self.ended(daemon, device, scan)

    def test_no_wrong_point_is_accepted_under_noise(self):
        want = self.counts(self.scan(400, points=50))
        truth = {line[0][1]: set(line) for line in want}
        for fault in ("flip:rate=0.0005", "drop:rate=0.002", "insert:rate=0.002", "flip:rate=0.01"):
            with self.subTest(fault):
                simulator = Simulator(self, "stream", "--scan", self.scan_path, "--rate", "max", *SUMMED_OPTIONS, "--fault", fault)
                folder = f"{self.folder}/{fault.replace(':', '-')}"
                daemon = self.daemon([self.device(tcp=simulator.where, pause_ms=700, **SUMMED)], directory=folder).start()
                share = 0.2 if fault == "flip:rate=0.01" else 0.9
                status = daemon.until(lambda: (d := daemon.device())["points"] > share * 20000 and d["pending_groups"] == 0 and d, "points")
                link = self.check_counters(status)
                self.assertGreater(sum(link["rejected"].values()), 0)
                self.assertGreater(status["invalid"], 0)
                daemon.stop(self)
                simulator.stop()
                ys = []
                for line in exported(recordings(daemon)[0]):
                    ys.append(line[0][1])
                    self.assertTrue(set(line) <= truth[line[0][1]], "a point that was never sent")
                self.assertEqual(ys, sorted(set(ys)), "each line once, in order")

    def unplugged(self, keys, options):
        want = self.counts(self.scan(97, points=20))
        simulator = Simulator(self, "stream", "--scan", self.scan_path, "--loop", "--rate", 100, "--seed", 3, *options, "--fault",
                              "unplug:at=1.5,for=0.4,every=2.5,jitter=0.4")
        daemon = self.daemon([self.device(tcp=simulator.where, **keys)]).start()
        watched = Watched(daemon, lambda: listens(simulator.where))
        watched.run(CYCLES)
        daemon.stop(self)
        watched.check(self, CYCLES)
        self.assertGreater(len(recordings(daemon)), CYCLES)
        return daemon, want

    def test_unplugged_and_back(self):
        daemon, want = self.unplugged({"fields": "line x z", "spacing": 0.1}, ("--fields", "line x z"))
        self.check_known_gaps(daemon, want, 100, 100)

    def test_unplugged_device_that_does_not_count(self):
        daemon, _ = self.unplugged({"fields": "x z", "spacing": 0.1}, ("--fields", "x z"))
        place = -1
        for path in recordings(daemon):
            self.check_sound(path)
            self.assertEqual(gaps_of(path), [] if place < 0 else [(0, None)])
            ys = [line[0][1] // 100 for line in exported(path)]
            self.assertEqual(ys, list(range(place + 1, place + 1 + len(ys))))
            place = ys[-1]


if __name__ == "__main__":
    unittest.main()
