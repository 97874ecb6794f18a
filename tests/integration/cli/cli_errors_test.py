# Bad input and bad outputs: a clear message that names file and row, the documented exit code, and nothing left behind.
# SPDX-License-Identifier: Apache-2.0

import gzip
import io
import lzma
import os
import random
import re
import resource
import shutil
import signal
import stat
import subprocess
import tarfile
import time

from cli_kit import Failure, Skip, check, is_root, run_cases, same, skip_part
from reference import read_counts

VERBS = ("compress", "export", "info", "verify", "recover", "compare", "view", "status", "tail", "devices", "record", "stop", "start",
         "completion")
STOPPED = 130  # by SIGINT or SIGTERM


class Place:
    """A folder for one case, with a good scan and its recording outside of it."""

    def __init__(self, kit, name):
        self.kit = kit
        self.folder = kit.folder(name)
        self.scan = kit.scan_files()[0]
        self.recording = os.path.join(kit.root, name + ".mcap")
        kit.compress(self.scan, self.recording)

    def path(self, name):
        return os.path.join(self.folder, name)

    def file(self, name, data):
        with open(self.path(name), "wb") as file:
            file.write(data if isinstance(data, bytes) else data.encode())
        return self.path(name)

    def refused(self, code, *words, **more):
        return self.kit.refused(code, *words, folders=[self.folder], **more)

    def bad_scan(self, source, *words, says=(), code=65, **more):
        """compress refuses `source`."""
        return self.refused(code, "compress", source, "-o", self.path("out.mcap"), *words, says=says, **more)

    def readers(self, file):
        """Every verb that reads a recording, on `file`."""
        return (["export", file, "-o", self.path("out.xyz")], ["export", file, "-o", self.path("out.ply")],
                ["export", file, "-o", self.path("out.txt"), "--what", "rearrangement"],
                ["export", file, "-o", self.path("cut.mcap"), "--level", "0"], ["info", file], ["info", file, "--json"],
                ["verify", file], ["verify", file, "--json"], ["recover", file, "-o", self.path("recovered.mcap")],
                ["compare", file, self.recording], ["compare", self.recording, file, "--json"])


def missing_input(kit):
    place = Place(kit, "missing")
    gone = place.path("gone.xyz")
    place.bad_scan(gone, says=gone)
    place.refused(65, "compress", place.scan, gone, "-o", place.path("out.mcap"), says=gone)
    place.bad_scan(place.file("plain", "0 0 0\n") + "/in-a-file.xyz", says="in-a-file.xyz")
    for words in place.readers(place.path("gone.mcap")):
        place.refused(65, *words, says="gone.mcap")


def empty_input(kit):
    place = Place(kit, "empty")
    for name, data in (("empty.xyz", b""), ("blank.xyz", b"\n\n \n"), ("comment.csv", b"# nothing\n"), ("empty.gz", gzip.compress(b"")),
                       ("heading.csv", b"x,y,z\n"), ("none.ply", ply_header(0, "ascii"))):
        source = place.file(name, data)
        place.bad_scan(source, says=source)
    place.bad_scan("-", stdin=b"", says="-")
    place.bad_scan("/dev/null", says="/dev/null")
    for words in place.readers(place.file("empty.mcap", b"")):
        place.refused(65, *words, says="empty.mcap")


def binary_garbage(kit):
    place = Place(kit, "garbage")
    generator = random.Random(41)
    for size in (1, 7, 100, 5000, 300000):
        data = generator.randbytes(size)
        for ending in ("xyz", "csv", "ply", "dat"):
            source = place.file(f"garbage-{size}.{ending}", data)
            place.bad_scan(source, says=source)
        place.bad_scan("-", stdin=data)
        for words in place.readers(source):
            place.refused(65, *words, says=source)
    # Text that turns binary far behind the start, and a recording that is none behind its first bytes.
    with open(place.scan, "rb") as file:
        text = file.read()
    place.bad_scan(place.file("turns.xyz", text + b"\n\x00\x01\x02\x03\n"), says=f"turns.xyz:{text.count(bytes([10])) + 2}")
    with open(place.recording, "rb") as file:
        start = file.read(64)
    for words in place.readers(place.file("start.mcap", start + generator.randbytes(5000))):
        if words[0] == "verify":
            same(kit.scansion(*words, expect=None).code in (1, 65), True, f"verify of {words[1]}")
        else:
            place.refused(65, *words, says="start.mcap")
    place.bad_scan(place.recording, says=place.recording)  # a recording is no scan


def invalid_samples(kit):
    """NaN and infinities are normal: counted, and a line is split there. Only when nothing is left there is nothing to record."""
    place = Place(kit, "invalid")
    rows = ["0 0 0", "1 0 0", "nan nan nan", "nan 1 2", "2 0 0", "", "NaN NaN NaN", "", "0 1 inf", "0 2 0", "1 2 -inf", "2 2 0", "3 2 NAN"]
    source = place.file("scan.xyz", "\n".join(rows) + "\n")
    recording = kit.compress(source, place.path("scan.mcap"))
    info = kit.info(recording)
    same([info[key] for key in ("lines", "points", "runs", "invalid")], [3, 5, 4, 6], "lines, points, runs, invalid samples")
    kit.scansion("export", recording, "-o", place.path("out.xyz"))
    same(read_counts(place.path("out.xyz"), 0), [[(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 2, 0), (2, 2, 0)]], "points")
    kit.scansion("export", recording, "-o", place.path("out.txt"), "--what", "rearrangement")
    with open(place.path("out.txt"), encoding="ascii") as file:
        headings = [row.strip() for row in file if row.startswith("#")]
    same(headings, [f"# line {a} run {b} n+1 {n}" for a, b, n in ((0, 0, 2), (0, 1, 1), (2, 0, 1), (2, 1, 1))], "runs")
    # Empty fields of a CSV are invalid samples as well.
    table = place.file("scan.csv", "x,y,z,line\n0,0,0,0\n1,0,,0\n2,0,0,0\n")
    same(kit.info(kit.compress(table, recording))["invalid"], 1, "an empty field")
    # So does a step that is longer than --gap.
    steps = place.file("steps.xyz", "0 0 0\n1 0 0\n3 0 0\n4 0 0\n5.001 0 0\n")
    for gap, runs in (("1", 3), ("1.0005", 3), ("1.001", 2), ("2", 1)):
        same(kit.info(kit.compress(steps, recording, "--gap", gap))["runs"], runs, f"runs with --gap {gap}")
    os.remove(recording)
    for name, data in (("all.xyz", "nan nan nan\n" * 5), ("lines.xyz", "nan nan nan\n\ninf 0 0\n"), ("fields.csv", "x,z\n,\n,\n")):
        place.bad_scan(place.file(name, data), says=name)


def huge_numbers(kit):
    place = Place(kit, "huge")
    for number in ("1e300", "-1e300", "1e13", "99999999999999999999999999", "1e99999"):
        source = place.file("huge.xyz", f"0 0 0\n1 0 0\n\n# remark\n0 {number} 0\n")
        place.bad_scan(source, says="huge.xyz:5")
    place.bad_scan(place.file("metres.xyz", "0 0 0\n1e10 0 0\n"), "--unit", "m", says="metres.xyz:2")
    # Far behind the part that is looked at first.
    place.bad_scan(place.file("late.xyz", "0 0 0\n" * 1000000 + "0 0 1e300\n"), says="late.xyz:1000001")
    # More than 2^32 counts of the lattice that was asked for.
    place.bad_scan(place.file("wide.xyz", "0 0 0\n5000000.000 0 0\n0.001 0 0\n"), "--resolution", "0.001", says="wide.xyz:")


def wrong_rows(kit):
    place = Place(kit, "rows")
    for name, data, row in (("two.xyz", "0 0 0\n1 0\n2 0 0\n", 2), ("one.xyz", "0 0 0\n\n5\n", 3), ("word.xyz", "0 0 0\n0 zero 0\n", 2),
                            ("heading.xyz", "x y z\n0 0 0\n", 1), ("comma.xyz", "0,0,0\n1,5;2,5;3,5\n", 2), ("hex.xyz", "0 0 0x10\n", 1),
                            ("dots.xyz", "1.2.3 0 0\n", 1), ("few.csv", "x,y,z\n1,2,3\n1,2\n", 3), ("one.csv", "1\n2\n", 1),
                            ("names.csv", "a,b,c\n1,2,3\n", 1), ("exponent.xyz", "1e 0 0\n", 1), ("signs.xyz", "--1 0 0\n", 1)):
        place.bad_scan(place.file(name, data), says=f"{name}:{row}")
    late = "".join(f"{i} 0 0\n" for i in range(400000)) + "400000 0\n"
    place.bad_scan(place.file("late.xyz", late), says="late.xyz:400001")
    place.bad_scan("-", stdin=b"0 0 0\n1 0\n", says="-:2")
    place.bad_scan(place.file("long-row.xyz", "0 0 0" + " " * 100000 + "\n"), says="long-row.xyz:1")
    place.bad_scan(place.file("late.csv", "1,2\n" * 5 + "1,x\n"), says="late.csv:6")


def ply_header(count, form, kind="float", extra=""):
    return (f"ply\nformat {form} 1.0\nelement vertex {count}\n" + "".join(f"property {kind} {a}\n" for a in "xyz") +
            f"property int line\n{extra}end_header\n").encode()


def wrong_ply(kit):
    place = Place(kit, "ply")
    little = "binary_little_endian"
    grid = "obj_info num_cols 2\nobj_info num_rows 2\nelement range_grid {}\nproperty list uchar int vertex_indices\n"
    for name, data in (
            ("no-end", b"ply\nformat ascii 1.0\nelement vertex 1\n"), ("short", ply_header(3, "ascii") + b"0 0 0 0\n1 0 0 0\n"),
            ("cut", ply_header(3, little) + bytes(40)), ("many", ply_header(4000000000, little) + bytes(160)),
            ("most", ply_header(2**64 - 1, little) + bytes(160)), ("negative", ply_header(-1, little)), ("word", ply_header("ten", "ascii")),
            ("format", ply_header(1, "text")), ("type", ply_header(1, little, "quad")),
            ("no-lines", b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n"),
            ("no-x", b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float y\nproperty int line\nend_header\n0 0\n"),
            ("number", ply_header(1, "ascii") + b"0 none 0 0\n"), ("fields", ply_header(1, "ascii") + b"0 0 0\n"),
            ("grid", ply_header(1, "ascii", extra=grid.format(4)) + b"0 0 0 0\n" + b"1 0\n0\n1 1\n0\n"),
            ("grid-count", ply_header(1, "ascii", extra=grid.format(5)) + b"0 0 0 0\n" + b"1 0\n" * 5),
            ("grid-huge", ply_header(1, little, extra=grid.replace("2", "4000000000").format(16 * 10**18)) + bytes(16))):
        place.bad_scan(place.file(f"{name}.ply", data), says=f"{name}.ply")


def damaged_packing(kit):
    place = Place(kit, "packing")
    with open(place.scan, "rb") as file:
        text = file.read()
    archive = io.BytesIO()
    with tarfile.open(fileobj=archive, mode="w") as tar:
        entry = tarfile.TarInfo("scan.xyz")
        entry.size = len(text)
        tar.addfile(entry, io.BytesIO(text))
    tar = archive.getvalue()
    for name, packed in (("scan.xyz.gz", gzip.compress(text)), ("scan.xyz.xz", lzma.compress(text)), ("scans.tar", tar),
                         ("scans.tar.gz", gzip.compress(tar)), ("scans.tar.xz", lzma.compress(tar))):
        place.bad_scan(place.file("cut-" + name, packed[:len(packed) // 2]), says=name)
        if not name.endswith("tar"):  # plain tar has no checksum of its content
            middle = len(packed) // 2
            place.bad_scan(place.file("flipped-" + name, packed[:middle] + bytes([packed[middle] ^ 255]) + packed[middle + 1:]), says=name)
    # 2 GB of zero bytes in 2 MB are told apart at once.
    bomb = place.path("bomb.xyz.gz")
    with gzip.open(bomb, "wb", compresslevel=1) as file:
        for _ in range(256):
            file.write(bytes(1 << 20))
    outcome = place.bad_scan(bomb, says="bomb.xyz.gz")
    check(outcome.seconds < 60, f"{outcome} took {outcome.seconds} s")


def folder_without_scans(kit):
    place = Place(kit, "folder")
    inner = os.path.join(place.folder, "papers")
    os.makedirs(os.path.join(inner, "deep"))
    place.bad_scan(inner, says=inner)
    with open(os.path.join(inner, "deep", "paper.pdf"), "wb") as file:
        file.write(b"%PDF")
    place.bad_scan(inner, says=inner)
    for words in place.readers(inner):
        place.refused(65, *words, says=inner)


def sparse_file(kit):
    """2 GB of nothing: known for what it is at once, not after reading it all into memory."""
    place = Place(kit, "sparse")
    hole = place.path("hole.xyz")
    with open(hole, "wb") as file:
        file.truncate(2 << 30)
    text = place.file("text-then-hole.xyz", "0 0 0\n1 0 0\n")
    os.truncate(text, 2 << 30)
    for source, says in ((hole, hole), (text, text + ":3")):
        bounded(place.bad_scan(source, says=says), 10, kit)
        bounded(place.bad_scan(source, "--format", "csv", says=source), 10, kit)
    for words in place.readers(hole):
        if words[0] == "recover" and not kit.long:
            os.truncate(hole, 64 << 20)  # it looks for groups in all of it
        bounded(place.refused(65, *words, says=hole), 60, kit)
    # A good recording with a hole behind it: what it holds is still there.
    recording = shutil.copy(place.recording, place.path("recording.mcap"))
    os.truncate(recording, 2 << 30)
    bounded(kit.scansion("verify", recording, expect=1), 60, kit)
    out = place.path("recovered.mcap")
    bounded(kit.scansion("recover", recording, "-o", out, expect=None), 60, kit)
    kit.scansion("verify", out)
    kit.scansion("compare", out, place.recording)


def bounded(outcome, seconds, kit):
    check(kit.sanitized or outcome.seconds < seconds, f"{outcome} took {outcome.seconds:.1f} s")
    check(kit.sanitized or outcome.peak_kib < 256 * 1024, f"{outcome} took {outcome.peak_kib / 1024:.0f} MiB")
    return outcome


def line_of_three_million_points(kit):
    place = Place(kit, "long-line")
    generator = random.Random(43)
    thousand = "".join(f"#{i:03d} 0 {generator.randrange(1, 10)}\n" for i in range(1000))
    body = "".join(thousand.replace("#", str(i)) for i in range(1, 3001))
    source = place.file("long.xyz", body)
    recording = place.path("long.mcap")
    first = kit.scansion("compress", source, "-o", recording)
    out = place.path("out.xyz")
    second = kit.scansion("export", recording, "-o", out)
    with open(out, encoding="ascii") as file:
        file.readline()
        check(file.read() == body, "other points than went in")
    third = kit.scansion("export", recording, "-o", out, "--force", "--reduction", "95")
    check("kept 150001 of 3000000 points" in third.err, str(third))
    print(f"  3 million points in a line: compress {first.peak_kib >> 10} MiB, export {second.peak_kib >> 10} MiB, "
          f"--reduction 95 {third.peak_kib >> 10} MiB")
    same(kit.scansion("compress", source, "-o", recording, "--force", "--gap", "0.5", "--json").json()["points"], 3000000, "points")
    # The longest line that is taken is 2^22 points; a scan without blank lines is told so.
    place.bad_scan(place.file("over.xyz", "0 0 0\n" * ((1 << 22) + 1)), says=f"over.xyz:{(1 << 22) + 1}")


def usage(kit):
    place = Place(kit, "usage")
    out = place.path("out.mcap")
    place.refused(2)
    place.refused(2, "frobnicate", says="frobnicate")
    place.refused(2, "--frobnicate")
    for words in (["compress", place.scan, "-o", out], ["export", place.recording, "-o", out], ["info", place.recording],
                  ["verify", place.recording], ["recover", place.recording, "-o", out], ["compare", place.recording, place.recording],
                  ["status"], ["completion", "bash"]):
        place.refused(2, *words, "--frobnicate", says="--frobnicate")
        check(b"--help" in kit.scansion(words[0], "--help").out, f"{words[0]} --help")
    for verb in ("compress", "export", "info", "verify", "recover", "compare", "stop", "start", "completion"):
        place.refused(2, verb)
    place.refused(2, "compress", place.scan)
    place.refused(2, "compare", place.recording)
    for words in (["--levels", w] for w in ("", "geometric", "geometric:", "geometric:0", "geometric:17", "geometric:3:1", "geometric:3:x",
                                            "uniform:3:0", "uniform:3:-1", "uniform:x", "explicit:", "explicit:1,2", "explicit:1,1",
                                            "explicit:1,0", "explicit:-1", "explicit:1,,0.5", "explicit:nan", "explicit:inf", "linear:3",
                                            "explicit:" + ",".join(str(20 - i) for i in range(17)))):
        place.bad_scan(place.scan, *words, code=2)
    for words in (["--floor", w] for w in ("", "0", "-1", "nan", "most")):
        place.bad_scan(place.scan, *words, code=2)
    for words in (["--unit", "parsec"], ["--resolution", "0"], ["--resolution", "-1"], ["--resolution", "fine"], ["--gap", "0"],
                  ["--gap", "-1"], ["--gap", "nan"], ["--threads", "-1"], ["--threads", "many"], ["--format", "las"], ["--grid", "diagonal"],
                  ["--spacing", "0"], ["--features", "maybe"], ["--columns", "q"], ["--device", "a/b"], ["--device", ""]):
        place.bad_scan(place.scan, *words, code=2)
    for word in ("0", "-1", "nan", "inf", "wide", ""):
        place.refused(2, "compress", place.scan, "-o", out, "--gap", word, says=f"'{word}' is no number above 0")
    place.refused(2, "compress", "-", "-", "-o", out, stdin=b"0 0 0\n")
    place.refused(2, "compare", "-", "-")
    # Figures behind a recording would make it a damaged one.
    place.refused(2, "compress", place.scan, "-o", "-", "--json", says="--json")
    place.refused(2, "recover", place.recording, "-o", "-", "--json", says="--json")
    # A rearrangement is text, whatever the ending of the file promises.
    for name, words in (("out.ply", []), ("out.json", []), ("out.vtp", []), ("out.mcap", []), ("out.txt", ["--format", "pcd"]),
                        ("out.txt", ["--format", "svg"])):
        place.refused(2, "export", place.recording, "--what", "rearrangement", "-o", place.path(name), *words, says="text")
    for name, words in (("out.foo", []), ("out", []), ("out.xyz", ["--format", "las"]), ("out.xyz", ["--unit", "parsec"]),
                        ("out.xyz", ["--what", "everything"]), ("out.mcap", ["--tolerance", "1"]), ("out.mcap", ["--lines", "1:2"]),
                        ("out.mcap", ["--level", "9"]), ("out.mcap", ["--unit", "in"]), ("out.mcap", ["--float32"])):
        place.refused(2, "export", place.recording, "-o", place.path(name), *words)
    place.refused(2, "compare", place.recording, place.recording, "--tolerance", "-1")
    place.refused(2, "compare", place.recording, place.recording, "--what", "everything")
    place.refused(2, "completion", "tcsh")


def outputs_that_cannot_be(kit):
    place = Place(kit, "outputs")
    makers = lambda out: (["compress", place.scan, "-o", out], ["export", place.recording, "-o", out, "--format", "xyz"],
                          ["export", place.recording, "-o", out, "--format", "ply"], ["recover", place.recording, "-o", out],
                          ["export", place.recording, "-o", out, "--format", "mcap", "--level", "0"],
                          ["export", place.recording, "-o", out, "--what", "rearrangement"])
    there = place.file("there", b"precious")
    for words in makers(there):
        place.refused(73, *words, says=[there, "--force"])
        with open(there, "rb") as file:
            same(file.read(), b"precious", f"the file that was there after {words[0]}")
    for words in makers(place.path("no/such/folder")):
        place.refused(73, *words, says="no/such/folder")
    for words in makers(place.folder):
        place.refused(73, *words, says=place.folder)
        place.refused(73, *words, "--force", says=place.folder)
    for words in makers(os.path.join(there, "below-a-file")):
        place.refused(73, *words, says="below-a-file")
    # With --force the file is replaced, but only by a whole one.
    bad = place.file("bad.xyz", "0 0 0\n1 0\n")
    place.refused(65, "compress", bad, "-o", there, "--force", says="bad.xyz:2")
    with open(there, "rb") as file:
        same(file.read(), b"precious", "the file that was to be replaced by a bad scan")
    for words in makers(there):
        kit.scansion(*words, "--force")
        check(os.path.getsize(there) > 100, f"{words[0]} --force replaced nothing")
    same(sorted(os.listdir(place.folder)), ["bad.xyz", "there"], "files left")


def inputs_stay(kit):
    """A scan cannot be repeated: no output replaces what is read, under whatever name, not even with --force."""
    place = Place(kit, "inputs")
    scan, recording = place.path("scan.xyz"), place.path("scan.mcap")
    shutil.copy(place.scan, scan)
    shutil.copy(place.recording, recording)
    os.symlink(scan, place.path("link.xyz"))
    os.link(recording, place.path("link.mcap"))
    before = {path: open(path, "rb").read() for path in (scan, recording)}
    for words in (["compress", scan, "-o", scan], ["compress", scan, "-o", place.path("link.xyz")],
                  ["compress", place.scan, scan, "-o", scan], ["recover", recording, "-o", recording],
                  ["recover", recording, "-o", place.path("link.mcap")], ["export", recording, "-o", recording, "--level", "0"],
                  ["export", recording, "-o", recording, "--format", "xyz"], ["view", recording, "-o", recording, "--format", "png"],
                  ["export", recording, "-o", recording, "--what", "features", "--format", "txt"]):
        place.refused(73, *words, "--force", says="is the input itself")
    with open(scan, "rb") as file:
        place.refused(73, "compress", "-", "-o", scan, "--force", stdin=file, says="is the input itself")
    for path, data in before.items():
        with open(path, "rb") as file:
            check(file.read() == data, f"{path} was changed")


def special_files_stay(kit):
    """A pipe or device named as output is written to or refused, never replaced by a file of its name, not even with --force."""
    place = Place(kit, "special")
    fifo = place.path("pipe")
    os.mkfifo(fifo)
    reader = os.open(fifo, os.O_RDONLY | os.O_NONBLOCK)  # so that an opened pipe does not wait
    try:
        for words in (["compress", place.scan], ["recover", place.recording], ["export", place.recording, "--format", "mcap"],
                      ["export", place.recording, "--format", "ply"]):
            kit.scansion(*words, "-o", fifo, "--force", expect=None)
            check(stat.S_ISFIFO(os.stat(fifo).st_mode), f"{words[0]} --force replaced a pipe by a file")
    finally:
        os.close(reader)
    same(os.listdir(place.folder), ["pipe"], "files left")


def full_standard_output(kit):
    """An answer that nobody can have got is no success."""
    if not os.path.exists("/dev/full"):
        raise Skip("no /dev/full")
    place = Place(kit, "stdout")
    wrong = []
    for words in (["export", place.recording, "-o", "-"], ["export", place.recording, "-o", "-", "--format", "ply"],
                  ["export", place.recording, "-o", "-", "--what", "rearrangement"], ["compress", place.scan, "-o", "-"],
                  ["info", place.recording], ["info", place.recording, "--json"], ["verify", place.recording],
                  ["verify", place.recording, "--json"], ["compare", place.recording, place.recording], ["completion", "bash"],
                  ["compress", place.scan, "-o", place.path("out.mcap"), "--force", "--json"]):
        with open("/dev/full", "wb") as full:
            process = kit.start("scansion", *words, stdout=full, stderr=subprocess.PIPE)
            message = process.communicate(timeout=60)[1].decode()
        if process.returncode != 74 or not message.strip():
            wrong.append(f"`{' '.join(words)}` exit {process.returncode}")
    check(not wrong, f"with a full disk behind standard output, expected exit 74 and a message: {'; '.join(wrong)}")
    kit.check_no_temporary_files()


def full_disk(kit):
    """Writing fails in the middle: by a limit on the file size, and on a small file system."""
    place = Place(kit, "disk")
    source = kit.scene(os.path.join(kit.root, "disk.xyz"), "part", "--lines", 200, "--points", 400)
    big = kit.compress(source, os.path.join(kit.root, "big.mcap"))
    makers = (["compress", source, "-o", "out.mcap"], ["export", big, "-o", "out.xyz"], ["export", big, "-o", "out.ply"],
              ["export", big, "-o", "out.csv", "--reduction", "20", "--scope", "scan"], ["recover", big, "-o", "out.mcap"],
              ["export", big, "-o", "out.mcap", "--level", "3"], ["export", big, "-o", "out.txt", "--what", "rearrangement"])
    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
    for words in makers:
        place.refused(74, *words, cwd=place.folder, preexec_fn=limit, says="out")
    # The temporary file behind standard output counts too.
    for words in (["compress", source, "-o", "-"], ["export", big, "-o", "-", "--format", "ply"]):
        place.refused(74, *words, cwd=place.folder, preexec_fn=limit)
    if not is_root():
        return skip_part("a full file system: mounting one needs root")
    script = 'mount -t tmpfs -o size=48k none "$1" || exit 99; cd "$1"; shift; "$@" >&2; code=$?; ls -A; exit $code'
    for words in makers:
        command = ["unshare", "-m", "sh", "-c", script, "sh", place.folder, os.path.join(kit.bin, "scansion"), *words]
        done = subprocess.run(command, capture_output=True, text=True, env=kit.environment, timeout=60, check=False)
        if done.returncode == 99 or "unshare" in done.stderr:
            return skip_part(f"a full file system: {done.stderr.strip()}")
        same((done.returncode, done.stdout), (74, ""), f"exit code and files left by {words} on a full disk ({done.stderr.strip()})")
        check("No space left" in done.stderr, f"{words} on a full disk says {done.stderr}")
    kit.check_no_temporary_files()


def no_permission(kit):
    """As a user who may not read the input or write the folder."""
    place = Place(kit, "permission")
    secret = place.file("secret.xyz", "0 0 0\n")
    hidden = shutil.copy(place.recording, place.path("hidden.mcap"))
    closed = os.path.join(place.folder, "closed")
    os.mkdir(closed)
    opened = os.path.join(place.folder, "opened")
    os.mkdir(opened)
    scan = shutil.copy(place.scan, opened)
    program, more = os.path.join(kit.bin, "scansion"), {}
    if is_root():  # then permissions mean nothing: run a copy as nobody
        program = shutil.copy(program, opened)
        more = {"user": 65534, "group": 65534, "extra_groups": []}
        os.chmod(opened, 0o777)
        for folder in (kit.root, place.folder, kit.temporary):
            os.chmod(folder, 0o755)
    os.chmod(secret, 0)
    os.chmod(hidden, 0)
    os.chmod(closed, 0o555)

    def run(*words):
        return subprocess.run([program, *words], capture_output=True, text=True, env=kit.environment, timeout=60, check=False, **more)

    try:
        same(run("compress", scan, "-o", os.path.join(opened, "good.mcap")).returncode, 0, "a run with permission")
    except OSError as error:
        raise Skip(f"cannot run as another user: {error}") from error
    before = sorted(os.listdir(opened))
    for words in (["compress", secret, "-o", os.path.join(opened, "out.mcap")], ["info", hidden], ["verify", hidden],
                  ["export", hidden, "-o", os.path.join(opened, "out.xyz")], ["recover", hidden, "-o", os.path.join(opened, "out.mcap")],
                  ["compress", scan, "-o", os.path.join(closed, "out.mcap")],
                  ["export", os.path.join(opened, "good.mcap"), "-o", os.path.join(closed, "out.ply")]):
        done = run(*words)
        same(done.returncode, 77, f"exit code of {words} ({done.stderr.strip()})")
        same(done.stdout, "", f"standard output of {words}")
        check("ermission denied" in done.stderr, f"{words} says {done.stderr}")
    same((sorted(os.listdir(opened)), os.listdir(closed)), (before, []), "files left")


def stopped(kit, place, words, seconds, stdin=subprocess.DEVNULL, number=signal.SIGTERM):
    """Sends a signal after `seconds`; the tool must end within five more, with nothing left. False: it was done already."""
    before = sorted(os.listdir(place.folder))
    process = kit.start("scansion", *words, stdin=stdin, stderr=subprocess.PIPE, cwd=place.folder)
    try:
        time.sleep(seconds)
        done = process.poll() is not None
        process.send_signal(number)
        sent = time.monotonic()
        message = process.communicate(timeout=5)[1].decode().strip()
        after = time.monotonic() - sent
        if process.returncode == 0 and (done or after < 0.3):  # the signal came with the last byte
            return False
        # A signal that comes before main() runs ends the process by itself.
        early = process.returncode == -number and not message
        same(early or process.returncode == STOPPED, True, f"exit code {process.returncode} of `{' '.join(words)}` {after:.1f} s after a signal ({message})")
        same(sorted(os.listdir(place.folder)), before, f"files left by `{' '.join(words)}` after a signal ({message})")
        kit.check_no_temporary_files()
        return True
    except subprocess.TimeoutExpired:
        raise Failure(f"`{' '.join(words)}` still runs 5 s after signal {number}") from None
    finally:
        process.kill()
        process.communicate()
        for name in set(os.listdir(place.folder)) - set(before):
            os.remove(os.path.join(place.folder, name))


def stopped_by_a_signal(kit):
    place = Place(kit, "signal")
    source = kit.scene(os.path.join(kit.root, "signal.xyz"), "part", "--lines", 3000, "--points", 1000)
    big = kit.compress(source, os.path.join(kit.root, "signal-big.mcap"))
    failures = []
    for words in (["compress", source, "-o", "out.mcap"], ["compress", source, "-o", "-"], ["export", big, "-o", "out.xyz"],
                  ["export", big, "-o", "-", "--format", "ply"], ["export", big, "-o", "out.txt", "--what", "rearrangement"],
                  ["export", big, "-o", "out.xyz", "--reduction", "95", "--scope", "scan"], ["recover", big, "-o", "out.mcap"],
                  ["verify", big], ["compare", big, big]):
        try:
            hits = [stopped(kit, place, words, s, number=n) for s, n in ((0.02, signal.SIGTERM), (0.1, signal.SIGINT), (0.3, signal.SIGTERM))]
            check(any(hits), f"`{' '.join(words)}` was done before any signal")
        except Failure as failure:
            failures.append(str(failure))
    # Waiting for input that does not come.
    read, write = os.pipe()
    fifo = place.path("pipe")
    os.mkfifo(fifo)
    try:
        os.write(write, b"0 0 0\n" * 1000)
        for words in (["compress", "-", "-o", "out.mcap"], ["compress", "pipe", "-o", "out.mcap"]):
            try:
                check(stopped(kit, place, words, 0.3, stdin=read), f"`{' '.join(words)}` did not wait for its input")
            except Failure as failure:
                failures.append(str(failure))
    finally:
        os.close(read)
        os.close(write)
    check(not failures, "; ".join(failures))


def manual_page(kit):
    """docs/man/scansion.1 names every command and option that the program has, and no other."""
    page_path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../docs/man/scansion.1")
    with open(page_path, encoding="utf-8") as file:
        page = file.read().replace("\\-", "-")
    known = set()
    for verb in VERBS:
        check(f"scansion {verb}" in page, f"the manual page does not name {verb}")
        known |= set(re.findall(r"--[a-z0-9]+", kit.scansion(verb, "--help").out.decode()))
    known |= set(re.findall(r"--[a-z0-9]+", kit.scansion("--help").out.decode()))
    named = set(re.findall(r"--[a-z][a-z0-9]*", page))
    same((sorted(known - named), sorted(named - known)), ([], []), "options that are missing in the manual page, and too many")


def other_verbs(kit):
    """Without a daemon those who ask it say so; completions are scripts their shells accept."""
    for words in (["status"], ["stop", "table"], ["start", "table"]):
        kit.refused(69, *words, "--socket", os.path.join(kit.root, "no-socket"), says="no-socket")
    kit.refused(69, "status", "--json", "--socket", os.path.join(kit.root, "no-socket"))
    for shell in ("bash", "zsh", "fish"):
        script = kit.scansion("completion", shell).out
        for verb in VERBS:
            check(verb.encode() in script, f"completion {shell} does not know {verb}")
        if shutil.which(shell):
            subprocess.run([shell, "-n"], input=script, check=True, timeout=20)
        else:
            skip_part(f"syntax of the {shell} completion: {shell} is not installed")
    check(kit.scansion("--version").out.strip(), "no version")
    began = time.monotonic()
    recording = kit.compress(kit.scan_files()[0], os.path.join(kit.root, "pipe.mcap"))
    reader, writer = os.pipe()
    os.close(reader)  # before anything is written: the whole output fits into a pipe
    process = kit.start("scansion", "export", recording, "-o", "-", stdout=writer, stderr=subprocess.PIPE)
    os.close(writer)
    message = process.communicate(timeout=20)[1].decode()
    same(process.returncode, 74, f"exit code with a closed pipe ({message})")
    check(time.monotonic() - began < 20, "a closed pipe")


if __name__ == "__main__":
    run_cases("bad input and bad outputs", [
        missing_input, empty_input, binary_garbage, invalid_samples, huge_numbers, wrong_rows, wrong_ply, damaged_packing,
        folder_without_scans, sparse_file, line_of_three_million_points, usage, outputs_that_cannot_be, inputs_stay,
        special_files_stay,
        full_standard_output, full_disk, no_permission, stopped_by_a_signal, manual_page, other_verbs])
