# Memory of compress and export follows the group, not the scan: 2 million points, or 50 million with --long, under 256 MiB.
# SPDX-License-Identifier: Apache-2.0

import os
import shutil
import subprocess

from cli_kit import Skip, check, digest, run_cases, same

LIMIT_MIB = 256
LINES, POINTS = 2000, 1000
LONG_LINES = 50000


class Big:
    """The scene and its recording, made once."""

    source = recording = None
    points = 0


def needs_scene():
    if Big.source is None:
        raise Skip("there is no scene")


def within(kit, what, *words, **more):
    outcome = kit.scansion(*words, timeout=3600 if kit.long else 300, **more)
    print(f"  {what}: {outcome.peak_kib / 1024:.0f} MiB, {outcome.seconds:.1f} s", flush=True)
    check(outcome.peak_kib < LIMIT_MIB * 1024, f"{what}: {outcome.peak_kib / 1024:.0f} MiB is over {LIMIT_MIB} MiB")
    return outcome


def make_scene(kit):
    if kit.sanitized:
        raise Skip("the program is built with sanitizers, which take memory of their own")
    Big.points = (LONG_LINES if kit.long else LINES) * POINTS
    needed = Big.points * 60  # bytes: input, one export as text, recording
    free = shutil.disk_usage(kit.root).free
    if free < needed:
        raise Skip(f"{needed >> 20} MiB of disk are needed in {kit.root}, {free >> 20} are free; set TMPDIR")
    Big.source = kit.scene(os.path.join(kit.root, "big.xyz"), "part", "--lines", LONG_LINES if kit.long else LINES, "--points", POINTS)
    print(f"  {Big.points} points, {os.path.getsize(Big.source) >> 20} MiB of text")


def compress(kit):
    needs_scene()
    Big.recording = os.path.join(kit.root, "big.mcap")
    report = within(kit, "compress", "compress", Big.source, "-o", Big.recording, "--json").json()
    same(report["points"], Big.points, "points")
    print(f"  {report['bits_per_point']:.3f} bit/point")


def compress_in_other_ways(kit):
    """From a pipe, with every bit kept, and with many levels."""
    needs_scene()
    out = os.path.join(kit.root, "other.mcap")
    pipe = subprocess.Popen(["cat", Big.source], stdout=subprocess.PIPE)
    within(kit, "compress from a pipe", "compress", "-", "-o", out, stdin=pipe.stdout)
    pipe.stdout.close()
    same(pipe.wait(), 0, "cat")
    same(digest(out), digest(Big.recording), "bytes of the recording made from a pipe")
    within(kit, "compress --resolution exact", "compress", Big.source, "-o", out, "--force", "--resolution", "exact")
    within(kit, "compress --levels geometric:16:1.3", "compress", Big.source, "-o", out, "--force", "--levels", "geometric:16:1.3")
    os.remove(out)


def compress_on_many_threads(kit):
    """As on machines with many processors, where this is the default."""
    needs_scene()
    out = os.path.join(kit.root, "threads.mcap")
    for threads in ("8", "64"):
        within(kit, f"compress --threads {threads}", "compress", Big.source, "-o", out, "--force", "--threads", threads)
        same(digest(out), digest(Big.recording), f"bytes of the recording made on {threads} threads")


def compress_a_grid(kit):
    """A PLY range grid has to be turned round; its vertices go to a file."""
    needs_scene()
    columns, rows = (4000, 2500) if kit.long else (1000, 1000)
    source = os.path.join(kit.root, "grid.ply")
    header = (f"ply\nformat ascii 1.0\nobj_info num_cols {columns}\nobj_info num_rows {rows}\nelement vertex {columns * rows}\n"
              f"property float x\nproperty float y\nproperty float z\nelement range_grid {columns * rows}\n"
              "property list uchar int vertex_indices\nend_header\n")
    with open(source, "w", encoding="ascii") as file:
        file.write(header)
        for r in range(rows):
            file.writelines(f"{c}.5 {r} {(c * r) % 97}\n" for c in range(columns))
        for r in range(rows):
            file.writelines(f"1 {r * columns + c}\n" for c in range(columns))
    out = os.path.join(kit.root, "grid.mcap")
    for words in ([], ["--grid", "rows"]):
        report = within(kit, f"compress a grid {' '.join(words)}", "compress", source, "-o", out, "--force", "--json", *words).json()
        same((report["lines"], report["points"]), (rows if words else columns, columns * rows), "lines and points of a grid")
    os.remove(source)
    os.remove(out)


def export(kit):
    needs_scene()
    for name, words in (("all", []), ("level-0", ["--level", "0"]), ("tolerance", ["--tolerance", "0.05"]),
                        ("reduction", ["--reduction", "95"]), ("scan", ["--reduction", "95", "--scope", "scan"])):
        for form in ("xyz", "ply"):
            out = os.path.join(kit.root, f"{name}.{form}")
            outcome = within(kit, f"export {' '.join(words) or 'every point'} as {form}", "export", Big.recording, "-o", out, *words)
            check(f" of {Big.points} points" in outcome.err, str(outcome))
            if name == "scan":
                check(f"kept {Big.points // 20} of" in outcome.err, str(outcome))
            os.remove(out)


def export_in_other_ways(kit):
    needs_scene()
    out = os.path.join(kit.root, "out")
    within(kit, "export of the rearrangement", "export", Big.recording, "-o", out, "--what", "rearrangement")
    os.remove(out)
    with open(os.devnull, "wb") as null:
        process = kit.start("scansion", "export", Big.recording, "-o", "-", "--format", "ply", stdout=null)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    same(process.returncode, 0, "export to standard output as ply")
    check(usage.ru_maxrss < LIMIT_MIB * 1024, f"export to standard output as ply: {usage.ru_maxrss >> 10} MiB")
    within(kit, "export of a recording cut to level 1", "export", Big.recording, "-o", out, "--format", "mcap", "--level", "1")


def everything_comes_back(kit):
    """The text that went in, number by number."""
    needs_scene()
    out = os.path.join(kit.root, "all.xyz")
    within(kit, "export every point", "export", Big.recording, "-o", out)
    points = 0
    with open(Big.source, encoding="ascii") as a, open(out, encoding="ascii") as b:
        rows = lambda file: (row for row in file if row[0] != "#")
        for want, got in zip(rows(a), rows(b), strict=True):
            if want != got:  # trailing zeros may differ
                same([float(v) for v in got.split()], [float(v) for v in want.split()], f"point {points}")
            points += len(want) > 1
    same(points, Big.points, "points that came back")


def check_and_repair(kit):
    needs_scene()
    out = os.path.join(kit.root, "recovered.mcap")
    within(kit, "info", "info", Big.recording)
    within(kit, "verify", "verify", Big.recording)
    within(kit, "recover", "recover", Big.recording, "-o", out)
    within(kit, "compare", "compare", Big.recording, out)


if __name__ == "__main__":
    run_cases("memory", [make_scene, compress, compress_in_other_ways, compress_on_many_threads, compress_a_grid, export, export_in_other_ways,
                         everything_comes_back, check_and_repair])
