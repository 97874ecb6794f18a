#!/usr/bin/env python3
"""Compresses the project's recordings and compares bytes, levels and rearrangement with golden.json; of some also the messages
about feature lines and patches, byte for byte, with features.json.

golden_test.py --bin DIR --recordings DIR [--update]

A difference means that the format, the ranking, the calibration, the codec or the feature stage changed. When that is wanted, run
with --update and let the review see the new figures. Feature lines and patches are computed in floating point, with nothing fused, and
rounded when they are written: the same on every machine so far.
"""
import argparse
import hashlib
import json
import pathlib
import struct
import subprocess
import sys
import tempfile

MESSAGE, CHUNK = 5, 6  # MCAP opcodes
WITH_FEATURES = ("part.xyz", "pocket.xyz")


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


def records(data):
    at = 0
    while at + 9 <= len(data):
        opcode, size = struct.unpack_from("<BQ", data, at)
        yield opcode, data[at + 9:at + 9 + size]
        at += 9 + size


def notes(data):
    """The messages about feature lines and patches, in the order of the file."""
    for opcode, content in records(data):
        if opcode == CHUNK:
            name, = struct.unpack_from("<I", content, 28)  # of the compression; before it times, size and checksum
            yield from notes(content[28 + 4 + name + 8:])
        elif opcode == MESSAGE and content[22:].startswith(b'{"group"'):
            yield content[22:].decode()


def found(scansion, scan, folder):
    recording = folder / "f.mcap"
    run(scansion, "compress", scan, "-o", recording, "--force")
    data = recording.read_bytes()
    return dict(enumerate(notes(data[8:-8]))) # between the marks


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
        features_file.write_text(json.dumps({name: list(texts.values()) for name, texts in features.items()}, indent=1) + "\n")
        return
    differences = compare(json.loads(golden_file.read_text()), now)
    golden_features = {name: dict(enumerate(texts)) for name, texts in json.loads(features_file.read_text()).items()}
    differences += compare(golden_features, features)
    if differences:
        sys.exit(f"{differences} differences; if they are wanted: golden_test.py --update")
    print(f"{len(now)} recordings as golden")


if __name__ == "__main__":
    main()
