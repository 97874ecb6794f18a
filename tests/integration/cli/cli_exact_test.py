# Whatever goes in comes out again, exactly and in order: every format, unit, resolution, packing and way in or out.
# SPDX-License-Identifier: Apache-2.0

import io
import json
import lzma
import gzip
import os
import random
import shutil
import struct
import subprocess
import tarfile
from decimal import Decimal
from fractions import Fraction

from cli_kit import check, digest, run_cases, same, skip_part
from reference import MM_PER_UNIT, read_xyz

EXACT = Decimal  # coordinates are compared as exact decimals, never as floating point numbers


def single(value):
    """The nearest IEEE single of a double."""
    return struct.unpack("<f", struct.pack("<f", value))[0]


def flat(lines):
    return [point for line in lines for point in line]


# What the exporter writes, read by code of its own. Each reader gives [(line index or None, [(x, y, z) as text or float])].


def read_csv(path):
    lines = []
    with open(path, encoding="ascii") as file:
        rows = [row.strip() for row in file if not row.startswith("#")]
    same(rows[0], "x,y,z,line", f"heading of {path}")
    for row in rows[1:]:
        x, y, z, line = row.split(",")
        if not lines or lines[-1][0] != int(line):
            lines.append((int(line), []))
        lines[-1][1].append((x, y, z))
    return lines


def read_records(body, kind, points, path):
    size = struct.calcsize(f"<3{kind}I")
    same(len(body), size * points, f"bytes of points in {path}")
    lines = []
    for x, y, z, line in struct.iter_unpack(f"<3{kind}I", body):
        if not lines or lines[-1][0] != line:
            lines.append((line, []))
        lines[-1][1].append((x, y, z))
    return lines


def read_ply(path):
    with open(path, "rb") as file:
        head, _, body = file.read().partition(b"end_header\n")
    rows = [row.split() for row in head.decode("ascii").splitlines() if not row.startswith("comment")]
    same(rows[:2], [["ply"], ["format", "binary_little_endian", "1.0"]], f"header of {path}")
    kind = rows[3][1]
    check(kind in ("float", "double"), f"type of x in {path}: {kind}")
    same(rows[3:], [["property", kind, a] for a in "xyz"] + [["property", "uint", "line"]], f"properties of {path}")
    return read_records(body, {"float": "f", "double": "d"}[kind], int(rows[2][2]), path)


def read_pcd(path):
    with open(path, "rb") as file:
        head, _, body = file.read().partition(b"DATA binary\n")
    fields = {row.split()[0]: row.split()[1:] for row in head.decode("ascii").splitlines() if not row.startswith("#")}
    same(fields["FIELDS"], ["x", "y", "z", "line"], f"fields of {path}")
    same(fields["WIDTH"], fields["POINTS"], f"width of {path}")
    return read_records(body, {"4": "f", "8": "d"}[fields["SIZE"][0]], int(fields["POINTS"][0]), path)


def read_obj(path):
    vertices, lines = [], []
    with open(path, encoding="ascii") as file:
        for row in file:
            words = row.split()
            if words[0] == "v":
                vertices.append(tuple(words[1:]))
            elif words[0] in "lp":
                lines.append((None, [vertices[int(i) - 1] for i in words[1:]]))
    same(sum(len(line) for _, line in lines), len(vertices), f"vertices in polylines of {path}")
    return lines


def read_json(path):
    with open(path, encoding="ascii") as file:
        document = json.load(file, parse_float=str, parse_int=str)
    return [(int(line["index"]), [tuple(point) for point in line["points"]]) for line in document["lines"]]


READERS = {"csv": read_csv, "ply": read_ply, "pcd": read_pcd, "obj": read_obj, "json": read_json}


def check_xyz(kit, recording, want, *words):
    """Exports as text and compares with `want`, lines of points of exact numbers."""
    out = os.path.join(kit.root, "out.xyz")
    kit.scansion("export", recording, "-o", out, "--force", *words)
    compare_lines(read_xyz(out, EXACT), want, f"export {' '.join(words)} of {recording}")


def compare_lines(got, want, what):
    same(len(got), len(want), f"{what}: lines")
    for i, (a, b) in enumerate(zip(got, want)):
        same(len(a), len(b), f"{what}: points of line {i}")
        for j, (p, q) in enumerate(zip(a, b)):
            if p != q:
                same(tuple(map(str, p)), tuple(map(str, q)), f"{what}: line {i} point {j}")


def check_format(kit, recording, form, want):
    out = os.path.join(kit.root, f"out.{form}")
    kit.scansion("export", recording, "-o", out, "--force")
    got = READERS[form](out)
    if form != "obj":
        same([index for index, _ in got], list(range(len(want))), f"{form}: line indexes")
    binary = form in ("ply", "pcd")
    convert = (lambda v: v) if binary else EXACT
    expected = [[tuple(float(v) for v in p) for p in line] for line in want] if binary else want
    compare_lines([[tuple(map(convert, p)) for p in line] for _, line in got], expected, f"{form} of {recording}")
    return out


def check_everything(kit, source, *words):
    """All formats, and the ones we read again as input of a second recording that must be the same."""
    want = read_xyz(source, EXACT)
    recording = kit.compress(source, os.path.join(kit.root, "a.mcap"), *words)
    check_xyz(kit, recording, want)
    for form in READERS:
        out = check_format(kit, recording, form, want)
        if form in ("csv", "ply"):
            again = kit.compress(out, os.path.join(kit.root, "b.mcap"), *words)
            kit.scansion("compare", recording, again)
            check_xyz(kit, again, want)
    info = kit.info(recording)
    same((info["lines"], info["points"], info["complete"]), (len(want), len(flat(want)), True), f"info of {source}")


def recordings_in_every_format(kit):
    for source in kit.scan_files():
        check_everything(kit, source)


def generated_scenes(kit):
    folder = kit.folder("scenes")
    scenes = [
        ("part", "--lines", 130, "--points", 150, "--seed", 3),  # three groups
        ("freeform", "--lines", 30, "--points", 300, "--tilt", -30, "--direction", 33, "--outliers", 0.02, "--seed", 4),
        ("ribs", "--lines", 5, "--points", 3000, "--zigzag", "--dropouts", 0.1, "--seed", 5),
        ("flat", "--lines", 2, "--points", 4000),
        ("zigzag", "--lines", 3, "--points", 2000),
        ("slots", "--lines", 1, "--points", 20000),
    ]
    for i, scene in enumerate(scenes):
        source = kit.scene(os.path.join(folder, f"{i}.xyz"), *scene)
        recording = kit.compress(source, os.path.join(folder, f"{i}.mcap"))
        check_xyz(kit, recording, read_xyz(source, EXACT))


# A scan as bad as real ones: lines of one and two points, steps back, verticals, folds, repeats, any plane, any way to write a number.
MESSY = """# made by hand
0 0 0

1.5 2.25 -3.125
1.5 2.25 -3.125

0 0 0
1 0 0
0.5 0 7
0.5 0 9
0.5 0 8.999
-100.25 0 9
-100.25 0 9
-100.25 0 9
250 -33 1e-3
250 -33 .5
250 -33 5.
+7 -0 +0.0
-0.001 00012.500 -1.2E1


# two blank rows above, comment between
1000000 2000000 3000000
1000000.001 1999999.999 3000000.001
1000000.002\t2000000 \t 3000000.002
"""


def messy_text(kit):
    folder = kit.folder("messy")
    source = os.path.join(folder, "messy.xyz")
    with open(source, "w", encoding="ascii") as file:
        file.write(MESSY)
    want = read_xyz(source, EXACT)
    same([len(line) for line in want], [1, 2, 13, 3], "points of the test's own input")
    check_everything(kit, source)
    # No line feed at the end, and line ends of another system.
    for name, text in (("cut", MESSY.rstrip("\n")), ("crlf", MESSY.replace("\n", "\r\n")), ("mark", "\ufeff" + MESSY)):
        path = os.path.join(folder, f"{name}.xyz")
        with open(path, "w", encoding="utf-8", newline="") as file:
            file.write(text)
        check_xyz(kit, kit.compress(path, os.path.join(folder, f"{name}.mcap")), want)


def delimiters(kit):
    folder = kit.folder("delimiters")
    source = kit.scan_files()[0]
    want = read_xyz(source, EXACT)
    first = kit.compress(source, os.path.join(folder, "first.mcap"))
    with open(source, encoding="ascii") as file:
        rows = file.read().splitlines()
    for name, between in (("comma", ","), ("semicolon", ";"), ("tab", "\t"), ("many", "   "), ("comma-blank", ", ")):
        path = os.path.join(folder, f"{name}.xyz")
        with open(path, "w", encoding="ascii") as file:
            for row in rows:
                file.write((row if row.startswith("#") else between.join(row.split())) + "\n")
        recording = kit.compress(path, os.path.join(folder, f"{name}.mcap"))
        check_xyz(kit, recording, want)
        same(digest(recording), digest(first), f"bytes of the recording of {path}")


def csv_profiles(kit):
    """x,z with and without heading, one file a profile, y from --spacing; columns named by the caller; labels passed over."""
    folder = kit.folder("profiles")
    generator = random.Random(7)
    profiles = [[(i * 0.25, generator.randrange(-3000, 3000) / 1000) for i in range(40 + p)] for p in range(12)]

    def write(name, heading, row):
        into = os.path.join(folder, name)
        os.makedirs(into)
        for p, profile in enumerate(profiles):
            with open(os.path.join(into, f"profile-{p}.csv"), "w", encoding="ascii") as file:
                file.write(heading)
                file.writelines(row(x, z, i) + "\n" for i, (x, z) in enumerate(profile))
        return into

    def want(spacing):
        return [[(EXACT(str(x)), spacing * p, EXACT(str(z))) for x, z in profile] for p, profile in enumerate(profiles)]

    plain = write("plain", "", lambda x, z, _: f"{x},{z:.3f}")
    headed = write("headed", "X [mm];Z [mm]\n", lambda x, z, _: f"{x};{z:.3f}")
    labelled = write("labelled", "", lambda x, z, i: f"{x},{z:.3f},{i % 2}")
    other = write("other", "", lambda x, z, i: f"{i},{z:.3f},{x}")
    out = os.path.join(folder, "out.mcap")
    for source, words in ((plain, ()), (headed, ()), (labelled, ()), (other, ("--columns", "-,z,x", "--format", "csv"))):
        # Natural order: profile-10 comes after profile-9.
        check_xyz(kit, kit.compress(source, out, *words), want(Fraction(1)))
    check_xyz(kit, kit.compress(plain, out, "--spacing", "0.125"), want(Fraction(1, 8)))


def units(kit):
    folder = kit.folder("units")
    source = kit.scan_files()[1]
    want = read_xyz(source, Fraction)
    for unit, mm in MM_PER_UNIT.items():
        recording = kit.compress(source, os.path.join(folder, f"{unit}.mcap"), "--unit", unit)
        info = kit.info(recording)
        same(info["unit"], unit, "unit of the recording")
        same(Fraction(repr(info["resolution"])), mm / 1000, f"mm per count of {unit} data with three decimals")
        check_xyz(kit, recording, want)
        for other, other_mm in MM_PER_UNIT.items():
            factor = mm / other_mm
            check_unit(kit, recording, want, other, factor)
    with open(os.path.join(kit.root, "out.xyz"), encoding="ascii") as file:
        check("unit ft" in file.readline(), "the unit is not written in the export")


def check_unit(kit, recording, want, unit, factor):
    converted = [[tuple(v * factor for v in p) for p in line] for line in want]
    denominator = (factor / 1000).denominator
    for prime in (2, 5):
        while denominator % prime == 0:
            denominator //= prime
    if denominator == 1:  # a decimal fraction: exact
        return check_xyz(kit, recording, converted, "--unit", unit)
    out = os.path.join(kit.root, "out.xyz")
    kit.scansion("export", recording, "-o", out, "--force", "--unit", unit)
    for got, expected in zip(flat(read_xyz(out, Fraction)), flat(converted), strict=True):
        for a, b in zip(got, expected):
            check(abs(a - b) <= abs(b) * Fraction(1, 2**51), f"{recording} in {unit}: {float(a)!r} for {float(b)!r}")


def given_resolution(kit):
    folder = kit.folder("resolution")
    source = kit.scan_files()[2]
    values = read_xyz(source, Fraction)
    for text in ("0.001", "0.005", "0.05", "2e-3", "0.0001", "3"):
        step = Fraction(text)
        recording = os.path.join(folder, "out.mcap")
        report = kit.scansion("compress", source, "-o", recording, "--force", "--resolution", text, "--json").json()
        out = os.path.join(kit.root, "out.xyz")
        kit.scansion("export", recording, "-o", out, "--force")
        worst = Fraction(0)
        for got, value in zip(flat(read_xyz(out, Fraction)), flat(values), strict=True):
            for a, b in zip(got, value):
                same((a / step).denominator, 1, f"{a} as a multiple of {text}")
                worst = max(worst, abs(a - b))
        check(worst <= step / 2, f"resolution {text}: rounded by {float(worst)}")
        check(abs(Fraction(report["rounding_mm"]) - worst) <= worst / 10**12,
              f"resolution {text}: reports rounding by {report['rounding_mm']}, is {float(worst)}")
        same(Fraction(repr(kit.info(recording)["resolution"])), step, "resolution of the recording")


def exact_doubles(kit):
    """Values with no decimals in common: every bit of a double comes back."""
    folder = kit.folder("doubles")
    generator = random.Random(11)
    lines = [[(i / 3 + generator.gauss(0, 1e-9), line * 0.1, generator.gauss(0, 1) * 10.0 ** generator.randrange(-12, 1))
              for i in range(200)] for line in range(70)]
    source = os.path.join(folder, "doubles.ply")
    write_ply(source, "binary_little_endian", "double", lines)
    check_bits(kit, source, lines, "d")
    text = os.path.join(folder, "doubles.xyz")
    with open(text, "w", encoding="ascii") as file:
        file.write("\n".join("".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in line) for line in lines))
    check_bits(kit, text, lines, "d")
    check_bits(kit, text, lines, "d", "--resolution", "exact")
    check_bits(kit, kit.scan_files()[0], read_xyz(kit.scan_files()[0], float), "d", "--resolution", "exact")


def exact_singles(kit):
    folder = kit.folder("singles")
    generator = random.Random(13)
    lines = [[(single(i / 7), single(line / 3), single(generator.gauss(0, 30))) for i in range(150)] for line in range(66)]
    source = os.path.join(folder, "singles.ply")
    for form in ("binary_little_endian", "binary_big_endian", "ascii"):
        write_ply(source, form, "float", lines)
        for words in ((), ("--resolution", "exact")):
            check_bits(kit, source, lines, "f", *words)
            if form != "ascii":  # its decimals may be kept as doubles
                again = kit.compress(os.path.join(kit.root, "bits.ply"), os.path.join(kit.root, "again.mcap"), *words)
                kit.scansion("compare", os.path.join(kit.root, "bits.mcap"), again, "--what", "points")


def write_ply(path, form, kind, lines):
    header = f"ply\nformat {form} 1.0\ncomment a test\nelement vertex {len(flat(lines))}\n"
    header += "".join(f"property {kind} {axis}\n" for axis in "xyz") + "property uchar quality\nproperty int line\nend_header\n"
    order = ">" if "big" in form else "<"
    with open(path, "wb") as file:
        file.write(header.encode("ascii"))
        for number, line in enumerate(lines):
            for point in line:
                if form == "ascii":
                    shown = " ".join(shortest_single(v) if kind == "float" else repr(v) for v in point)
                    file.write(f"{shown} 9 {number}\n".encode("ascii"))
                else:
                    file.write(struct.pack(order + {"float": "3f", "double": "3d"}[kind] + "Bi", *point, 9, number))


def shortest_single(value):
    for digits in range(1, 10):
        text = f"{value:.{digits}g}"
        if single(float(text)) == value:
            return text
    raise ValueError(value)


def check_bits(kit, source, lines, kind, *words):
    """All bits come back through binary PLY, and through text when it is read as the same type."""
    recording = kit.compress(source, os.path.join(kit.root, "bits.mcap"), *words)
    out = os.path.join(kit.root, "bits.ply")
    kit.scansion("export", recording, "-o", out, "--force", *(("--float32",) if kind == "f" else ()))
    got = [line for _, line in read_ply(out)]
    pack = struct.Struct(f"<3{kind}").pack
    same(len(got), len(lines), f"lines of {source}")
    for i, (a, b) in enumerate(zip(got, lines)):
        same([pack(*p) for p in a], [pack(*p) for p in b], f"{source} {' '.join(words)}: bits of line {i}")
    text = os.path.join(kit.root, "bits.xyz")
    kit.scansion("export", recording, "-o", text, "--force")
    convert = (lambda t: single(float(t))) if kind == "f" else float
    compare_lines(read_xyz(text, convert), lines, f"text of {source}")


def grids(kit):
    """PLY range grids: one column a line by default, one row with --grid rows; cells may be empty."""
    folder = kit.folder("grids")
    generator = random.Random(17)
    columns, rows = 70, 9
    cells = [[None if generator.random() < 0.2 else (c * 0.5, r * 0.25, generator.randrange(1000) / 8) for c in range(columns)]
             for r in range(rows)]
    cells[0][5] = (1.0, 2.0, 3.0)
    vertices = [cell for row in cells for cell in row if cell]
    by_column = [[cells[r][c] for r in range(rows) if cells[r][c]] for c in range(columns)]
    by_row = [[cell for cell in row if cell] for row in cells]
    for form, order in (("ascii", ""), ("binary_little_endian", "<"), ("binary_big_endian", ">")):
        source = os.path.join(folder, f"{form}.ply")
        write_grid(source, form, order, cells, vertices)
        for words, lines in (((), by_column), (("--grid", "rows"), by_row)):
            recording = kit.compress(source, os.path.join(folder, "out.mcap"), *words)
            check_xyz(kit, recording, [[tuple(map(EXACT, p)) for p in line] for line in lines if line])
            # A column without a single vertex is a line without points.
            same(kit.info(recording)["lines"], len(lines), f"lines of {form} {' '.join(words)}")


def write_grid(path, form, order, cells, vertices):
    rows, columns = len(cells), len(cells[0])
    header = (f"ply\nformat {form} 1.0\nobj_info num_cols {columns}\nobj_info num_rows {rows}\nelement vertex {len(vertices)}\n"
              "property float x\nproperty float y\nproperty float z\n"
              f"element range_grid {rows * columns}\nproperty list uchar int vertex_indices\nend_header\n")
    number = 0
    with open(path, "wb") as file:
        file.write(header.encode("ascii"))
        for v in vertices:
            file.write(struct.pack(order + "3f", *v) if order else f"{v[0]} {v[1]} {v[2]}\n".encode("ascii"))
        for row in cells:
            for cell in row:
                if cell is None:
                    file.write(b"\0" if order else b"0\n")
                else:
                    file.write(struct.pack(order + "Bi", 1, number) if order else f"1 {number}\n".encode("ascii"))
                    number += 1


def packed_and_archived(kit):
    folder = kit.folder("packed")
    sources = kit.scan_files()[:3]
    want = [line for source in sources for line in read_xyz(source, EXACT)]
    texts = []
    for source in sources:
        with open(source, "rb") as file:
            texts.append(file.read())
    names = ["scan-2.xyz", "scan-9.xyz", "scan-10.xyz"]  # natural order, not that of the bytes
    made = {"plain": sources}
    for ending, pack in (("gz", gzip.compress), ("xz", lzma.compress)):
        made[ending] = [os.path.join(folder, f"{name}.{ending}") for name in names]
        for path, text in zip(made[ending], texts):
            write(path, pack(text))
    if shutil.which("zstd"):
        made["zst"] = [os.path.join(folder, f"{name}.zst") for name in names]
        for path, text in zip(made["zst"], texts):
            write(path, subprocess.run(["zstd", "-q", "-c"], input=text, stdout=subprocess.PIPE, check=True).stdout)
    else:
        skip_part("zst input: the program zstd is not installed")
    for ending in ("tar", "tar.gz", "tar.xz"):
        path = os.path.join(folder, f"scans.{ending}")
        mode = "w" + (":" + ending[4:] if "." in ending else "")
        with tarfile.open(path, mode) as archive:
            for name, text in [*zip(reversed(names), reversed(texts)), ("notes.pdf", b"no scan")]:
                entry = tarfile.TarInfo("a/" + name)
                entry.size = len(text)
                archive.addfile(entry, io.BytesIO(text))
        made[ending] = [path]
    into = os.path.join(folder, "scans")
    os.makedirs(os.path.join(into, "deep"))
    for name, text in zip(names, texts):
        write(os.path.join(into, "deep", name), text)
    write(os.path.join(into, "deep", "readme.md"), b"no scan")
    made["folder"] = [into]
    first = None
    for name, inputs in made.items():
        recording = os.path.join(folder, f"{name}.mcap")
        kit.scansion("compress", *inputs, "-o", recording)
        check_xyz(kit, recording, want)
        first = first or recording
        same(digest(recording), digest(first), f"bytes of the recording made from {name}")
    kit.check_no_temporary_files()


def write(path, data):
    with open(path, "wb") as file:
        file.write(data)


def standard_streams(kit):
    folder = kit.folder("streams")
    source = kit.scan_files()[3]
    want = read_xyz(source, EXACT)
    direct = kit.compress(source, os.path.join(folder, "direct.mcap"))
    with open(source, "rb") as file:
        text = file.read()
    with open(direct, "rb") as file:
        recording = file.read()
    # A file as standard input and a pipe; both ways out.
    check(kit.scansion("compress", "-", "-o", "-", stdin=text).out == recording, "compress - -o -: another recording than to a file")
    pipe = subprocess.Popen(["cat", source], stdout=subprocess.PIPE)
    check(kit.scansion("compress", "-", "-o", "-", stdin=pipe.stdout).out == recording, "compress from a pipe: another recording")
    pipe.stdout.close()
    same(pipe.wait(), 0, "cat")
    piped = kit.scansion("compress", "-", "-o", "-", stdin=gzip.compress(text)).out
    check(piped == recording, "compress of packed standard input: another recording")
    for form in (None, "csv", "ply", "pcd"):
        out = os.path.join(folder, f"out.{form or 'xyz'}")
        kit.scansion("export", direct, "-o", out)
        printed = kit.scansion("export", direct, "-o", "-", *(("--format", form) if form else ())).out
        with open(out, "rb") as file:
            check(printed == file.read(), f"export -o - as {form}: other bytes than to a file")
    compare_lines(read_xyz(os.path.join(folder, "out.xyz"), EXACT), want, "export")
    recordings_on_standard_streams(kit, direct, recording)
    rows = kit.scansion("export", direct, "-o", "-", "--what", "rearrangement").out
    check(rows.startswith(b"# line 0 run 0 n+1 "), "rearrangement to standard output")
    kit.check_no_temporary_files()


def recordings_on_standard_streams(kit, path, data):
    """Every verb that reads a recording takes it from a pipe and from a file as well, and those that write one write to `-`."""
    cut = os.path.join(kit.root, "cut-for-streams.mcap")
    kit.scansion("export", path, "-o", cut, "--level", "0")
    with open(cut, "rb") as file:
        cut_data = file.read()
    for words, want in ((["info", "-", "--json"], None), (["export", "-", "-o", "-"], None), (["compare", "-", path, "--json"], None),
                        (["export", "-", "-o", "-", "--what", "rearrangement"], None), (["view", "-", "-o", "-", "--size", "200"], None),
                        (["export", "-", "-o", "-", "--level", "0", "--format", "mcap"], cut_data), (["recover", "-", "-o", "-"], data),
                        (["verify", "-", "--json"], None)):
        if want is None and words[0] != "view":  # a picture is captioned with the name
            want = kit.scansion(words[0], path, *words[2:]).out
        pipe = subprocess.Popen(["cat", path], stdout=subprocess.PIPE)
        piped = kit.scansion(*words, stdin=pipe.stdout).out
        pipe.stdout.close()
        same(pipe.wait(), 0, "cat")
        with open(path, "rb") as file:
            direct = kit.scansion(*words, stdin=file).out
        check(piped == direct and len(piped) > 0, f"{' '.join(words)}: a pipe gives something else than a file")
        check(want is None or piped == want, f"{' '.join(words)}: something else than of the named recording")
    refused = kit.scansion("info", "-", stdin=b"no recording at all", expect=65)
    check("standard input" in refused.err, f"{refused}: does not name standard input")


def line_ranges(kit):
    folder = kit.folder("ranges")
    source = kit.scene(os.path.join(folder, "scan.xyz"), "steps", "--lines", 150, "--points", 40)
    want = read_xyz(source, EXACT)
    recording = kit.compress(source, os.path.join(folder, "scan.mcap"))
    for text, a, b in (("0:1", 0, 1), ("3:9", 3, 9), ("60:70", 60, 70), (":64", 0, 64), ("64:", 64, 150), ("149:150", 149, 150),
                       ("100:1000", 100, 150), ("0:150", 0, 150)):
        check_xyz(kit, recording, want[a:b], "--lines", text)
    out = os.path.join(folder, "out.csv")
    kit.scansion("export", recording, "-o", out, "--lines", "63:66")
    same([line for line, _ in read_csv(out)], [63, 64, 65], "line indexes of a range")


def single_precision(kit):
    folder = kit.folder("float32")
    source = kit.scan_files()[4]
    want = [[tuple(single(float(v)) for v in p) for p in line] for line in read_xyz(source)]
    recording = kit.compress(source, os.path.join(folder, "a.mcap"))
    for form in ("ply", "pcd", "csv"):
        out = os.path.join(folder, f"out.{form}")
        kit.scansion("export", recording, "-o", out, "--float32")
        got = [[tuple(single(float(v)) for v in p) for p in line] for _, line in READERS[form](out)]
        compare_lines(got, want, f"--float32 {form}")
    out = os.path.join(folder, "out.xyz")
    kit.scansion("export", recording, "-o", out, "--float32")
    compare_lines(read_xyz(out, lambda t: single(float(t))), want, "--float32 xyz")


def wide_and_fine(kit):
    """Coordinates that need more than 32 bits in all, but not in a run; and ones with 15 decimals."""
    folder = kit.folder("wide")
    source = os.path.join(folder, "wide.xyz")
    generator = random.Random(19)
    with open(source, "w", encoding="ascii") as file:
        for line in range(80):
            for i in range(30):
                file.write(f"{10**7 + i}.{generator.randrange(10**6):06d} {line * 10}.5 {-(10**6)}.{generator.randrange(100):02d}\n")
            file.write("\n")
    check_xyz(kit, kit.compress(source, os.path.join(folder, "wide.mcap")), read_xyz(source, EXACT))
    with open(source, "w", encoding="ascii") as file:
        file.writelines(f"0.{i:06d}{generator.randrange(10**6):06d} 0 0\n" for i in range(500))
    check_xyz(kit, kit.compress(source, os.path.join(folder, "fine.mcap"), "--unit", "m"), read_xyz(source, EXACT))


def late_decimals(kit):
    """More decimals, another label, a larger value: far behind the start, where the lattice was chosen."""
    folder = kit.folder("late")
    for name, last in (("fine", "1.00012345 2 3"), ("far", "2000000 2 3"), ("both", "123456.0000001 -5 3")):
        source = os.path.join(folder, f"{name}.xyz")
        with open(source, "w", encoding="ascii") as file:
            for line in range(18):  # more than the 4 MiB that are looked at first
                file.writelines(f"{i * 0.1:<100.1f} {line:<100} {(i * line) % 17:>100}\n" for i in range(1000))
                file.write("\n")
            file.write(f"{last}\n")
        check_xyz(kit, kit.compress(source, os.path.join(folder, f"{name}.mcap")), read_xyz(source, EXACT))


def compare_tells_differences(kit):
    folder = kit.folder("compare")
    source = kit.scan_files()[5]
    recording = kit.compress(source, os.path.join(folder, "a.mcap"))
    with open(source, encoding="ascii") as file:
        rows = file.read().splitlines()
    blank = rows.index("", rows.index("") + 1)  # the end of line 1
    changed = rows[:]
    x, y, z = changed[blank - 3].split()
    changed[blank - 3] = f"{x} {y} {float(z) + 0.001:.3f}"
    write(os.path.join(folder, "b.xyz"), "\n".join(changed).encode())
    other = kit.compress(os.path.join(folder, "b.xyz"), os.path.join(folder, "b.mcap"))
    points = len(read_xyz(source)[1])
    outcome = kit.scansion("compare", recording, other, "--what", "points", expect=1)
    check(f"line 1 run 0 point {points - 3}" in outcome.out.decode(), f"{outcome} does not say where: {outcome.out}")
    report = kit.scansion("compare", recording, other, "--what", "points", "--json", expect=1).json()
    same(report["same"], False, "compare --json")
    kit.scansion("compare", recording, other, "--what", "points", "--tolerance", "0.0011")
    kit.scansion("compare", recording, other, "--what", "points", "--tolerance", "0.0009", expect=1)
    same(kit.scansion("compare", recording, recording, "--json").json()["same"], True, "a recording and itself")
    write(os.path.join(folder, "c.xyz"), "\n".join(rows[:blank]).encode())
    shorter = kit.compress(os.path.join(folder, "c.xyz"), os.path.join(folder, "c.mcap"))
    outcome = kit.scansion("compare", recording, shorter, "--what", "points", expect=1)
    check("line 2" in outcome.out.decode(), f"{outcome} does not say where the shorter one ends: {outcome.out}")


def everything_of_a_big_scene(kit):
    kit.needs_long("1.3 million points")
    source = kit.scene(os.path.join(kit.root, "paper.xyz"), "paper")
    check_everything(kit, source)


if __name__ == "__main__":
    run_cases("what goes in comes out again", [
        recordings_in_every_format, generated_scenes, messy_text, delimiters, csv_profiles, units, given_resolution, exact_doubles,
        exact_singles, grids, packed_and_archived, standard_streams, line_ranges, single_precision, wide_and_fine, late_decimals,
        compare_tells_differences, everything_of_a_big_scene])
