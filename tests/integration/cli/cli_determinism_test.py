# The same input and options give the same bytes: run after run, on any number of threads, however the input arrives.
# SPDX-License-Identifier: Apache-2.0

import os
import shutil
import subprocess
import time

from cli_kit import digest, run_cases, same

THREADS = ("1", "2", "3", "4", "16", "0")


def scans(kit):
    folder = kit.folder("scans")
    scenes = {"part": ("part", "--lines", 400, "--points", 300), "dirty": ("freeform", "--lines", 300, "--points", 200, "--outliers", 0.02,
                                                                           "--dropouts", 0.1, "--jitter", 0.5)}
    made = [kit.scene(os.path.join(folder, name + ".xyz"), *words) for name, words in scenes.items()]
    # Levels are calibrated anew in the course of this one: smooth, rough, smooth.
    rough = os.path.join(folder, "rough.xyz")
    with open(rough, "w", encoding="ascii") as file:
        for line in range(256):
            height = 700 if 64 <= line < 160 else 3
            file.writelines(f"{i} {line} {(i * 7919 + line * 104729) % height}\n" for i in range(120))
            file.write("\n")
    return [*made, rough]


def any_number_of_threads(kit):
    for scan in scans(kit):
        for words in ([], ["--levels", "uniform:4"], ["--resolution", "exact"]):
            found = {}
            for threads in THREADS:
                out = kit.compress(scan, os.path.join(kit.root, f"{threads}.mcap"), "--threads", threads, *words)
                found.setdefault(digest(out), []).append(threads)
            same(len(found), 1, f"recordings of {os.path.basename(scan)} {' '.join(words)} by threads {list(found.values())}: different bytes")


def run_after_run(kit):
    """Another name, another folder, another time, another way in; and the exports of it."""
    folder = kit.folder("runs")
    scan = kit.scene(os.path.join(folder, "scan.xyz"), "slots", "--lines", 200, "--points", 150, "--dropouts", 0.05)
    first = kit.compress(scan, os.path.join(folder, "first.mcap"))
    time.sleep(1.1)  # a time of a second's resolution in the file would show
    other = shutil.copy(scan, os.path.join(kit.folder("elsewhere"), "renamed.txt"))
    second = kit.compress(other, os.path.join(folder, "second.mcap"))
    same(digest(second), digest(first), "bytes of the recording of a copy, a second later")
    with open(scan, "rb") as file:
        pipe = subprocess.Popen(["cat"], stdin=file, stdout=subprocess.PIPE)
    kit.scansion("compress", "-", "-o", second, "--force", stdin=pipe.stdout)
    pipe.stdout.close()
    same((pipe.wait(), digest(second)), (0, digest(first)), "bytes of the recording made from a pipe")
    same(kit.run("scansim", "scene", "slots", "--lines", 200, "--points", 150, "--dropouts", 0.05, "-o", second, "--force").code, 0, "scene")
    same(digest(second), digest(scan), "bytes of the same scene made again")
    for words in ([], ["--tolerance", "0.05"], ["--reduction", "95"], ["--reduction", "95", "--scope", "scan"], ["--level", "1"],
                  ["--what", "rearrangement"]):
        for form in ("xyz",) if "--what" in words else ("xyz", "csv", "ply", "pcd", "obj", "json"):
            outs = [os.path.join(folder, f"{i}.{form}") for i in range(2)]
            for out in outs:
                kit.scansion("export", first, "-o", out, "--force", *words)
            same(digest(outs[1]), digest(outs[0]), f"bytes of export {' '.join(words)} as {form}")
    cuts = [os.path.join(folder, f"cut-{i}.mcap") for i in range(2)]
    for out in cuts:
        kit.scansion("export", first, "-o", out, "--level", "1")
    same(digest(cuts[1]), digest(cuts[0]), "bytes of a recording cut to a level")


def recovered_twice(kit):
    """What recover writes depends on the damaged file only, and recovering a sound recording changes nothing."""
    folder = kit.folder("recovered")
    scan = kit.scene(os.path.join(folder, "scan.xyz"), "boss", "--lines", 200, "--points", 60)
    recording = kit.compress(scan, os.path.join(folder, "sound.mcap"))
    with open(recording, "rb") as file:
        data = file.read()
    damaged = os.path.join(folder, "damaged.mcap")
    with open(damaged, "wb") as file:
        file.write(data[:len(data) * 2 // 3])
    outs = [os.path.join(folder, f"out-{i}.mcap") for i in range(3)]
    for out in outs[:2]:
        kit.scansion("recover", damaged, "-o", out, expect=1)
    same(digest(outs[1]), digest(outs[0]), "bytes recovered twice")
    kit.scansion("recover", outs[0], "-o", outs[2])
    same(digest(outs[2]), digest(outs[0]), "bytes of a recovered recording recovered again")
    kit.scansion("recover", recording, "-o", outs[2], "--force")
    same(digest(outs[2]), digest(recording), "bytes of a sound recording recovered")


if __name__ == "__main__":
    run_cases("determinism", [any_number_of_threads, run_after_run, recovered_twice])
