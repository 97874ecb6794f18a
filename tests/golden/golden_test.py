#!/usr/bin/env python3
"""Compresses the project's recordings and compares bytes, levels and rearrangement with golden.json.

golden_test.py --bin DIR --recordings DIR [--update]

A difference means that the format, the ranking, the calibration or the codec changed. When that is wanted, run with --update and
let the review see the new figures.
"""
import argparse
import hashlib
import json
import pathlib
import subprocess
import sys
import tempfile


def run(*command):
    return subprocess.run([str(c) for c in command], check=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE).stdout


def sha256(path):
    return hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()


def facts(scansion, scan, folder):
    recording = folder / "r.mcap"
    ranks = folder / "ranks.txt"
    run(scansion, "compress", scan, "-o", recording, "--force", "--features", "off")
    run(scansion, "export", recording, "-o", ranks, "--what", "rearrangement", "--force")
    info = json.loads(run(scansion, "info", recording, "--json"))
    return {
        "recording_sha256": sha256(recording),
        "rearrangement_sha256": sha256(ranks),
        **{key: info[key] for key in ("lines", "points", "runs", "invalid", "levels", "points_per_level", "bytes")},
    }


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--bin", required=True)
    arguments.add_argument("--recordings", required=True)
    arguments.add_argument("--update", action="store_true")
    o = arguments.parse_args()
    golden_file = pathlib.Path(__file__).with_name("golden.json")
    scans = sorted(pathlib.Path(o.recordings).glob("*.xyz"))
    if not scans:
        sys.exit("no recordings in " + o.recordings)
    with tempfile.TemporaryDirectory() as folder:
        now = {scan.name: facts(pathlib.Path(o.bin) / "scansion", scan, pathlib.Path(folder)) for scan in scans}
    if o.update:
        golden_file.write_text(json.dumps(now, indent=1) + "\n")
        return
    golden = json.loads(golden_file.read_text())
    differences = 0
    for name in sorted(set(golden) | set(now)):
        for key in sorted(set(golden.get(name, {})) | set(now.get(name, {}))):
            want, got = golden.get(name, {}).get(key), now.get(name, {}).get(key)
            if want != got:
                differences += 1
                print(f"{name}: {key}: golden {want}, now {got}")
    if differences:
        sys.exit(f"{differences} differences; if they are wanted: golden_test.py --update")
    print(f"{len(now)} recordings as golden")


if __name__ == "__main__":
    main()
