#!/usr/bin/env python3
"""Compresses the project's recordings and compares bytes, levels and rearrangement with golden.json, and what is found on some of
them with features.json.

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

WITH_FEATURES = ("part.xyz", "pocket.xyz", "steps.xyz")


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


def found(scansion, scan, folder):
    """Feature lines as [type, begins, ends, length in mm, partner, junctions] and the number of patches: places are the score's business."""
    recording, listed = folder / "f.mcap", folder / "features.json"
    run(scansion, "compress", scan, "-o", recording, "--force")
    run(scansion, "export", recording, "-o", listed, "--what", "features", "--force")
    lines = [[line["type"], line["begins"], line["ends"], round(line["length"], 1), line["partner"], line["junctions"]]
             for line in json.loads(listed.read_text())["lines"]]
    return {"features": lines, "patches": json.loads(run(scansion, "info", recording, "--json"))["patches"]}


def compare(golden, now):
    differences = 0
    for name in sorted(set(golden) | set(now)):
        for key in sorted(set(golden.get(name, {})) | set(now.get(name, {}))):
            want, got = golden.get(name, {}).get(key), now.get(name, {}).get(key)
            if want != got:
                differences += 1
                print(f"{name}: {key}: golden {want}, now {got}")
    return differences


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--bin", required=True)
    arguments.add_argument("--recordings", required=True)
    arguments.add_argument("--update", action="store_true")
    o = arguments.parse_args()
    golden_file, features_file = (pathlib.Path(__file__).with_name(name) for name in ("golden.json", "features.json"))
    scans = sorted(pathlib.Path(o.recordings).glob("*.xyz"))
    if not scans:
        sys.exit("no recordings in " + o.recordings)
    with tempfile.TemporaryDirectory() as folder:
        scansion, place = pathlib.Path(o.bin) / "scansion", pathlib.Path(folder)
        now = {scan.name: facts(scansion, scan, place) for scan in scans}
        features = {scan.name: found(scansion, scan, place) for scan in scans if scan.name in WITH_FEATURES}
    if o.update:
        golden_file.write_text(json.dumps(now, indent=1) + "\n")
        rows = ",\n".join(f" {json.dumps(name)}: {json.dumps(values)}" for name, values in features.items())
        features_file.write_text("{\n" + rows + "\n}\n")
        return
    differences = compare(json.loads(golden_file.read_text()), now)
    differences += compare(json.loads(features_file.read_text()), features)
    if differences:
        sys.exit(f"{differences} differences; if they are wanted: golden_test.py --update")
    print(f"{len(now)} recordings as golden")


if __name__ == "__main__":
    main()
