#!/usr/bin/env python3
"""Sizes and stage times of `scansion compress`, beside xz -9 and zstd -19 of the same text, as a Markdown table.

size_table.py --bin DIR [FILE[:UNIT]...]     without files: synthetic scenes

Sizes are bits per point; stage times are processor time in ns per point with one thread, taken in one run on a machine that may be
busy: compare columns, not machines.
"""
import argparse
import json
import pathlib
import subprocess
import tempfile

SCENES = [("plane", 5), ("part", 5), ("freeform", 20), ("paper", 5)]


def run(*command, **options):
    return subprocess.run([str(c) for c in command], check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, **options).stdout


def points_only(scan, folder):
    """The packers get the bare points: comments would only help them lose."""
    bare = folder / "bare.txt"
    with open(scan, "rb") as source, open(bare, "wb") as target:
        target.writelines(line for line in source if not line.startswith(b"#"))
    return bare


def row(scansion, name, scan, unit, folder):
    recording = folder / "r.mcap"
    figures = json.loads(run(scansion, "compress", scan, "-o", recording, "--unit", unit, "--threads", "1", "--force", "--json"))
    bits = 8.0 / figures["points"]
    bare = points_only(scan, folder)
    xz = len(run("xz", "-9", "-c", bare)) * bits
    zstd = len(run("zstd", "-19", "-q", "-c", bare)) * bits
    times = figures["cpu_ns_per_point"]
    level0 = json.loads(run(scansion, "info", recording, "--json"))["points_per_level"][0]
    return (f"| {name} | {figures['lines']:,} | {figures['points']:,} | {figures['bits_per_point']:.2f} | {xz:.2f} | {zstd:.2f} | "
            f"{figures['bits_per_point'] / xz:.2f} | {100 * level0 / figures['points']:.2f} % | "
            f"{times['read']:.0f} / {times['rank']:.0f} / {times['encode']:.0f} / {times['write']:.0f} |")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--bin", required=True)
    arguments.add_argument("files", nargs="*")
    o = arguments.parse_args()
    tools = pathlib.Path(o.bin)
    print("| set | lines | points | scansion | xz -9 | zstd -19 | scansion / xz | level 0 | ns/point read / rank / encode / write |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|--:|")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for entry in o.files:
            path, _, unit = entry.partition(":")
            print(row(tools / "scansion", pathlib.Path(path).stem, path, unit or "mm", folder), flush=True)
        for scene, noise in SCENES if not o.files else []:
            scan = folder / f"{scene}.xyz"
            run(tools / "scansim", "scene", scene, "--noise", noise, "-o", scan, "--force")
            print(row(tools / "scansion", f"scene {scene}, {noise} um noise", scan, "mm", folder), flush=True)


if __name__ == "__main__":
    main()
