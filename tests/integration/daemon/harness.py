# Runs the real daemon in a folder of its own and reads what it recorded.
# SPDX-License-Identifier: Apache-2.0
"""Needs SCANSIOND (path of the daemon); SCANSION (path of the tool) adds its verify and export as a second opinion."""
import json
import os
import random
import shutil
import signal
import socket
import struct
import subprocess
import tempfile
import time
import unittest

DAEMON = os.environ["SCANSIOND"]
TOOL = os.environ.get("SCANSION", "")
# Sanitizers and loaded machines are slow; only the promised two seconds of a stop are taken literally, and only without them.
PATIENCE = float(os.environ.get("SCANSION_TEST_PATIENCE", "60"))
STOP_SECONDS = float(os.environ.get("SCANSION_TEST_STOP_SECONDS", "2.5"))


def write_scan(path, lines, points=20, seed=1):
    """A noisy step profile; returns the points, line by line, as the texts that stand in the file."""
    rng = random.Random(seed)
    scan = []
    with open(path, "w") as out:
        for y in range(lines):
            line = []
            for i in range(points):
                z = (2.0 if i > points // 2 else 0.0) + rng.randrange(-5, 6) / 1000
                line.append((f"{i * 0.05:.3f}", f"{y * 0.1:.3f}", f"{z:.3f}"))
            scan.append(line)
            out.write("".join(" ".join(p) + "\n" for p in line) + "\n")
    return scan


class Recording:
    """The part of docs/FORMAT.md that the tests need, read without the project's code."""

    MAGIC = b"\x89MCAP0\r\n"
    MARK = b"\x89SCNGRP\n"

    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read()
        assert data[:8] == self.MAGIC, path
        self.complete = len(data) > 16 and data[-8:] == self.MAGIC
        self.groups = []  # (group number, first line, lines)
        at = 8
        while at + 9 <= len(data):
            opcode, size = data[at], struct.unpack_from("<Q", data, at + 1)[0]
            body = data[at + 9 : at + 9 + size]
            if len(body) < size or opcode == 0x02:  # torn, or the footer
                break
            if opcode == 0x06:
                self._chunk(body)
            at += 9 + size

    def _chunk(self, body):
        compression = struct.unpack_from("<I", body, 28)[0]
        at = 32 + compression + 8
        while at + 9 <= len(body):
            opcode, size = body[at], struct.unpack_from("<Q", body, at + 1)[0]
            message = body[at + 9 : at + 9 + size]
            at += 9 + size
            # A message's header is 22 bytes; place 0 is the line table. Numbers follow the fixed fields.
            if opcode == 0x05 and message[22:30] == self.MARK and message[22 + 14] == 0:
                group, lines, _, first = varints(message, 22 + 19, 4)
                self.groups.append((group, first, lines))

    @property
    def lines(self):
        return sum(lines for _, _, lines in self.groups)

    def check_order(self, test, first=0):
        for number, (group, line, lines) in enumerate(self.groups):
            test.assertEqual(group, number)
            test.assertEqual(line, first)
            first += lines


def varints(data, at, count):
    """Numbers of seven bits a byte, the lowest first."""
    out = []
    while len(out) < count:
        value = shift = 0
        while True:
            byte = data[at]
            at += 1
            value |= (byte & 0x7F) << shift
            shift += 7
            if byte < 0x80:
                break
        out.append(value)
    return out


class Daemon:
    """One scansiond with its configuration file."""

    def __init__(self, folder, devices, recording="", directory=None, env=None, wrapper=()):
        self.folder = folder
        self.directory = directory or os.path.join(folder, "rec")
        self.config = os.path.join(folder, "scansiond.toml")
        self.socket = os.path.join(folder, "control.sock")
        self.recording = recording
        self.env = dict(os.environ, **(env or {}))
        self.wrapper = list(wrapper)
        self.process = None
        self.configure(devices)

    def configure(self, devices):
        text = f'[recording]\ndirectory = "{self.directory}"\nmin_free_mb = 0\n{self.recording}\n[control]\nsocket = "{self.socket}"\n'
        for device in devices:
            text += "[[device]]\n" + "".join(f"{key} = {json.dumps(value)}\n" for key, value in device.items())
        with open(self.config, "w") as out:
            out.write(text)

    def start(self, wait=True):
        with open(os.path.join(self.folder, "log.txt"), "a") as log:
            self.process = subprocess.Popen([*self.wrapper, DAEMON, "--config", self.config], stderr=log, env=self.env)
        if wait:
            self.until(lambda: self.status() is not None, "the daemon answers")
        return self

    def log_text(self):
        with open(os.path.join(self.folder, "log.txt")) as file:
            return file.read()

    def status(self):
        try:
            with socket.socket(socket.AF_UNIX) as link:
                link.settimeout(10)
                link.connect(self.socket)
                link.sendall(b'{"command":"status"}\n')
                reply = b""
                while not reply.endswith(b"\n"):
                    part = link.recv(65536)
                    if not part:
                        return None
                    reply += part
                return json.loads(reply)
        except OSError:
            return None

    def device(self, name="d"):
        status = self.status()
        return next((d for d in status["devices"] if d["name"] == name), None) if status else None

    def until(self, condition, what):
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            result = condition()
            if result:
                return result
            if self.process.poll() is not None:
                raise AssertionError(f"daemon ended with {self.process.returncode} while waiting: {what}\n{self.log_text()}")
            time.sleep(0.01)
        raise AssertionError(f"never: {what}\nstatus {self.status()}\n{self.log_text()}")

    def until_state(self, state, name="d"):
        return self.until(lambda: (d := self.device(name)) and d["state"] == state and d, f"{name} is {state}")

    def until_written(self, lines, name="d"):
        return self.until(lambda: (d := self.device(name)) and d["lines_written"] >= lines and d, f"{lines} lines written")

    def signal(self, number):
        self.process.send_signal(number)

    def stop(self, test):
        """SIGTERM; the daemon must be gone in time with exit code 0."""
        begin = time.monotonic()
        self.signal(signal.SIGTERM)
        code = self.process.wait(PATIENCE)
        test.assertEqual(code, 0, self.log_text())
        test.assertLess(time.monotonic() - begin, STOP_SECONDS)

    def kill(self):
        if self.process and self.process.poll() is None:
            self.process.kill()
            self.process.wait()

    def files(self, name="d"):
        if not os.path.isdir(self.directory):
            return []
        return sorted(os.path.join(self.directory, f) for f in os.listdir(self.directory) if f.startswith(name + "-"))


class DaemonTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="scansion-daemon-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def daemon(self, devices, **options):
        daemon = Daemon(self.folder, devices, **options)
        self.addCleanup(daemon.kill)
        return daemon

    def scan(self, lines, name="scan.xyz", **options):
        self.scan_path = os.path.join(self.folder, name)
        return write_scan(self.scan_path, lines, **options)

    def replay(self, name="d", **options):
        return {"name": name, "driver": "replay", "file": options.pop("file", os.path.join(self.folder, "scan.xyz")), **options}

    def check_sound(self, path):
        """Complete by our own eyes and, when the tool is there, by its."""
        recording = Recording(path)
        self.assertTrue(recording.complete, path)
        if TOOL:
            result = subprocess.run([TOOL, "verify", path], capture_output=True, text=True)
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        return recording

    def check_points(self, path, scan):
        if not TOOL:
            return
        result = subprocess.run([TOOL, "export", path, "--format", "xyz", "-o", "-"], capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stderr)
        got = [tuple(map(float, row.split())) for row in result.stdout.splitlines() if row and not row.startswith("#")]
        want = [tuple(map(float, point)) for line in scan for point in line]
        # assertEqual would look for the difference of two long lists for hours.
        different = next((i for i, (a, b) in enumerate(zip(got, want)) if a != b), None)
        self.assertIsNone(different, f"point {different}: {got[different or 0:][:1]} instead of {want[different or 0:][:1]}")
        self.assertEqual(len(got), len(want))
