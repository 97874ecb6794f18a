# Runs the command line tools in a private folder and judges what they do.
# SPDX-License-Identifier: Apache-2.0
"""Every script here is called as `python3 SCRIPT --bin DIR --recordings DIR [--long]`, where DIR of --bin holds scansion and
scansim. Exit 0: all passed (parts may be skipped, loudly); 77: everything was skipped; 1: something failed."""

import argparse
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import traceback


class Failure(Exception):
    """A promise that was not kept."""


class Skip(Exception):
    """Something the machine cannot do."""


def check(condition, message):
    if not condition:
        raise Failure(message)


def same(got, want, what):
    if got != want:
        raise Failure(f"{what}: got {clip(got)}, expected {clip(want)}")


def clip(value, length=400):
    text = value if isinstance(value, str) else repr(value)
    return text if len(text) <= length else text[:length] + f"... ({len(text)} characters)"


class OnlyLong(Exception):
    """Left out without --long."""


class Outcome:
    """What a finished program left: exit code, both outputs, seconds of wall time, peak memory."""

    def __init__(self, command, code, out, err, seconds, peak_kib):
        self.command, self.code, self.out, self.err = command, code, out, err
        self.seconds, self.peak_kib = seconds, peak_kib

    def __str__(self):
        return f"`{' '.join(self.command)}` exit {self.code}, stderr {clip(self.err.strip())}"

    def json(self):
        try:
            return json.loads(self.out)
        except ValueError as error:
            raise Failure(f"{self}: standard output is no JSON ({error}): {clip(self.out)}") from error


class Kit:
    """The tools, a temporary folder that goes away, and the cases of one script."""

    def __init__(self, arguments):
        self.bin = os.path.abspath(arguments.bin)
        self.recordings = os.path.abspath(arguments.recordings)
        self.long = arguments.long
        self.root = tempfile.mkdtemp(prefix="scansion-test-")
        # The tools' own temporary files; a case may look whether any are left.
        self.temporary = self.folder("tmp")
        self.environment = dict(os.environ, TMPDIR=self.temporary, NO_COLOR="1", LC_ALL="C")
        self.environment.pop("SCANSION_SOCKET", None)
        # Programs built with sanitizers are slow and large: figures of time and memory say nothing then.
        with open(os.path.join(self.bin, "scansion"), "rb") as file:
            self.sanitized = b"__asan_init" in file.read()

    def needs_long(self, what):
        if not self.long:
            raise OnlyLong(what)

    # Files

    def folder(self, name):
        path = os.path.join(self.root, name)
        os.makedirs(path)
        return path

    def scan_files(self):
        names = sorted(n for n in os.listdir(self.recordings) if n.endswith(".xyz"))
        check(names, f"{self.recordings} holds no .xyz file")
        return [os.path.join(self.recordings, n) for n in names]

    # Programs

    def start(self, program, *words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, **more):
        command = [os.path.join(self.bin, program), *map(str, words)]
        return subprocess.Popen(command, stdin=stdin, stdout=stdout, stderr=stderr, env=self.environment, **more)

    def run(self, program, *words, stdin=None, timeout=120, **more):
        """`stdin`: bytes, an open file, or nothing. Output goes to files, so nothing can block."""
        with tempfile.TemporaryFile(dir=self.root) as out, tempfile.TemporaryFile(dir=self.root) as err:
            source = subprocess.DEVNULL
            if isinstance(stdin, bytes):
                source = tempfile.TemporaryFile(dir=self.root)
                source.write(stdin)
                source.seek(0)
            elif stdin is not None:
                source = stdin
            began = time.monotonic()
            process = self.start(program, *words, stdin=source, stdout=out, stderr=err, **more)
            expired = threading.Event()
            timer = threading.Timer(timeout, lambda: (expired.set(), process.kill()))
            timer.start()
            try:
                _, status, usage = os.wait4(process.pid, 0)
            finally:
                timer.cancel()
            process.returncode = os.waitstatus_to_exitcode(status)
            if isinstance(stdin, bytes):
                source.close()
            out.seek(0)
            err.seek(0)
            outcome = Outcome([program, *map(str, words)], process.returncode, out.read(), err.read().decode(errors="replace"),
                              time.monotonic() - began, usage.ru_maxrss)
        if expired.is_set():
            raise Failure(f"`{' '.join(outcome.command)}` still ran after {timeout} s")
        return outcome

    def quick(self, *words):
        """As scansion() with any exit code, for thousands of short runs: pipes, no memory figure."""
        command = [os.path.join(self.bin, "scansion"), *map(str, words)]
        try:
            done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, env=self.environment, timeout=60, check=False)
        except subprocess.TimeoutExpired as error:
            raise Failure(f"`{' '.join(map(str, words))}` still ran after 60 s") from error
        return Outcome(["scansion", *map(str, words)], done.returncode, done.stdout, done.stderr.decode(errors="replace"), 0.0, 0)

    def scansion(self, *words, expect=0, **more):
        """Runs the tool; anything but the exit code `expect` is a failure (None: any)."""
        outcome = self.run("scansion", *words, **more)
        if expect is not None and outcome.code != expect:
            raise Failure(f"{outcome}; expected exit {expect}")
        return outcome

    def info(self, recording):
        return self.scansion("info", recording, "--json").json()

    def compress(self, source, recording, *words, **more):
        self.scansion("compress", source, "-o", recording, "--force", *words, **more)
        return recording

    def scene(self, path, name, *words):
        outcome = self.run("scansim", "scene", name, *words, "-o", path, timeout=600)
        check(outcome.code == 0, str(outcome))
        return path

    def refused(self, code, *words, says=(), folders=(), **more):
        """Runs the tool, which must end with `code`, say something on standard error that holds all of `says`, print nothing on
        standard output, and leave `folders` and the folder of temporary files as they were."""
        before = [sorted(os.listdir(f)) for f in (*folders, self.temporary)]
        outcome = self.scansion(*words, expect=code, **more)
        same(outcome.out, b"", f"{outcome}: standard output")
        check(outcome.err.strip(), f"{outcome}: says nothing")
        for text in [says] if isinstance(says, str) else says:
            check(text in outcome.err, f"{outcome}: the message does not hold {text!r}")
        same([sorted(os.listdir(f)) for f in (*folders, self.temporary)], before, f"{outcome}: files left")
        return outcome

    def check_no_temporary_files(self):
        same(os.listdir(self.temporary), [], "temporary files left")


def digest(path):
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest() if hasattr(hashlib, "file_digest") else hashlib.sha256(file.read()).hexdigest()


def skip_part(reason):
    print(f"SKIPPED part: {reason}", flush=True)


def is_root():
    return os.geteuid() == 0


def run_cases(description, cases):
    """Runs the functions `cases` with a Kit, in order; a failure does not stop the others."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--bin", required=True, help="folder of scansion and scansim")
    parser.add_argument("--recordings", required=True, help="folder of the small .xyz scans")
    parser.add_argument("--long", action="store_true", help="every byte, big inputs: minutes")
    parser.add_argument("--only", default="", help="run only the cases whose name holds this text")
    parser.add_argument("--keep", action="store_true", help="keep the temporary folder")
    arguments = parser.parse_args()
    for program in ("scansion", "scansim"):
        if not os.access(os.path.join(arguments.bin, program), os.X_OK):
            sys.exit(f"{arguments.bin}/{program} is not there; build it, or give its folder with --bin")
    kit = Kit(arguments)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    results = {"passed": 0, "FAILED": 0, "SKIPPED": 0, "left to --long": 0}
    try:
        for case in cases:
            if arguments.only not in case.__name__:
                continue
            began = time.monotonic()
            result, detail = "passed", ""
            try:
                case(kit)
            except Skip as reason:
                result, detail = "SKIPPED", f": {reason}"
            except OnlyLong as what:
                result, detail = "left to --long", f": {what}"
            except Failure as failure:
                result, detail = "FAILED", f": {failure}"
            except Exception:  # a broken check is a failure too, and the others still run
                result, detail = "FAILED", ":\n" + traceback.format_exc()
            results[result] += 1
            print(f"{result} {case.__name__} ({time.monotonic() - began:.1f} s){detail}", flush=True)
    finally:
        if arguments.keep:
            print(f"kept {kit.root}")
        else:
            shutil.rmtree(kit.root, ignore_errors=True)
    print(", ".join(f"{n} {name}" for name, n in results.items() if n), flush=True)
    if results["FAILED"] or not any(results.values()):
        sys.exit(1)
    sys.exit(77 if results["SKIPPED"] and not results["passed"] else 0)
