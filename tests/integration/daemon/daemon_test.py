# scansiond as its users meet it: replay, stop, kill, full disk, reload, bad input.
# SPDX-License-Identifier: Apache-2.0
import json
import os
import random
import signal
import socket
import subprocess
import time
import unittest

from harness import DAEMON, Daemon, DaemonTest, Recording, write_scan

KILLS = int(os.environ.get("SCANSION_KILLS", "4"))
GROUP_LINES = 64


class Replay(DaemonTest):
    def test_scan_to_its_end(self):
        scan = self.scan(1000)
        daemon = self.daemon([self.replay()]).start()
        device = daemon.until_written(1000)
        daemon.until_state("finished")
        daemon.stop(self)
        self.assertEqual((device["lines"], device["points"], device["invalid"]), (1000, 20000, 0))
        (path,) = daemon.files()
        self.assertRegex(os.path.basename(path), r"^d-\d{8}T\d{6}Z-001\.mcap$")
        recording = self.check_sound(path)
        recording.check_order(self)
        self.assertEqual([lines for _, _, lines in recording.groups], [64] * 15 + [40])
        self.check_points(path, scan)

    def test_two_devices_side_by_side(self):
        self.scan(300)
        write_scan(os.path.join(self.folder, "other.xyz"), 200, seed=2)
        daemon = self.daemon([self.replay("a"), self.replay("b", file=os.path.join(self.folder, "other.xyz"))]).start()
        daemon.until_written(300, "a")
        daemon.until_written(200, "b")
        daemon.stop(self)
        self.assertEqual(self.check_sound(daemon.files("a")[0]).lines, 300)
        self.assertEqual(self.check_sound(daemon.files("b")[0]).lines, 200)

    def test_stop_in_the_middle(self):
        scan = self.scan(3000)
        daemon = self.daemon([self.replay(rate=400)]).start()
        device = daemon.until_written(100)
        self.assertEqual(device["state"], "streaming")
        self.assertTrue(device["recording"]["path"].startswith(daemon.directory))
        daemon.stop(self)
        (path,) = daemon.files()
        recording = self.check_sound(path)
        recording.check_order(self)
        self.assertGreaterEqual(recording.lines, device["lines"], "a line that was taken is written")
        self.assertLess(recording.lines, 3000)
        self.check_points(path, scan[: recording.lines])

    def test_rate_is_kept(self):
        self.scan(2000)
        daemon = self.daemon([self.replay(rate=200)]).start()
        first = daemon.until(lambda: (d := daemon.device())["lines"] > 0 and (time.monotonic(), d["lines"]), "lines come")
        later = daemon.until(lambda: (d := daemon.device())["lines"] >= first[1] + 200 and (time.monotonic(), d["lines"]), "more")
        rate = (later[1] - first[1]) / (later[0] - first[0])
        self.assertLess(rate, 230)

    def test_loop_goes_on_in_the_same_recording(self):
        self.scan(100)
        daemon = self.daemon([self.replay(loop=True, rate=2000)]).start()
        daemon.until_written(350)
        daemon.stop(self)
        (path,) = daemon.files()
        self.check_sound(path).check_order(self)

    def test_rotation(self):
        self.scan(6000, points=400)
        daemon = self.daemon([self.replay()], recording="rotate_mb = 1").start()
        daemon.until_written(6000)
        daemon.stop(self)
        files = daemon.files()
        self.assertGreater(len(files), 1)
        first = 0
        for path in files:
            recording = self.check_sound(path)
            recording.check_order(self, first)
            first += recording.lines
        self.assertEqual(first, 6000)

    def test_missing_file_is_an_absent_device(self):
        daemon = self.daemon([self.replay()]).start()
        device = daemon.until_state("backing off")
        self.assertIn("scan.xyz: No such file or directory", device["error"])
        self.assertEqual(daemon.files(), [])
        write_scan(os.path.join(self.folder, "part"), 100)
        os.rename(os.path.join(self.folder, "part"), os.path.join(self.folder, "scan.xyz"))
        device = daemon.until_written(100)
        daemon.stop(self)
        self.assertEqual(self.check_sound(daemon.files()[0]).lines, 100)

    def test_bad_row_in_the_middle(self):
        """With a resolution given only the first 4 MiB are looked at before the first line."""
        scan = self.scan(15000)
        with open(self.scan_path, "a") as out:
            out.write("1.0 2.0\n")
        daemon = self.daemon([self.replay(resolution="0.001")]).start()
        device = daemon.until_state("backing off")
        self.assertIn(f"scan.xyz:{15000 * 21 + 1}:", device["error"], "the row is named")
        self.assertGreater(device["lines"], 14000)
        daemon.until_written(device["lines"])
        # The same bad bytes are not recorded again and again.
        time.sleep(1.5)
        daemon.stop(self)
        (path,) = daemon.files()
        recording = self.check_sound(path)
        self.assertEqual(recording.lines, device["lines"])
        self.check_points(path, scan[: recording.lines])

    def test_bad_row_is_found_before_the_first_line(self):
        self.scan(15000)
        with open(self.scan_path, "a") as out:
            out.write("1.0 2.0\n")
        daemon = self.daemon([self.replay()]).start()
        self.assertIn(f"scan.xyz:{15000 * 21 + 1}:", daemon.until_state("backing off")["error"])
        daemon.stop(self)
        self.assertEqual(daemon.files(), [])

    def test_binary_garbage(self):
        with open(os.path.join(self.folder, "scan.xyz"), "wb") as out:
            out.write(bytes(random.Random(3).randrange(256) for _ in range(5000)))
        daemon = self.daemon([self.replay()]).start()
        device = daemon.until_state("backing off")
        self.assertIn("scan.xyz", device["error"])
        daemon.stop(self)
        self.assertEqual(daemon.files(), [])


class Stop(DaemonTest):
    def test_device_that_hangs(self):
        """A FIFO that nobody writes to: opening or reading it never comes back."""
        os.mkfifo(os.path.join(self.folder, "scan.xyz"))
        daemon = self.daemon([self.replay()]).start()
        time.sleep(0.3)
        daemon.stop(self)

    def test_at_full_speed(self):
        self.scan(20000, points=100)
        daemon = self.daemon([self.replay()]).start()
        daemon.until_written(64)
        daemon.stop(self)
        recording = self.check_sound(daemon.files()[0])
        recording.check_order(self)

    def test_interrupt_is_a_stop_too(self):
        daemon = self.daemon([]).start()
        daemon.signal(signal.SIGINT)
        self.assertEqual(daemon.process.wait(20), 0)


class Kill(DaemonTest):
    def test_kill_at_random_moments(self):
        """SCANSION_KILLS=200 for the long run."""
        self.scan(20000)
        rng = random.Random(os.environ.get("SCANSION_SEED", "5"))
        worst = 0
        for turn in range(KILLS):
            with self.subTest(turn=turn):
                worst = max(worst, self.kill_once(rng, turn))
        print(f"kill -9: {KILLS} times, at most {worst} lines of the open group missing", flush=True)

    def kill_once(self, rng, turn):
        directory = os.path.join(self.folder, f"rec{turn}")
        rate = rng.choice([50, 300, 1000, 5000, "max"])
        daemon = self.daemon([self.replay(rate=rate)], directory=directory).start()
        daemon.until(lambda: daemon.device()["lines"] > 0, "lines come")
        end = time.monotonic() + rng.uniform(0, 1.0)
        device = daemon.device()
        while time.monotonic() < end:
            device = daemon.device()
        daemon.kill()

        recorded = 0
        if daemon.files():
            (path,) = daemon.files()
            before = Recording(path)
            before.check_order(self)
            recorded = before.lines
        self.assertGreaterEqual(recorded, device["lines_written"], "a closed group is in the file")
        missing = device["lines"] - device["queue"]["depth"] - recorded
        self.assertLessEqual(missing, GROUP_LINES)
        if rate != "max":
            self.assertLessEqual(missing, max(1, 0.6 * rate), "group_ms, twice for a busy machine")

        # The next start completes the file and changes no group in it.
        again = self.daemon([], directory=directory).start()
        again.stop(self)
        if recorded:
            after = self.check_sound(path)
            self.assertEqual(after.groups, before.groups)
            self.assertIn("completed after an unclean end", again.log_text())
        return max(0, missing)


class Refusals(DaemonTest):
    def test_two_daemons_on_one_directory(self):
        first = self.daemon([]).start()
        other = os.path.join(self.folder, "other")
        os.mkdir(other)
        second = Daemon(other, [], directory=first.directory).start(wait=False)
        self.assertEqual(second.process.wait(20), 69)
        self.assertIn("another daemon records into this directory", second.log_text())
        self.assertIsNotNone(first.status())
        first.stop(self)

    def test_two_daemons_on_one_socket(self):
        first = self.daemon([]).start()
        other = os.path.join(self.folder, "other")
        os.mkdir(other)
        second = Daemon(other, [])
        second.socket = first.socket
        second.configure([])
        second.start(wait=False)
        self.assertEqual(second.process.wait(20), 69)
        self.assertIn("another daemon answers there", second.log_text())
        first.stop(self)

    def run_daemon(self, *arguments):
        return subprocess.run([DAEMON, *arguments], capture_output=True, text=True, timeout=60)

    def test_check_config(self):
        good = self.daemon([self.replay()])
        result = self.run_daemon("--config", good.config, "--check-config")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        with open(good.config, "a") as out:
            out.write("rat = 5\n")
        result = self.run_daemon("--config", good.config, "--check-config")
        self.assertEqual(result.returncode, 78)
        with open(good.config) as file:
            row = len(file.readlines())
        self.assertEqual(result.stderr, f'scansiond: {good.config}:{row}:1: unknown key "rat"; nearest is "rate"\n')
        self.assertFalse(os.path.exists(good.directory), "checking makes nothing")

    def test_exit_codes(self):
        self.assertEqual(self.run_daemon("--config", "/nonexistent.toml").returncode, 78)
        self.assertEqual(self.run_daemon("--nonsense").returncode, 2)
        self.assertEqual(self.run_daemon("--version").returncode, 0)
        self.assertEqual(self.run_daemon("--config", "/dev/null", "--log-level", "loud").returncode, 2)

    def test_printed_configuration_is_accepted(self):
        daemon = self.daemon([self.replay(rate=12.5)])
        printed = self.run_daemon("--config", daemon.config, "--print-config")
        self.assertEqual(printed.returncode, 0)
        with open(daemon.config, "w") as out:
            out.write(printed.stdout)
        again = self.run_daemon("--config", daemon.config, "--print-config")
        self.assertEqual(again.stdout, printed.stdout)

    def test_directory_that_cannot_be_made(self):
        daemon = self.daemon([], directory="/proc/scansion").start(wait=False)
        self.assertIn(daemon.process.wait(20), (73, 74, 77, 65))
        self.assertIn("/proc/scansion: cannot make the recording directory", daemon.log_text())


class DiskFull(DaemonTest):
    def test_full_disk_loses_nothing(self):
        disk = os.path.join(self.folder, "disk")
        os.mkdir(disk)
        if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=256k", "none", disk]).returncode != 0:
            self.skipTest("SKIPPED: needs the right to mount a tmpfs")
        self.addCleanup(subprocess.run, ["umount", disk])
        scan = self.scan(20000)
        daemon = self.daemon([self.replay()], directory=disk).start()
        device = daemon.until(lambda: (d := daemon.device()) and d["blocked"] and d, "blocked")
        self.assertIn("No space left", device["blocked"])
        self.assertIn("No space left", daemon.status()["recording"]["blocked"])
        self.assertEqual(subprocess.run(["mount", "-o", "remount,size=64m", disk]).returncode, 0)
        device = daemon.until_written(20000)
        self.assertEqual(device["lost_lines"], 0)
        daemon.stop(self)
        (path,) = daemon.files()
        recording = self.check_sound(path)
        recording.check_order(self)
        self.assertEqual(recording.lines, 20000)
        self.check_points(path, scan)

    def test_stop_on_a_full_disk(self):
        disk = os.path.join(self.folder, "disk")
        os.mkdir(disk)
        if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=256k", "none", disk]).returncode != 0:
            self.skipTest("SKIPPED: needs the right to mount a tmpfs")
        self.addCleanup(subprocess.run, ["umount", disk])
        self.scan(20000)
        daemon = self.daemon([self.replay()], directory=disk).start()
        device = daemon.until(lambda: (d := daemon.device()) and d["blocked"] and d, "blocked")
        daemon.stop(self)
        self.assertIn("are lost", daemon.log_text())
        (path,) = daemon.files()
        self.assertGreaterEqual(Recording(path).lines, device["lines_written"])
        # With room again the next start completes it.
        subprocess.run(["mount", "-o", "remount,size=64m", disk], check=True)
        self.daemon([], directory=disk).start().stop(self)
        self.check_sound(path).check_order(self)

    def test_little_free_space(self):
        self.scan(200)
        daemon = self.daemon([self.replay()], recording="")
        with open(daemon.config) as file:
            text = file.read().replace("min_free_mb = 0", "min_free_mb = 1000000000")
        with open(daemon.config, "w") as file:
            file.write(text)
        daemon.start()
        device = daemon.until(lambda: (d := daemon.device()) and d["blocked"] and d, "blocked")
        self.assertIn("min_free_mb", device["blocked"])
        self.assertEqual(daemon.files(), [])
        time.sleep(1.2)
        self.assertEqual(daemon.device()["lost_lines"], 0, "a scan at its end waits for the disk")
        daemon.stop(self)
        self.assertIn("200 lines in 4 groups are lost", daemon.log_text())


class Reload(DaemonTest):
    def test_changed_devices_restart_and_others_go_on(self):
        self.scan(20000)
        kept, changed, removed = self.replay("kept", rate=300), self.replay("changed", rate=300), self.replay("removed", rate=300)
        daemon = self.daemon([kept, changed, removed]).start()
        for name in ("kept", "changed", "removed"):
            daemon.until_written(1, name)
        before = daemon.device("kept")
        daemon.configure([kept, dict(changed, rate=200), self.replay("new", rate=300)])
        daemon.signal(signal.SIGHUP)
        daemon.until_written(1, "new")
        after = daemon.device("kept")
        self.assertEqual(after["recording"]["path"], before["recording"]["path"])
        self.assertGreater(after["lines"], before["lines"])
        self.assertIsNone(daemon.device("removed"))
        self.assertTrue(self.check_sound(daemon.files("removed")[0]).complete)
        daemon.until(lambda: len(daemon.files("changed")) == 2, "the changed device has a second recording")
        self.assertIn("1 devices unchanged, 2 stopped, 2 started", daemon.log_text())
        daemon.stop(self)
        for name in ("kept", "changed", "new"):
            for path in daemon.files(name):
                self.check_sound(path)

    def test_wrong_configuration_is_refused(self):
        self.scan(20000)
        daemon = self.daemon([self.replay(rate=300)]).start()
        path = daemon.until_written(1)["recording"]["path"]
        with open(daemon.config, "a") as out:
            out.write("rat = 5\n")
        daemon.signal(signal.SIGHUP)
        daemon.until(lambda: 'unknown key "rat"' in daemon.log_text(), "the refusal is logged")
        self.assertEqual(daemon.device()["recording"]["path"], path)
        daemon.stop(self)


@unittest.skipUnless(os.environ.get("SCANSION"), "needs the scansion tool")
class Tail(DaemonTest):
    def test_lines_and_events_as_they_happen(self):
        self.scan(400)
        daemon = self.daemon([self.replay(rate=200)]).start()
        tails = {topic: subprocess.Popen([os.environ["SCANSION"], "tail", topic, "--json", "--socket", daemon.socket],
                                         stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for topic in ("lines", "events")}
        daemon.until_state("finished")
        daemon.stop(self)
        rows = {topic: [json.loads(row) for row in tail.communicate(timeout=20)[0].splitlines()] for topic, tail in tails.items()}
        self.assertEqual([tail.returncode for tail in tails.values()], [69, 69], "the daemon is gone")
        indexes = [row["line"] for row in rows["lines"]]
        self.assertGreater(len(indexes), 64)
        self.assertEqual(indexes, list(range(indexes[0], 400)), "lines in order, none left out")
        self.assertEqual({row["points"] for row in rows["lines"]}, {20})
        self.assertIn("recording finished", [row["event"] for row in rows["events"]])
        self.assertIn("finished", [row.get("state") for row in rows["events"]])


class Notify(DaemonTest):
    def test_ready_watchdog_stopping(self):
        path = os.path.join(self.folder, "notify")
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listener:
            listener.bind(path)
            listener.settimeout(20)
            daemon = self.daemon([self.replay()], env={"NOTIFY_SOCKET": path, "WATCHDOG_USEC": "400000"})
            daemon.start()  # its only device is absent: ready all the same
            seen = []
            while "WATCHDOG=1" not in seen or not any(s.startswith("STATUS=") for s in seen):
                seen.append(listener.recv(4096).decode())
            self.assertEqual(seen[0], "READY=1")
            daemon.stop(self)
            while seen[-1] != "STOPPING=1":
                seen.append(listener.recv(4096).decode())


if __name__ == "__main__":
    unittest.main(verbosity=2)
