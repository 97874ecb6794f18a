#!/usr/bin/env python3
"""Feature lines and patches: what is recorded comes out the same in every form, and changes nothing else.

cli_features_test.py --bin DIR --recordings DIR
"""
import itertools
import json
import os
import struct
import xml.etree.ElementTree as ElementTree

from cli_kit import check, run_cases, same

TYPES = ["convex", "concave", "step-top", "step-bottom", "ridge", "valley"]


class Place:
    """A scan of a small part, recorded with and without features."""

    numbers = itertools.count()

    def __init__(self, kit):
        self.kit, self.folder = kit, kit.folder(f"features-{next(Place.numbers)}")
        self.scan = kit.scene(os.path.join(self.folder, "scan.xyz"), "posts", "--pitch", 0.2, "--spacing", 0.2)
        self.recording = kit.compress(self.scan, self.path("on.mcap"))
        self.points = sum(1 for row in open(self.scan) if row.strip() and not row.startswith("#"))

    def path(self, name):
        return os.path.join(self.folder, name)

    def export(self, what, form, *words, recording=None):
        out = self.path(f"out-{what}.{form}")
        self.kit.scansion("export", recording or self.recording, "-o", out, "--what", what, "--force", *words)
        with open(out, "rb") as file:
            return file.read()

    def lines(self, *words, recording=None):
        """[(header fields, [[x, y, z, line, index], ...])] of the text form."""
        lines = []
        for row in self.export("features", "txt", *words, recording=recording).decode().splitlines():
            if row.startswith("# "):
                lines.append((dict(field.split("=") for field in row[2:].split()), []))
            elif row:
                lines[-1][1].append([float(value) for value in row.split()])
        return lines


def every_form_says_the_same(kit):
    place = Place(kit)
    lines = place.lines()
    check(len(lines) > 5, f"{len(lines)} feature lines on a part with bosses")
    info = kit.scansion("info", place.recording, "--json").json()
    same(info["features"], len(lines), "features of info")
    same(sum(info["features_by_type"].values()), len(lines), "features by type")
    for head, vertices in lines:
        same(set(head), {"id", "type", "level", "state", "length"}, "header of a feature line")
        check(head["type"] in TYPES and head["state"] in ("open", "closed"), f"header {head}")
        check(len(vertices) > 1 and all(len(vertex) == 5 for vertex in vertices), f"vertices of line {head['id']}")
    points = [vertex[:3] for _, vertices in lines for vertex in vertices]

    listed = json.loads(place.export("features", "json"))
    same(listed["unit"], "mm", "unit")
    same([[*vertex[:3]] for line in listed["lines"] for vertex in line["vertices"]], points, "vertices of json")
    same([line["type"] for line in listed["lines"]], [head["type"] for head, _ in lines], "types of json")

    rows = place.export("features", "csv").decode().splitlines()
    same(rows[0], "id,type,x,y,z,line,index", "heading of csv")
    same([[float(value) for value in row.split(",")[2:5]] for row in rows[1:]], points, "vertices of csv")

    obj = place.export("features", "obj").decode().splitlines()
    same(sorted([float(v) for v in row.split()[1:]] for row in obj if row.startswith("v ")), sorted(points), "vertices of obj")
    same(sum(row.startswith("l ") for row in obj), len(lines), "lines of obj")
    same({row[2:] for row in obj if row.startswith("g ")}, {head["type"] for head, _ in lines}, "groups of obj")

    dxf = place.export("features", "dxf").decode().split("\n")
    pairs = list(zip(dxf[0::2], dxf[1::2]))
    same(pairs.count(("0", "POLYLINE")), len(lines), "polylines of dxf")
    same(pairs.count(("0", "VERTEX")), len(points), "vertices of dxf")
    same(pairs[-1], ("0", "EOF"), "end of dxf")

    head, _, body = place.export("features", "ply").decode().partition("end_header\n")
    check(f"element vertex {len(points)}" in head, "vertices of ply")
    same([[float(value) for value in row.split()[:3]] for row in body.splitlines()[:len(points)]], points, "places of ply")

    tree = ElementTree.fromstring(place.export("features", "vtp"))
    piece = tree.find("PolyData/Piece")
    same(piece.get("NumberOfLines"), str(len(lines)), "lines of vtp")
    numbers = [float(value) for value in piece.find("Points/DataArray").text.split()]
    same([numbers[i:i + 3] for i in range(0, len(numbers), 3)], points, "places of vtp")
    names = [array.get("Name") for array in piece.find("CellData")]
    same(names, ["type", "id", "level", "length_mm"], "cell data of vtp")


def units_and_ranges(kit):
    place = Place(kit)
    millimetres, metres = place.lines(), place.lines("--unit", "m")
    for (_, a), (_, b) in zip(millimetres, metres):
        for p, q in zip(a, b):
            check(all(abs(x - 1000 * y) < 2e-4 for x, y in zip(p[:3], q[:3])), f"{p} in metres is {q}")
    some = place.lines("--lines", "0:20")
    check(len(some) < len(millimetres), "a range of lines leaves some out")
    check(all(any(vertex[3] < 20 for vertex in vertices) for _, vertices in some), "lines outside the range")


def patches_of_points(kit):
    place = Place(kit)
    rows = [row.split() for row in place.export("patches", "txt").decode().splitlines()]
    same(len(rows), place.points, "rows of patches")
    scanned = [row.split() for row in open(place.scan) if row.strip() and not row.startswith("#")]
    same([[float(v) for v in row[:3]] for row in rows], [[float(v) for v in row] for row in scanned], "points of patches")
    check(all(int(row[3]) >= -1 for row in rows), "numbers of patches")
    head, _, body = place.export("patches", "ply").partition(b"end_header\n")
    check(f"element vertex {place.points:020d}".encode() in head, "vertices of ply")
    same(len(body), place.points * (24 + 3 + 8), "bytes of ply")
    same([struct.unpack_from("<i", body, 35 * i + 27)[0] for i in range(place.points)], [int(row[3]) for row in rows], "patches of ply")
    same(len(place.export("patches", "csv").decode().splitlines()), place.points + 1, "rows of csv")
    same(len(json.loads(place.export("patches", "json"))["points"]), place.points, "points of json")
    few = place.export("patches", "txt", "--level", "0").decode().splitlines()
    check(0 < len(few) < place.points, f"{len(few)} points of level 0")


def holes_are_named(kit):
    place = Place(kit)
    scan = kit.scene(place.path("holes.xyz"), "holes", "--pitch", 0.2, "--spacing", 0.2, "--dropouts", 0.01, "--truth")
    recording = kit.compress(scan, place.path("holes.mcap"))
    with open(place.path("holes.truth.json")) as file:
        true = [form for form in json.load(file)["forms"] if form["kind"] == "hole"]
    same(len(true), 8, "holes of the scene")
    same(kit.scansion("info", recording, "--json").json()["forms"]["hole"], 8, "holes of info")
    lines = {int(head["id"]): head for head, _ in place.lines(recording=recording)}
    for unit, per_mm in (("mm", 1.0), ("m", 1e-3)):
        patches = json.loads(place.export("patches", "json", "--unit", unit, recording=recording))
        found = [form for form in patches["forms"] if form["kind"] == "hole"]
        for form in true:
            far = [max(abs(a - b / per_mm) for a, b in zip(form["middle"], hole["middle"])) for hole in found]
            hole = found[far.index(min(far))]
            check(min(far) < 0.3, f"a hole at {form['middle']} is {min(far)} mm away")
            check(abs(hole["area"] ** 0.5 - form["area_mm2"] ** 0.5) < 0.25, f"area {hole['area']} of {form['area_mm2']}")
            check(abs(hole["diameter"] ** 2 * 0.785398 / hole["area"] - 1) < 1e-3, "diameter")
            same(lines[hole["rim"]]["type"], "step-top", "type of a rim")
            check(any(patch["id"] == hole["patches"][0] for patch in patches["patches"]), "patch of a hole")
    svg = kit.scansion("view", recording, "-o", "-", "--format", "svg", "--shade", "patch").out
    check(svg.count(b">hole<") == 8, f"{svg.count(b'>hole<')} names of holes in the picture")


def crossed_scans(kit):
    place = Place(kit)
    across = kit.compress(kit.scene(place.path("across.xyz"), "posts", "--pitch", 0.2, "--spacing", 0.2, "--direction", 90, "--seed", 2),
                          place.path("across.mcap"))
    alone, merged = place.lines(), place.lines("--crossed", across)
    length = lambda lines: sum(float(head["length"]) for head, _ in lines)
    check(0.8 * length(alone) < length(merged) < 1.2 * length(alone), f"{length(merged)} of {length(alone)} mm: nothing is there twice")
    own = kit.scansion("info", place.recording, "--json").json()["lines"]
    counted = [vertex[3] for _, vertices in merged for vertex in vertices]
    check(min(counted) < own <= max(counted), "lines of the second scan are counted on")
    for form in ("csv", "json", "obj", "dxf", "ply", "vtp"):
        check(place.export("features", form, "--crossed", across), form)
    out = place.path("refused.txt")
    kit.scansion("export", place.recording, "-o", out, "--crossed", across, expect=2)
    kit.scansion("export", place.recording, "-o", out, "--what", "features", "--crossed", across, "--lines", "1:3", expect=2)
    check(not os.path.exists(out), "refused exports leave nothing")


def backlash_is_told(kit):
    place = Place(kit)
    same(kit.scansion("info", place.recording, "--json").json()["backlash"], None, "backlash of lines in one direction")
    scan = kit.scene(place.path("fro.xyz"), "rails", "--pitch", 0.2, "--spacing", 0.2, "--zigzag", "--backlash", 300)
    for use, taken_off in (("report", 0.0), ("correct", 0.3)):
        recording = kit.compress(scan, place.path(f"{use}.mcap"), "--backlash", use)
        told = kit.scansion("info", recording, "--json").json()["backlash"]
        check(abs(told["mm"] - 0.3) < 0.03 and abs(told["taken_off_mm"] - taken_off) < 0.03, f"{use}: {told}")
        check(b"backlash" in kit.scansion("info", recording).out, "text of info")


def limits_are_set(kit):
    place = Place(kit)
    found = lambda recording: kit.scansion("info", recording, "--json").json()
    usual = found(place.recording)
    check(usual["features"] > 0, "features by default")
    few = found(kit.compress(place.scan, place.path("long.mcap"), "--shortest-line", 1000))
    same((few["features"], few["patches"]), (0, usual["patches"]), "with no line long enough")
    strong = found(kit.compress(place.scan, place.path("strong.mcap"), "--least-turning", 89, "--least-step", 1000, "--largest-arc", 0.1))
    check(strong["features"] < usual["features"], f"of {usual['features']} lines still {strong['features']}")
    kit.refused(2, "compress", place.scan, "-o", place.path("none.mcap"), "--least-turning", 1, says="--least-turning")


def nothing_else_changes(kit):
    place = Place(kit)
    off = kit.compress(place.scan, place.path("off.mcap"), "--features", "off")
    kit.scansion("compare", place.recording, off)
    outs = []
    for recording in (place.recording, off):
        outs.append(place.export("points", "xyz", recording=recording))
    same(outs[0], outs[1], "points with and without features")
    kit.refused(2, "export", off, "-o", place.path("none.txt"), "--what", "features", says="--features on")
    kit.refused(2, "export", place.recording, "-o", place.path("none.stl"), "--what", "features", says="stl")
    kit.refused(2, "export", place.recording, "-o", place.path("none.txt"), "--what", "features", "--level", "0", says="selection")


def cut_and_compared(kit):
    place = Place(kit)
    cut = place.path("cut.mcap")
    kit.scansion("export", place.recording, "-o", cut, "--level", "0")
    kit.scansion("verify", cut)
    same(place.lines(recording=cut), place.lines(), "feature lines of a recording cut to a level")
    other = kit.compress(kit.scene(place.path("other.xyz"), "posts", "--pitch", 0.2, "--spacing", 0.2, "--seed", 7), place.path("other.mcap"))
    kit.scansion("compare", place.recording, other, "--what", "features", "--tolerance", 1000, expect=1)
    kit.scansion("compare", place.recording, place.recording, "--what", "features")


if __name__ == "__main__":
    run_cases("features", [crossed_scans, backlash_is_told, limits_are_set, every_form_says_the_same, units_and_ranges, patches_of_points, holes_are_named, nothing_else_changes, cut_and_compared])
