# scansim scip as a SCIP client sees it: every command, every sum, every length, on a pseudo terminal and on TCP.
# SPDX-License-Identifier: Apache-2.0
"""Needs SCANSIM. Written from the rules of the protocol alone; shares no code with driver or simulator."""
import os
import re
import select
import socket
import subprocess
import tempfile
import termios
import time
import tty
import unittest

SIM = os.environ["SCANSIM"]
STATUS_SUMS = {"00": "P", "99": "b", "01": "Q", "02": "R", "03": "S", "04": "T", "05": "U", "06": "V", "07": "W", "10": "Q",
               "98": "a", "0C": "c", "0D": "d", "0E": "e", "0G": "g", "0H": "h", "0M": "m", "21": "S", "50": "U"}


def sum_of(text):
    return chr((sum(text.encode()) & 0x3F) + 0x30)


def value_of(text):
    value = 0
    for character in text:
        assert 0x30 <= ord(character) <= 0x6F, repr(text)
        value = value << 6 | ord(character) - 0x30
    return value


class Client:
    """One connection. A message ends with an empty line."""

    def __init__(self, descriptor, write):
        self.descriptor, self.write, self.held = descriptor, write, b""

    def message(self, seconds=5.0):
        end = time.monotonic() + seconds
        while b"\n\n" not in self.held:
            ready, _, _ = select.select([self.descriptor], [], [], max(0.0, end - time.monotonic()))
            if not ready:
                raise AssertionError(f"no message; held {self.held!r}")
            part = os.read(self.descriptor, 4096)
            if not part:
                raise EOFError
            self.held += part
        text, self.held = self.held.split(b"\n\n", 1)
        lines = text.decode("ascii").split("\n")
        assert all(lines), f"an empty line within {lines}"
        return lines

    def send(self, text):
        self.write(text.encode())

    def ask(self, request, end="\n"):
        """Status and body of the answer; scan messages on the way are passed over."""
        self.send(request + end)
        while True:
            echo, status, *body = self.message()
            if echo != request:
                assert status == "99b", (echo, status)
                continue
            assert len(status) == 3 and status[2] == sum_of(status[:2]), status
            assert STATUS_SUMS.get(status[:2], status[2]) == status[2]
            return status[:2], body


def summed(line):
    assert line[-1] == sum_of(line[:-1]), line
    return line[:-1]


def rows(body):
    out = {}
    for line in body:
        key, value = re.fullmatch(r"([A-Z]{4}):(.*);.", line).groups()
        assert line[-1] == sum_of(line[:-2]), line
        out[key] = value
    return out


def steps_of(body, kind, echoes=False):
    """Stamp and, for every step, its echoes as (distance, intensity or None)."""
    stamp = summed(body[0])
    assert len(stamp) == 4
    lines = [summed(line) for line in body[1:]]
    assert all(len(line) == 64 for line in lines[:-1]) and 1 <= len(lines[-1]) <= 64
    data = "".join(lines)
    width = {"S": 2, "D": 3, "E": 6}[kind]
    steps = []
    while data:
        further = data[0] == "&"
        assert not further or echoes
        data = data[further:]
        part, data = data[:width], data[width:]
        assert len(part) == width
        echo = (value_of(part[:3]), value_of(part[3:])) if kind == "E" else (value_of(part), None)
        if further:
            steps[-1].append(echo)
        else:
            steps.append([echo])
    return value_of(stamp), steps


class ScipClientTest(unittest.TestCase):
    def simulator(self, *options, tcp=True, scan=None):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path = os.path.join(folder.name, "plate.xyz")
        with open(path, "w") as out:
            for y in range(20):
                points = scan or [(-500, 0), (500, 0)]
                out.write("".join(f"{x} {y} {z}\n" for x, z in points) + "\n")
        link = os.path.join(folder.name, "tty")
        where = ["--tcp", "127.0.0.1:0"] if tcp else ["--pty", link]
        process = subprocess.Popen([SIM, "scip", "--scan", path, "--loop", *where, *options], stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait, 10)
        self.addCleanup(process.terminate)
        self.where = process.stderr.readline().split()[-1] if tcp else link
        if not tcp:
            process.stderr.readline()
        return self.connect()

    def connect(self):
        if ":" in self.where:
            host, port = self.where.rsplit(":", 1)
            link = socket.create_connection((host, int(port)), 5)
            self.addCleanup(link.close)
            self.socket = link
            return Client(link.fileno(), link.sendall)
        descriptor = os.open(self.where, os.O_RDWR | os.O_NOCTTY)
        self.addCleanup(os.close, descriptor)
        tty.setraw(descriptor, termios.TCSANOW)
        return Client(descriptor, lambda data: os.write(descriptor, data))

    def test_what_the_sensor_says_about_itself(self):
        for tcp in (True, False):
            with self.subTest(tcp=tcp):
                client = self.simulator(tcp=tcp)
                for end in ("\n", "\r", "\r\n"):
                    self.assertEqual(client.ask("QT", end), ("00", []))
                status, body = client.ask("VV")
                self.assertEqual((status, list(rows(body))), ("00", ["VEND", "PROD", "FIRM", "PROT", "SERI"]))
                status, body = client.ask("PP;tag 1._+@")
                facts = rows(body)
                self.assertEqual((status, len(body)), ("00", 8))
                self.assertEqual({k: int(v) for k, v in facts.items() if k != "MODL"},
                                 {"DMIN": 23, "DMAX": 60000, "ARES": 1440, "AMIN": 0, "AMAX": 1080, "AFRT": 540, "SCAN": 2400})
                status, body = client.ask("II")
                facts = rows(body)
                self.assertEqual(list(facts), ["MODL", "LASR", "SCSP", "MESM", "SBPS", "TIME", "STAT"])
                self.assertTrue(facts["STAT"].startswith("Stable 000 no error"))
                for text in (value for reply in ("VV", "PP", "II") for value in rows(client.ask(reply)[1]).values()):
                    self.assertNotIn(":", text, "clients split a row at its colon")

    def test_refusals(self):
        client = self.simulator()
        for request, status in {
            "XX": "0E", "GD0384038401": "10", "MD038X038401001": "01", "MD0384X38401001": "02", "MD03840384X1001": "03",
            "MD0384038401X01": "06", "MD03840384010X1": "07", "MD0400038401001": "05", "MD0384099901001": "00",
            "MD0384109901001": "04", "MD0384": "0C", "MD03840384010010": "0D", "QT;12345678901234567": "0G", "QT;a-b": "0H",
            "TM1": "04", "TM2": "03", "TM3": "01", "TM": "0C", "SS115200": "0E", "MF0384038401001": "0E"}.items():
            self.assertEqual(client.ask(request)[0], status, request)
            client.ask("QT")

    def test_clock_mode_and_its_wrap(self):
        client = self.simulator("--clock", "16777100")
        self.assertEqual(client.ask("TM0")[0], "00")
        self.assertEqual(client.ask("TM0")[0], "02")
        self.assertEqual(client.ask("QT")[0], "0E", "only TM2 leaves the clock mode")
        self.assertEqual(client.ask("%ST"), ("00", ["002B"]))
        self.assertEqual(client.ask("MD0540054001001")[0], "10")
        times = []
        begin = time.monotonic()
        while not times or times[-1] > 1000:  # up to the wrap
            status, body = client.ask("TM1")
            self.assertEqual((status, len(body)), ("00", 1))
            times.append(value_of(summed(body[0])))
            self.assertLess(time.monotonic() - begin, 5)
        self.assertGreaterEqual(times[0], 16777100)
        self.assertEqual(client.ask("TM2")[0], "00")
        self.assertEqual(client.ask("RS")[0], "00")
        client.ask("TM0")
        self.assertLess(value_of(client.ask("TM1")[1][0][:4]), 1000, "RS sets the clock to 0")

    def test_single_scans(self):
        client = self.simulator()
        self.assertEqual(client.ask("BM")[0], "00")
        self.assertEqual(client.ask("BM")[0], "02")
        self.assertEqual(client.ask("%ST"), ("00", ["003C"]))
        for kind in "DSE":
            status, body = client.ask(f"G{kind}0000108001;t{kind}")
            _, steps = steps_of(body, kind)
            self.assertEqual((status, len(steps)), ("00", 1081))
            self.assertEqual(steps[540][0][0], 300)
            self.assertEqual(steps[660][0][0], 346, "300 mm / cos 30 degrees")
            self.assertEqual(client.ask(f"G{kind}0100018305")[0], "00")
        _, steps = steps_of(client.ask("GD0440064010")[1], "D")
        self.assertEqual(len(steps), 21)
        self.assertEqual(steps[9][0][0], 300, "of a cluster the nearest")

    def test_running_scans_count_down_and_stop(self):
        for tcp in (True, False):
            for kind, size in (("D", 3372), ("E", 6717), ("S", None)):
                with self.subTest(tcp=tcp, kind=kind):
                    client = self.simulator("--rate", "200", tcp=tcp)
                    self.assertEqual(client.ask(f"M{kind}0000108001205;run"), ("00", []))
                    stamps = []
                    for left in range(4, -1, -1):
                        echo, status, *body = client.message()
                        self.assertEqual((echo, status), (f"M{kind}00001080012{left:02d};run", "99b"))
                        length = sum(len(line) + 1 for line in [echo, status, *body]) + 1
                        if size is not None:
                            self.assertEqual(length, size + len(";run"))
                        stamp, steps = steps_of(body, kind)
                        self.assertEqual(len(steps), 1081)
                        stamps.append(stamp)
                    for one, two in zip(stamps, stamps[1:]):
                        self.assertAlmostEqual(two - one, 15, delta=1, msg="two scans of 5 ms are left out")
                    self.assertEqual(rows(client.ask("II")[1])["LASR"], "OFF")

    def test_commands_between_scans_and_the_late_scan_after_qt(self):
        client = self.simulator("--rate", "400")
        self.assertEqual(client.ask("MD0000108000000;a")[0], "00")
        for _ in range(20):
            self.assertEqual(client.message()[0], "MD0000108000000;a")
            self.assertEqual(client.ask("%ST"), ("00", ["004D"]))
        self.assertEqual(client.ask("ME0540054000000;b")[0], "00", "a new request overrides")
        self.assertEqual(client.message()[0], "ME0540054000000;b")
        self.assertEqual(client.ask("QT")[0], "00")
        self.assertEqual(client.ask("%ST"), ("00", ["000@"]))
        self.assertEqual(client.held, b"")

    def test_echoes(self):
        # A shelf over a floor: a vertical ray over it meets both, the floor 200 mm behind.
        client = self.simulator(scan=[(-500, 0), (500, 0), (500, 200), (0, 200)])
        client.ask("BM")
        _, steps = steps_of(client.ask("HD0000108001")[1], "D", echoes=True)
        self.assertEqual(len(steps), 1081)
        self.assertEqual([d for d, _ in steps[560]], [301, 502])
        self.assertEqual([d for d, _ in steps[520]], [502])
        _, steps = steps_of(client.ask("HE0530055001")[1], "E", echoes=True)
        self.assertTrue(all(len(step) <= 3 for step in steps))
        self.assertEqual(client.ask("ND0540055001001;n")[0], "00")
        echo, status, *body = client.message()
        self.assertEqual((echo, status), ("ND0540055001000;n", "99b"))
        self.assertEqual(len(steps_of(body, "D", echoes=True)[1]), 11)
        plain = self.simulator(tcp=False)
        self.assertEqual(plain.ask("ND0540055001001")[0], "0E", "the serial version has one echo")

    def test_sleep_reset_and_restart(self):
        client = self.simulator()
        self.assertEqual(client.ask("%SL")[0], "00")
        self.assertEqual(client.ask("%ST"), ("00", ["005E"]))
        self.assertEqual(client.ask("BM")[0], "10")
        self.assertEqual(client.ask("QT")[0], "00")
        self.assertEqual(client.ask("BM")[0], "00")
        self.assertEqual(client.ask("RT")[0], "00")
        self.assertEqual(client.ask("%ST"), ("00", ["000@"]))
        self.assertEqual(client.ask("RB")[0], "01")
        self.assertEqual(client.ask("RB")[0], "00")
        with self.assertRaises((EOFError, ConnectionError)):
            client.message()
        self.assertEqual(self.connect().ask("QT")[0], "00")

    def test_bit_rates(self):
        client = self.simulator("--baud", "38400", tcp=False)
        for request, status in (("SS038400", "03"), ("SS123456", "04"), ("SS115200", "00"), ("SS115200", "03"),
                                ("RT", "00"), ("SS115200", "03"), ("RS", "00"), ("SS038400", "03"), ("CR00", "00"), ("HS1", "00")):
            self.assertEqual(client.ask(request)[0], status, request)

    def test_old_mode(self):
        client = self.simulator("--scip1")
        client.send("\nQT\nSCIP2.0\n")
        held = b""
        while not held.endswith(b"SCIP2.0\n0\n\n"):
            held += self.socket.recv(100)
        self.assertEqual(held, b"\nE\n\nQT\nE\n\nSCIP2.0\n0\n\n")
        self.assertEqual(client.ask("QT")[0], "00")

    def test_stops_when_its_network_host_goes_but_not_on_a_serial_line(self):
        client = self.simulator("--rate", "100")
        client.ask("MD0540054000000;gone")
        client.message()
        self.socket.close()
        client = self.connect()
        self.assertEqual(rows(client.ask("II")[1])["LASR"], "OFF")
        client = self.simulator("--rate", "100", tcp=False)
        client.ask("MD0540054000000;gone")
        self.assertEqual(self.connect().message()[1], "99b")

    def test_several_requests_in_one_write(self):
        client = self.simulator()
        client.send("VV\nPP\nII\nQT\n")
        self.assertEqual([client.message()[0] for _ in range(4)], ["VV", "PP", "II", "QT"])


if __name__ == "__main__":
    unittest.main()
