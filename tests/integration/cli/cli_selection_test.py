# What a tolerance, a reduction, a level and a rearrangement hold: compared with an exact Douglas-Peucker of its own.
# SPDX-License-Identifier: Apache-2.0

import math
import os
import random
import re
from fractions import Fraction

from cli_kit import check, run_cases, same
from reference import (MM_PER_UNIT, Ranking, kept_of_run, kept_of_scan, largest_left_out, read_counts, read_rearrangement, read_xyz,
                       scaled, textbook)

DIGITS = 3  # all scans here have at most three decimals
REDUCTIONS = ("0", "50", "95", "97.5", "99.9", "100")


class Scan:
    """A text scan as runs of counts, its ranking, and the recording made of it."""

    def __init__(self, kit, source, *words, unit="mm"):
        self.kit, self.source = kit, source
        self.lines = read_runs(source)
        self.recording = kit.compress(source, source + ".mcap", "--unit", unit, *words)
        self.resolution = MM_PER_UNIT[unit] / 10**DIGITS
        self.info = kit.info(self.recording)
        same(Fraction(repr(self.info["resolution"])), self.resolution, f"{source}: mm per count")
        self.points = sum(len(run) for line in self.lines for run in line)
        self._rankings = None

    @property
    def rankings(self):
        if self._rankings is None:
            self._rankings = [[Ranking(run, self.resolution) for run in line] for line in self.lines]
        return self._rankings

    def runs(self):
        for points, ranks in zip(self.lines, self.rankings):
            yield from zip(points, ranks)

    def export(self, *words):
        """Exported lines as counts, and what the tool says about it: (points kept, largest distance left out)."""
        out = os.path.join(self.kit.root, "out.xyz")
        outcome = self.kit.scansion("export", self.recording, "-o", out, "--force", *words)
        kept = re.search(r"kept (\d+) of (\d+) points", outcome.err)
        error = re.search(r"largest distance left out (\S+) mm", outcome.err)
        check(kept and int(kept[2]) == self.points, f"{outcome} does not tell the points")
        return read_counts(out, DIGITS), int(kept[1]), float(error[1]) if error else None

    def check(self, chosen, *words):
        """`chosen`: ascending indices for each run, in order. Checks the points, the count and the error that is printed."""
        lines, kept, error = self.export(*words)
        what = f"{os.path.basename(self.source)} {' '.join(words)}"
        same(kept, sum(map(len, chosen)), f"{what}: points kept")
        left = iter(chosen)
        expected = [[run[i] for run in line for i in next(left)] for line in self.lines]
        expected = [line for line in expected if line]
        same(len(lines), len(expected), f"{what}: lines")
        for i, (got, want) in enumerate(zip(lines, expected)):
            same(got, want, f"{what}: line {i}")
        worst = max((largest_left_out(run, c) for (run, c) in zip((r for line in self.lines for r in line), chosen)), default=Fraction(0))
        exact = math.sqrt(worst) * float(self.resolution)
        if error is not None:
            check(math.isclose(error, exact, rel_tol=1e-12), f"{what}: prints the error {error}, is {exact}")
        return worst, error


def read_runs(path):
    """Lines of runs; rows with nan split."""
    lines, runs, run = [], [], []

    def end_run():
        nonlocal run
        if run:
            runs.append(run)
        run = []

    with open(path, encoding="ascii") as file:
        for row in [*file, ""]:
            words = row.split()
            if row.startswith("#"):
                continue
            if not words:
                end_run()
                if runs:
                    lines.append(runs)
                runs = []
            elif "nan" in row:
                end_run()
            else:
                run.append(tuple(scaled(w, DIGITS) for w in words))
    return lines


def write_scan(path, lines):
    """Counts as text; None is an invalid sample."""
    with open(path, "w", encoding="ascii") as file:
        for line in lines:
            for point in line:
                file.write("nan nan nan\n" if point is None else " ".join(decimal(v) for v in point) + "\n")
            file.write("\n")
    return path


def decimal(count):
    whole, rest = divmod(abs(count), 10**DIGITS)
    return f"{'-' if count < 0 else ''}{whole}.{rest:0{DIGITS}d}"


def scans(kit, folder):
    """The recordings in the tree, a few scenes, and lines made to be difficult."""
    for source in kit.scan_files():
        copy = os.path.join(folder, os.path.basename(source))
        os.symlink(source, copy)
        yield Scan(kit, copy)
    scenes = {"part-2": ("part", "--lines", 8, "--points", 700, "--seed", 21),
              "tilted": ("slots", "--lines", 6, "--points", 500, "--tilt", 35, "--direction", 20, "--dropouts", 0.05, "--seed", 22),
              "zigzag": ("zigzag", "--lines", 2, "--points", 150), "flat": ("flat", "--lines", 2, "--points", 700)}
    for name, words in scenes.items():
        yield Scan(kit, kit.scene(os.path.join(folder, name + ".xyz"), *words))
    yield Scan(kit, write_scan(os.path.join(folder, "difficult.xyz"), difficult_lines()))


def difficult_lines():
    """Short lines full of ties, folds, repeats, closed curves and invalid samples, in space and in planes."""
    generator = random.Random(29)
    lines = [[(0, 0, 0)], [(1, 2, 3), (4, 5, 6)], [(7, 7, 7)] * 9, [None, (0, 0, 0), None, None, (5, 0, 0), (6, 0, 1), (9, 0, 0), None]]
    lines.append([(1000 * i, 0, 50 * (i % 2)) for i in range(33)])  # every height met exactly by 0.05
    lines.append([(i, 0, 0) for i in range(40)] + [(39 - i, 0, 0) for i in range(40)])  # there and back on itself
    square = [(1, 0), (0, 1), (-1, 0), (0, -1)]
    lines.append([(sum(square[j % 4][0] for j in range(i)), 0, sum(square[j % 4][1] for j in range(i))) for i in range(41)])
    for number in range(150):
        span = generator.choice((2, 5, 60, 20000))
        length = generator.randrange(1, 45)
        axes = generator.choice(((1, 0, 1), (0, 1, 1), (1, 1, 1), (1, 1, 0)))
        line = [tuple(a * generator.randrange(-span, span + 1) for a in axes) for _ in range(length)]
        if number % 3 == 0:
            line = sorted(line)
        if number % 5 == 0:
            line = [None if generator.random() < 0.15 else p for p in line]
        lines.append(line)
    return [line for line in lines if any(line)]


def every_selection(kit):
    """Tolerances, reductions of both scopes, levels and rearrangement of every scan."""
    for scan in scans(kit, kit.folder("selections")):
        check_tolerances(scan, tolerances_for(scan))
        check_rearrangement(scan)
        for percent in REDUCTIONS:
            check_reduction(scan, percent)
            check_common_reduction(scan, percent)
        check_levels(scan)


def tolerances_for(scan):
    """Five at least; the last ones are met by points exactly."""
    finite = sorted(d for _, ranks in scan.runs() for d in ranks.distance if 0 < d < math.inf)
    met = [repr(finite[len(finite) * share // 100]) for share in (60, 97)] if finite else []
    return ["0.05", "0.0125", "0.001", "0.3", "0", "1e5", *met]


def check_tolerances(scan, texts):
    for text in texts:
        tolerance = Fraction(text)
        counts_squared = (tolerance / scan.resolution) ** 2
        chosen = [ranks.above(float(text)) for _, ranks in scan.runs()]
        if len(text) < 8:  # a decimal, not a double of a ranking: the textbook decides in exact numbers
            for (run, ranks), kept in zip(scan.runs(), chosen):
                same(textbook(run, counts_squared), kept, "the reference's own two ways")
        worst, error = scan.check(chosen, "--tolerance", text)
        check(error is not None, f"--tolerance {text} prints no error")
        check(worst <= counts_squared * (1 + Fraction(1, 2**50)), f"{scan.source}: error {error} above the tolerance {text}")


def check_reduction(scan, percent):
    chosen = []
    for (run, ranks), (_, _, count, rows) in zip(scan.runs(), scan.rearrangement, strict=True):
        kept = kept_of_run(count, Fraction(percent))
        prefix = [j for j, _ in rows[:kept]]
        same(prefix, ranks.order[:kept], f"{scan.source}: first {kept} rows of a run")
        chosen.append(sorted(prefix))
    _, error = scan.check(chosen, "--reduction", percent)
    check(error is not None, f"--reduction {percent} prints no error")


def check_common_reduction(scan, percent):
    keys, chosen = [], []
    for number, (_, ranks) in enumerate(scan.runs()):
        ends = {0, len(ranks.distance) - 1}
        chosen.append(ends)
        # Runs stand in the order of lines, so their number says both line and run.
        keys += [(-ranks.distance[i], number, ranks.depth[i], i) for i in range(len(ranks.distance)) if i not in ends]
    free = max(0, kept_of_scan(scan.points, Fraction(percent)) - sum(map(len, chosen)))
    for _, number, _, i in sorted(keys)[:free]:
        chosen[number].add(i)
    _, error = scan.check([sorted(c) for c in chosen], "--reduction", percent, "--scope", "scan")
    check(error is not None, f"--reduction {percent} --scope scan prints no error")


def check_rearrangement(scan):
    out = os.path.join(scan.kit.root, "rearrangement.txt")
    scan.kit.scansion("export", scan.recording, "-o", out, "--force", "--what", "rearrangement")
    scan.rearrangement = read_rearrangement(out)
    runs = iter(scan.rearrangement)
    for line, ranks_of_line in enumerate(scan.rankings):
        for run, ranks in enumerate(ranks_of_line):
            got_line, got_run, count, rows = next(runs)
            what = f"rearrangement of {scan.source} line {line} run {run}"
            same((got_line, got_run, count, len(rows)), (line, run, len(ranks.order), len(ranks.order)), f"{what}: heading")
            same([j for j, _ in rows], ranks.order, f"{what}: order")
            for j, text in rows:
                d = ranks.distance[j]
                same(float(text), 0.0 if math.isinf(d) else float(f"{d:.9g}"), f"{what}: d of {j}")
                check(len(text.split("e")[0].replace(".", "").lstrip("0")) <= 9, f"{what}: {text} has over 9 digits")
    same(next(runs, None), None, f"rearrangement of {scan.source}: more runs than the scan has")


def check_levels(scan):
    """The levels of one epoch: S_k = {D > d_(k+1)}, nested, counted in info; the last is every point."""
    same(len(scan.info["epochs"]), 1, f"{scan.source}: epochs of a scan of one group")
    tolerances = scan.info["levels"]
    same(tolerances, sorted(tolerances, reverse=True), f"{scan.source}: levels")
    total, before = 0, None
    for k, tolerance in enumerate([*tolerances, None]):
        chosen = [ranks.above(tolerance) if tolerance is not None else list(range(len(run))) for run, ranks in scan.runs()]
        worst, error = scan.check(chosen, "--level", str(k))
        if k == 0:
            check(math.isclose(scan.info["largest_left_out_at_level_0"], error, rel_tol=1e-15), "largest_left_out_at_level_0")
        total += scan.info["points_per_level"][k]
        same(total, sum(map(len, chosen)), f"{scan.source}: points of levels 0 to {k} in info")
        if before is not None:
            check(all(set(a) <= set(b) for a, b in zip(before, chosen)), f"{scan.source}: level {k} does not hold level {k - 1}")
        before = chosen
        if tolerance is not None:  # the same points by tolerance
            scan.check(chosen, "--tolerance", repr(tolerance))


def level_choices(kit):
    folder = kit.folder("choices")
    source = os.path.join(folder, "part.xyz")
    os.symlink(kit.scan_files()[2], source)
    for words, count in (("geometric:1", 1), ("geometric:5:2", 5), ("uniform:4", 4), ("uniform:3:0.9", 3),
                         ("explicit:1,0.05,0.0125", 3), ("explicit:" + ",".join(str(16 - i) for i in range(16)), 16)):
        scan = Scan(kit, source, "--levels", words)
        levels = scan.info["levels"]
        same(len(levels), count, f"--levels {words}: count")
        if words.startswith("explicit"):
            same(levels, [float(t) for t in words.split(":")[1].split(",")], f"--levels {words}")
        elif words.startswith("geometric"):
            ratio = float((words + ":3").split(":")[2])
            check(all(math.isclose(a, ratio * b, rel_tol=1e-12) for a, b in zip(levels, levels[1:])), f"--levels {words}: {levels}")
        else:
            largest = 0.9 if words.endswith("0.9") else max(d for _, r in scan.runs() for d in r.distance if d < math.inf)
            want = [largest * (count - i) / count for i in range(count)]
            check(all(math.isclose(a, b, rel_tol=1e-12) for a, b in zip(levels, want)), f"--levels {words}: {levels}, expected {want}")
        check_levels(scan)


def epochs(kit):
    """Later lines that leave the range start a new epoch; each group follows one of them, in order."""
    folder = kit.folder("epochs")
    generator = random.Random(31)
    lines = [[(100 * i, 200 * line, generator.randrange(-amplitude, amplitude + 1)) for i in range(40)]
             for line in range(192) for amplitude in [5 if line < 64 else 900 if line < 128 else 5]]
    for choice in ("uniform:3", "geometric:3"):
        scan = Scan(kit, write_scan(os.path.join(folder, "scan.xyz"), lines), "--levels", choice)
        found = scan.info["epochs"]
        check(len(found) > 1, f"--levels {choice}: no new epoch for lines 100 times as rough")
        same(scan.info["levels"], found[-1], "levels in info are the last epoch's")
        exported = [scan.export("--level", str(k))[0] for k in range(3)]
        epoch = 0
        for first in range(0, len(lines), 64):
            def follows(e):
                return all(exported[k][line] == [lines[line][i] for i in scan.rankings[line][0].above(found[e][k])]
                           for k in range(3) for line in range(first, first + 64))
            while epoch < len(found) and not follows(epoch):
                epoch += 1
            check(epoch < len(found), f"--levels {choice}: lines from {first} follow no epoch of {found}")
        check_tolerances(scan, ["0.05", "0.0125", "0.004"])


def floors(kit):
    """Ranked no finer than the floor: every point is kept, tolerances hold, and the recording says so; else nothing changes."""
    folder = kit.folder("floors")
    plain = Scan(kit, kit.scene(os.path.join(folder, "scan.xyz"), "part", "--lines", 20, "--points", 300))
    same(plain.info["floor"], None, "floor in info without one")
    for words, floor in (("half", 0.0005), ("0.02", 0.02)):
        source = os.path.join(folder, f"{words}.xyz")
        os.symlink(plain.source, source)
        scan = Scan(kit, source, "--floor", words)
        same(scan.info["floor"], words, "floor in info")
        same(scan.export()[0], plain.export()[0], f"--floor {words}: every point")
        for above in ("0.05", "0.3"):
            same(scan.export("--tolerance", above)[0], plain.export("--tolerance", above)[0], f"--floor {words}: above it")
        for below in (0.0, floor / 3, floor):
            kept = scan.export("--tolerance", repr(below))[0]
            least = plain.export("--tolerance", repr(below))[0]
            check(all(set(few) <= set(many) for few, many in zip(least, kept)), f"--floor {words}: a tolerance of {below} keeps less")


def units(kit):
    """Tolerances are millimetres whatever the input's unit is."""
    folder = kit.folder("units")
    for unit, texts in (("in", ("0.05", "0.0254", "1.27", "2", "12.5")), ("um", ("0.00005", "0.000001", "0.0003", "0.001", "0")),
                        ("m", ("50", "1", "12.5", "3", "0.5")), ("ft", ("15.24", "1", "12.5", "3", "0.3048"))):
        source = os.path.join(folder, f"{unit}.xyz")
        os.symlink(kit.scan_files()[2], source)
        scan = Scan(kit, source, unit=unit)
        check_tolerances(scan, texts)
        check_rearrangement(scan)
        check_reduction(scan, "95")


def rearrangement_of_a_range(kit):
    folder = kit.folder("range")
    source = kit.scene(os.path.join(folder, "scan.xyz"), "steps", "--lines", 100, "--points", 30)
    recording = kit.compress(source, os.path.join(folder, "scan.mcap"))
    out = os.path.join(folder, "all.txt")
    kit.scansion("export", recording, "-o", out, "--what", "rearrangement")
    part = os.path.join(folder, "part.txt")
    kit.scansion("export", recording, "-o", part, "--what", "rearrangement", "--lines", "60:70")
    same(read_rearrangement(part), read_rearrangement(out)[60:70], "rearrangement of lines 60 to 69")


def paper_scene(kit):
    """The data set of the paper: 95 % of 1,328,531 points leave exactly 66,427, by the order of the rearrangement file."""
    folder = kit.folder("paper")
    source = os.path.join(folder, "paper.xyz")
    made = kit.run("scansim", "scene", "paper", "-o", source, "--json").json()
    same((made["lines"], made["points"]), (1214, 1328531), "lines and points of the scene")
    recording = kit.compress(source, os.path.join(folder, "paper.mcap"))
    rows = os.path.join(folder, "paper.txt")
    kit.scansion("export", recording, "-o", rows, "--what", "rearrangement")
    out = os.path.join(folder, "out.csv")
    outcome = kit.scansion("export", recording, "-o", out, "--reduction", "95", "--scope", "scan")
    error = re.search(r"kept 66427 of 1328531 points in 1214 lines, largest distance left out (\S+) mm", outcome.err)
    check(error, f"{outcome} does not tell 66,427 points and the error")
    print(f"  error at 95 % of the paper's scene: {error[1]} mm")
    # What is kept of a run is a prefix of its order, so the common order only has to cut all runs at the same distance. Nine
    # digits are printed: equal ones may fall on either side.
    kept, smallest_kept, largest_left = kept_x(out), math.inf, 0.0
    same(sum(map(len, kept)), 66427, "points in the file")
    lines = read_xyz(source, str)
    for (line, _, count, rows), points in zip(read_rearrangement(rows), lines, strict=True):
        prefix = len(kept[line])
        same(kept[line], [scaled(points[j][0], 3) for j in sorted(j for j, _ in rows[:prefix])], f"points kept of line {line}")
        if prefix > 2:
            smallest_kept = min(smallest_kept, float(rows[prefix - 1][1]))
        if prefix < count:
            largest_left = max(largest_left, float(rows[prefix][1]))
    check(smallest_kept >= largest_left, f"keeps a point of distance {smallest_kept}, leaves out one of {largest_left}")


def kept_x(path):
    """x in counts of the points of each line of a CSV export; x rises along these lines, so it tells the point."""
    kept = [[] for _ in range(1214)]
    with open(path, encoding="ascii") as file:
        for row in file:
            if row[0] not in "#x":
                x, _, _, line = row.split(",")
                kept[int(line)].append(scaled(x, 3))
    return kept


def paper_scene_by_tolerance(kit):
    kit.needs_long("textbook Douglas-Peucker of 1.3 million points at five tolerances, in Python")
    scan = Scan(kit, kit.scene(os.path.join(kit.root, "paper.xyz"), "paper"))
    check_tolerances(scan, ["0.05", "0.0125", "0.2", "0.02", "1"])
    check_rearrangement(scan)
    check_common_reduction(scan, "95")


def selections_that_do_not_exist(kit):
    source = kit.scan_files()[0]
    recording = kit.compress(source, os.path.join(kit.root, "a.mcap"))
    out = os.path.join(kit.root, "none.xyz")
    stored = len(kit.info(recording)["points_per_level"])
    for words in (["--level", stored], ["--level", "-1"], ["--reduction", "101"], ["--reduction", "-1"], ["--reduction", "x"],
                  ["--reduction", "nan"], ["--tolerance", "-0.1"], ["--tolerance", "nan"], ["--tolerance", "0.1mm"],
                  ["--tolerance", "0.1", "--level", "0"], ["--reduction", "95", "--tolerance", "1"], ["--scope", "scan"],
                  ["--scope", "all", "--reduction", "5"], ["--tolerance", "1", "--scope", "scan"], ["--lines", "5"],
                  ["--lines", "7:3"], ["--lines", "a:b"], ["--what", "rearrangement", "--level", "0"]):
        kit.refused(2, "export", recording, "-o", out, *words, folders=[kit.root])
    check(not os.path.exists(out), "an output was left")


if __name__ == "__main__":
    run_cases("selections against an exact reference", [
        every_selection, level_choices, epochs, floors, units, rearrangement_of_a_range, paper_scene, paper_scene_by_tolerance,
        selections_that_do_not_exist])
