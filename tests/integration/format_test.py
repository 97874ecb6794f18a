# Decodes what `scansion compress` writes with the reader made from docs/FORMAT.md and compares it with `scansion export`.
# SPDX-License-Identifier: Apache-2.0
"""usage: format_test.py SCANSION RECORDINGS_FOLDER      exit 0: all the same; 1: something differs; 77: python3-zstandard is missing"""
import json
import math
import pathlib
import random
import struct
import subprocess
import sys
import tempfile
import traceback
from fractions import Fraction

try:
    import format_reader
    from format_container import FormatError
except ModuleNotFoundError as missing:
    if missing.name != "zstandard":
        raise
    print(f"SKIPPED: {sys.executable} has no module zstandard, so the format was NOT checked; install python3-zstandard",
          file=sys.stderr)
    sys.exit(77)

MM = {"m": 1000, "mm": 1, "um": Fraction(1, 1000), "in": Fraction(127, 5), "ft": Fraction(1524, 5)}


# Scans: a list of lines, a line a list of points, a point three texts or None for an invalid sample.

def xyz(lines):
    return "\n".join("".join(" ".join(p or ["nan"] * 3) + "\n" for p in line) for line in lines).encode()


def ply(lines, form):
    kind, points = {"f": "float", "d": "double"}[form], [(p, i) for i, line in enumerate(lines) for p in line]
    head = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
            + "".join(f"property {kind} {axis}\n" for axis in "xyz") + "property uint line\nend_header\n")
    return head.encode() + b"".join(struct.pack(f"<3{form}I", *map(float, p), i) for p, i in points)


def profile(rng, count, y, places=3, offset=(0, 0, 0)):
    """Steps, slopes and noise on a lattice of `places` decimals; some x go back."""
    unit, out = 10 ** -places, []
    for i in range(count):
        x = 0.1 * (i - (3 if rng.random() < 0.02 else 0))
        z = (3.0 if i > count // 2 else 0.01 * i) + (2.0 if count // 4 < i < count // 3 else 0) + rng.randrange(-5, 6) * unit
        out.append([f"{value + shift:.{places}f}" for value, shift in zip((x, y, z), offset)])
    return out


def messy(rng, lines):
    """Lines of 0 to 40 points with invalid samples anywhere, repeated points and far jumps."""
    out = []
    for y in range(lines):
        line = []
        for _ in range(rng.choice([1, 1, 2, 3, 5, 40])):
            point = [f"{rng.randrange(-9999, 9999) / 100:.2f}", f"{y}.5", f"{rng.choice([0, 1, 1, 250])}.25"]
            line += rng.choice([[point], [point], [point, point], [None, point], [point, None, None], [None]])
        out.append(line)
    return out


def fan(rng, beams, lines):
    """A sensor that turns: 180 degrees, whole centimetres, beams without an echo, some values that lie beside their beam."""
    out = []
    for y in range(lines):
        line = []
        for beam in range(beams):
            angle, reach = math.pi * (beam / (beams - 1) - 0.5), 0.01 * (300 + (150 if beam > beams // 2 else 0) + rng.randrange(4))
            if rng.random() > 0.05:
                beside = 0.001 if rng.random() < 0.01 else 0
                line.append([f"{reach * math.cos(angle):.6f}", f"{reach * math.sin(angle) + beside:.6f}", f"{y}"])
        out.append(line)
    return out


def raster(rng, points, lines):
    """Even abscissae, an edge that drifts from line to line, missing samples."""
    return [[None if rng.random() < 0.02 else
             [f"{0.1 * i:.1f}", f"{0.2 * y:.1f}", f"{(2 if i > points // 2 + y // 3 else 0) + 0.001 * rng.randrange(-9, 10):.3f}"]
             for i in range(points)] for y in range(lines)]


def ruled(rng, points, lines):
    """Rounded multiples of a pitch, points left out without a word."""
    return [[[f"{0.0371 * (1 + 0.001 * y) * i + 0.002 * y:.3f}", f"{0.2 * y:.1f}", f"{0.001 * rng.randrange(-9, 10):.3f}"]
             for i in range(points) if rng.random() > 0.03] for y in range(lines)]


def floats(rng, lines, form):
    """Numbers that lie on no lattice, negative and tiny ones included."""
    special = [0.0, -0.0, 1e-30, -1e-30, 0.1, -0.1, 5.0, -5.0]
    single = (lambda x: struct.unpack("f", struct.pack("f", x))[0]) if form == "f" else (lambda x: x)
    return [[[repr(single(x)) for x in (i / 7 - 3, rng.uniform(-1, 1), special[i] if i < 8 else math.sin(i / 9) + rng.gauss(0, 0.01))]
             for i in range(60)] for _ in range(lines)]


def cases(folder):
    """(name, ending, bytes, options, the lines when the recording must hold exactly these)"""
    for path in sorted(pathlib.Path(folder).glob("*.xyz")):
        lines = [[None if "nan" in row else row.split() for row in block.split("\n") if row and row[0] != "#"]
                 for block in path.read_text().split("\n\n")]
        yield path.stem, ".xyz", path.read_bytes(), [], [line for line in lines if line]
    rng = random.Random(11)
    part = [profile(rng, 90, 0.5 * i) for i in range(70)]
    made = {
        "one-point": [[["1.5", "-2", "3"]]],
        "one-and-two": [[["0", "0", "0"]], [["1", "2", "3"], ["1", "2", "3"]], [["4", "5", "6.5"]]],
        "runs": [[["0.1", "0", "1.5"], None, None, ["0.3", "0", "1.5"], ["0.4", "0", "-1.5"]], [None],
                 [["1", "1", "1"]], [None, ["1", "1", "1"], ["1", "2", "1"], None], [None, None]],
        "messy": messy(rng, 150),
        "two-groups": part,
        "ten-decimals": [[[f"{j * 1e-7:.10f}", f"{i * 1e-8:.10f}", f"{rng.randrange(-10 ** 6, 10 ** 6) * 1e-10:.10f}"]
                          for j in range(60)] for i in range(4)],
        "negative-origin": [profile(rng, 80, i, 4, (-123456.789, -98765.4321, -77777.7)) for i in range(6)],
        "far-origin": [profile(rng, 80, i, 3, (90071992.547, -45035996.273, 12345678.901)) for i in range(3)],
        "wide": [[[f"{x}", f"{-x}", f"{rng.randrange(-5 * 10 ** 8, 5 * 10 ** 8)}"] for x in range(-10 ** 9, 10 ** 9, 10 ** 8)]],
        "coarse-step": [[[f"{0.125 * j:.3f}", f"{i}", f"{0.005 * rng.randrange(-40, 40):.3f}"] for j in range(70)] for i in range(5)],
        "nearly-step": [[[f"{0.125 * j + (0.001 if rng.random() < 0.01 else 0):.3f}", f"{i}", f"{0.05 * rng.randrange(9):.3f}"]
                         for j in range(90)] for i in range(9)],
        "along-y": [[["%.2f" % (0.4 * i), "%.2f" % (0.3 * j), "%.2f" % (math.sin(j / 8) + 0.1 * i)]
                     for j in (range(70) if i % 2 else range(69, -1, -1))] for i in range(8)],
        "along-z": [[["%.2f" % math.cos(j / 5), "%d" % i, "%.2f" % (0.3 * j)] for j in range(70)] for i in range(4)],
        "shared-step": [[[f"{0.128 * j + (0.003 if rng.random() < 0.03 else 0):.3f}", f"{i}", f"{0.064 * rng.randrange(9):.3f}"]
                         for j in range(400)] for i in range(9)],
        "more-noise-later": [[[f"{j}", f"{i}", f"{(rng.randrange(-9, 10) * (200 if i > 63 else 1)) / 1000:.3f}"] for j in range(12)]
                             for i in range(200)],
        "flat": [[[f"{j}", f"{i}", "0"] for j in range(50)] for i in range(4)],
        "fan": fan(rng, 91, 70),
        "raster": raster(rng, 120, 66),
        "ruled": ruled(rng, 120, 66),
        "same-again": [[[f"{j}", f"{i}", f"{j * j * 7919 % 99991}"] for j in range(300)] for i in range(20)],
    }
    for name, lines in made.items():
        yield name, ".xyz", xyz(lines), [], lines
    for options in (["--levels", "explicit:5,1,0.02"], ["--levels", "explicit:0.5"], ["--levels", "uniform:4"],
                    ["--levels", "uniform:16:3"], ["--levels", "geometric:1"], ["--levels", "geometric:5:2"], ["--gap", "0.15"],
                    ["--unit", "in"], ["--levels", "uniform:2"], ["--resolution", "1e-05"], ["--device", "table-1.x"],
                    ["--floor", "half"], ["--floor", "0.02"]):
        yield " ".join(options), ".xyz", xyz(part[:12]), options, part[:12]
    yield "rounded", ".xyz", xyz(part[:4]), ["--resolution", "0.007"], None
    for form in "fd":
        lines = floats(rng, 5, form)
        yield "exact-" + form, ".ply", ply(lines, form), ["--resolution", "exact"], lines
        wide = [[[repr(x) for x in (1000.125 + i, -i / 4, struct.unpack("f", struct.pack("f", i * 1.7 + 0.3 ** (i % 20)))[0])]
                 for i in range(200)]]
        yield "exact-wide-" + form, ".ply", ply(wide, form), ["--resolution", "exact"], wide
        yield "rounded-" + form, ".ply", ply(lines, form), ["--resolution", "0.001"], None
    yield "metadata-copies", ".xyz", xyz([[[f"{i % 97}", f"{i}", "0"]] for i in range(64 * 256 + 3)]), ["--levels", "explicit:1"], None


def number(value, form):
    """What two texts or values of the same number have in common."""
    return struct.pack(form, float(value)) if form else Fraction(value)


class Difference(Exception):
    pass


def ensure(condition, what):
    if not condition:
        raise Difference(what)


def ensure_same(have, want, form, what):
    """Rows of text: alike, or for IEEE numbers (`form`) the same bits."""
    def bits(row):
        return row and [number(x, form) for x in row.replace(",", " ").split()[:3]] + row.split(",")[3:]

    different = (i for i, (a, b) in enumerate(zip(have, want)) if a != b and not (form and bits(a) == bits(b)))
    at = next(different, min(len(have), len(want)))
    ensure(at == len(have) == len(want),
           f"{what}, row {at} of {len(have)} and {len(want)}: reader {have[at:at + 1]}, export {want[at:at + 1]}")


class Test:
    def __init__(self, scansion, folder):
        self.scansion, self.folder = scansion, folder

    def run(self, *arguments, code=0):
        done = subprocess.run([self.scansion, *map(str, arguments)], capture_output=True, text=True, timeout=60, check=False)
        ensure(done.returncode == code, f"scansion {arguments} gave {done.returncode}, want {code}: {done.stderr}")
        return done.stdout

    def exported(self, recording, form, level=None):
        chosen = [] if level is None else ["--level", level]
        rows = self.run("export", recording, "-o", "-", "--format", form, *chosen).split("\n")
        return [row for row in rows[:-1] if not row.startswith("#") and row != "x,y,z,line"]

    def compress(self, name, ending, content, options):
        source = self.folder / (name.replace(" ", "").replace("-", "_") + ending)
        source.write_bytes(content)
        recording = source.with_suffix(".mcap")
        self.run("compress", source, "-o", recording, *options)
        return recording

    def compare(self, path):
        """All levels of a recording; gives what the reader made of it."""
        recording = format_reader.Recording(path.read_bytes())
        form = recording.form if recording.exact else None
        for level in [None, *range(recording.stored)]:
            rows = list(recording.rows(level, csv=True))
            ensure_same(rows, self.exported(path, "csv", level), form, f"level {level}")
        ensure_same(list(recording.rows()), self.exported(path, "xyz"), form, "xyz")
        return recording

    def case(self, name, ending, content, options, lines):
        path = self.compress(name, ending, content, options)
        recording = self.compare(path)
        ensure(recording.totals, "the recording is unfinished")
        check_left_out(recording)
        if lines is None:
            return
        form = recording.form if ending == ".ply" else None
        want = [(i, [number(x, form) for x in point]) for i, line in enumerate(lines) for point in line if point]
        have = [(i, [number(x, form) for x in point]) for i, point in recording.points()]
        ensure(have == want, "the recording does not hold the input")
        if "--gap" not in options:
            ensure(int(recording.totals.get("invalid", 0)) == sum(point is None for line in lines for point in line), "invalid samples")

    def levels_cut_off(self, path):
        for level in range(3):
            cut = path.with_suffix(f".cut{level}.mcap")
            self.run("export", path, "-o", cut, "--level", level)
            recording = self.compare(cut)
            ensure(recording.stored == level + 1 and recording.totals, f"cut to level {level}: {recording.stored} levels")

    def unfinished(self, path):
        """Cut off at places all over the file: the reader and export agree on every whole group."""
        data = path.read_bytes()
        rng = random.Random(5)
        for size in [len(data) - 1, len(data) - 8, *(rng.randrange(1200, len(data)) for _ in range(4))]:
            part = path.with_suffix(".part.mcap")
            part.write_bytes(data[:size])
            recording = self.compare(part)
            ensure(recording.totals is None, f"cut to {size} bytes and yet complete")

    def gaps(self, path):
        """A damaged group in the middle becomes a gap message."""
        data, marks, at = bytearray(path.read_bytes()), [], 0
        while (at := data.find(format_reader.MARK, at)) >= 0:
            marks.append(at)
            at += 1
        middle = [at for at in marks if data[at + 19] == 1]  # the group number, a varint
        data[middle[2] + 25] ^= 0xFF
        data[middle[0] + 25] ^= 0xFF
        damaged, recovered = path.with_suffix(".damaged.mcap"), path.with_suffix(".recovered.mcap")
        damaged.write_bytes(data)
        self.run("recover", damaged, "-o", recovered, code=1)
        recording = self.compare(recovered)
        gaps = [(gap["first"], gap["count"]) for gap in recording.gaps]
        ensure(gaps == [(64, 64)] and recording.totals, f"gaps {recording.gaps}, want lines 64 to 127")

    def flipped(self, path):
        """No byte of a recording can change unnoticed."""
        data = path.read_bytes()
        for at in [*range(0, 64), *range(64, len(data), 37), *range(len(data) - 64, len(data))]:
            bad = bytearray(data)
            bad[at] ^= 1 << at % 8
            try:
                whole = format_reader.Recording(bytes(bad)).totals is not None
            except FormatError:
                whole = False
            ensure(not whole, f"byte {at} was changed and the reader took it")

    def command_line(self, path):
        command = [sys.executable, format_reader.__file__, str(path), "--level", "1"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
        ensure(done.returncode == 0 and done.stdout.split("\n")[:-1] == self.exported(path, "xyz", 1), f"{command}: {done.stderr}")


def squared_distance(p, a, b):
    """(numerator, denominator) of the squared distance of p to the segment a b, exact."""
    chord, way = [y - x for x, y in zip(a, b)], [y - x for x, y in zip(a, p)]
    along, length = sum(map(int.__mul__, chord, way)), sum(x * x for x in chord)
    if along <= 0:
        return sum(x * x for x in way), 1
    if along >= length:
        return sum((y - x) ** 2 for x, y in zip(b, p)), 1
    return sum(x * x for x in way) * length - along * along, length


def largest_distance(points, kept):
    """In counts: how far the points between two kept ones lie from the segment of these at most."""
    worst = 0.0
    for a, b in zip(kept, kept[1:]):
        for i in range(a + 1, b):
            above, below = squared_distance(points[i], points[a], points[b])
            worst = max(worst, math.sqrt(above / below))
    return worst


def check_left_out(recording):
    """The headers' largest distance left out is true, and not above the tolerance; the line table has that of the end points."""
    scale = float(recording.resolution * MM[recording.facts["unit"]])
    for group in recording.groups:
        points = [tuple(group.count_at(axis, i) for axis in range(3)) for i in range(group.count)]
        for header in group.headers[:recording.level_count + 1]:
            def kept(i, run, header=header):
                return i in (run.first, run.last) or header.kind == format_reader.LEVEL and group.level[i] <= header.level

            worst = scale * max((largest_distance(points, [i for i in range(run.first, run.last + 1) if kept(i, run)])
                                 for run in group.runs), default=0.0)
            where = f"group {header.group} kind {header.kind} level {header.level}"
            ensure(math.isclose(worst, header.left_out, rel_tol=1e-12), f"{where} leaves out {worst} mm, header: {header.left_out}")
            ensure(header.kind == format_reader.LINES or worst <= header.tolerance * (1 + 1e-15), f"{where}: {worst} mm is above "
                   f"the tolerance {header.tolerance}")


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    failures = checks = 0
    with tempfile.TemporaryDirectory() as name:
        test = Test(sys.argv[1], pathlib.Path(name))
        todo = [(case[0], lambda case=case: test.case(*case)) for case in cases(sys.argv[2])]
        rng = random.Random(3)
        scan = xyz([profile(rng, 30, 0.5 * i) for i in range(150)])
        three = test.compress("three-groups", ".xyz", scan, [])
        small = test.compress("small", ".xyz", xyz([profile(rng, 40, i) for i in range(3)]), [])
        todo += [(part.__name__, lambda part=part: part(three))
                 for part in (test.levels_cut_off, test.unfinished, test.gaps, test.command_line)]
        todo.append(("flipped", lambda: test.flipped(small)))
        for what, check in todo:
            checks += 1
            try:
                check()
            except Exception:  # each case is reported, whatever went wrong in it
                failures += 1
                print(f"FAILED {what}\n{traceback.format_exc()}", file=sys.stderr)
    print(json.dumps({"checks": checks, "failures": failures}))
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
