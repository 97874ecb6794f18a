#!/usr/bin/env python3
"""scansion view: the picture shows what the recording holds, where it holds it.

cli_view_test.py --bin DIR --recordings DIR
"""
import base64
import itertools
import os
import re
import struct
import xml.etree.ElementTree as ElementTree
import zlib

from cli_kit import check, run_cases, same

SVG = "{http://www.w3.org/2000/svg}"
NOTHING = (0xF2, 0xF2, 0xF2)
COLOURS = {"convex": (214, 39, 40), "concave": (31, 119, 180), "step-top": (255, 127, 14), "step-bottom": (23, 190, 207),
           "ridge": (188, 160, 0), "valley": (148, 103, 189)}


class Picture:
    """A PNG of 8 bit RGB as (r, g, b) by column and row."""

    def __init__(self, data):
        same(data[:8], b"\x89PNG\r\n\x1a\n", "mark of a png")
        packed, at = b"", 8
        while at < len(data):
            length, kind = struct.unpack_from(">I4s", data, at)
            body = data[at + 8:at + 8 + length]
            same(zlib.crc32(kind + body), struct.unpack_from(">I", data, at + 8 + length)[0], "checksum of a chunk")
            if kind == b"IHDR":
                self.width, self.height, depth, colours = struct.unpack_from(">IIBB", body)
                same((depth, colours), (8, 2), "depth and colours")
            if kind == b"IDAT":
                packed += body
            at += 12 + length
        self.rows = list(self.unfiltered(zlib.decompress(packed)))

    def unfiltered(self, data):
        stride = 3 * self.width
        above = bytearray(stride)
        for row in range(self.height):
            kind, line = data[row * (stride + 1)], bytearray(data[row * (stride + 1) + 1:(row + 1) * (stride + 1)])
            for i in range(stride):
                a = line[i - 3] if i >= 3 else 0
                b, c = above[i], above[i - 3] if i >= 3 else 0
                line[i] = (line[i] + (0, a, b, (a + b) // 2, self.paeth(a, b, c))[kind]) & 255
            yield line
            above = line

    @staticmethod
    def paeth(a, b, c):
        p = a + b - c
        return min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]

    def at(self, column, row):
        return tuple(self.rows[row][3 * column:3 * column + 3])

    def count(self, colour, columns=None):
        wanted = bytes(colour)
        first, end = columns or (0, self.width)
        return sum(bytes(row[3 * i:3 * i + 3]) == wanted for row in self.rows for i in range(first, end))


class Place:
    """Recordings made by hand, and what view makes of them."""

    numbers = itertools.count()

    def __init__(self, kit):
        self.kit, self.folder = kit, kit.folder(f"view-{next(Place.numbers)}")

    def path(self, name):
        return os.path.join(self.folder, name)

    def scan(self, name, lines, *words):
        with open(self.path(name + ".xyz"), "w") as file:
            file.write("\n".join("".join("%.3f %.3f %.3f\n" % point for point in line) for line in lines))
        return self.kit.compress(self.path(name + ".xyz"), self.path(name + ".mcap"), *words)

    def view(self, recording, form, *words):
        out = self.path("out." + form)
        self.kit.scansion("view", recording, "-o", out, "--force", *words)
        with open(out, "rb") as file:
            return file.read()


def svg_of(data):
    root = ElementTree.fromstring(data)
    image = root.find(SVG + "image")
    picture = Picture(base64.b64decode(image.get("href").removeprefix("data:image/png;base64,")))
    same((picture.width, picture.height), (int(image.get("width")), int(image.get("height"))), "size of the image")
    return root, picture, [float(image.get(key)) for key in "xy"]


def feature_lines_in_their_place(kit):
    place = Place(kit)
    scan = kit.scene(place.path("posts.xyz"), "posts", "--pitch", 0.2, "--spacing", 0.2)
    recording = kit.compress(scan, place.path("posts.mcap"))
    root, _, _ = svg_of(place.view(recording, "svg"))
    info = kit.scansion("info", recording, "--json").json()
    drawn = {group.get("id"): list(group) for group in root.iter(SVG + "g") if group.get("id")}
    same(set(drawn), set(COLOURS), "groups of lines")
    same({kind: len(lines) for kind, lines in drawn.items() if lines},
         {kind: count for kind, count in info["features_by_type"].items() if count}, "lines by type")
    for group in root.iter(SVG + "g"):
        if group.get("id"):
            same(group.get("stroke"), "#%02x%02x%02x" % COLOURS[group.get("id")], "colour of " + group.get("id"))
    labels = [text.text for text in root.iter(SVG + "text")]
    check(any(f"posts.mcap: {info['lines']} lines, {info['points']} points" == text for text in labels), f"caption in {labels}")
    check(f"Feature lines: {info['features']}" in labels, f"number of lines in {labels}")

    # One scale and one offset take every vertex of the exported lines to the picture, y turned round.
    kit.scansion("export", recording, "-o", place.path("lines.txt"), "--what", "features")
    vertices = {}
    for row in open(place.path("lines.txt")):
        if row.startswith("#"):
            head = dict(field.split("=") for field in row[2:].split())
            points = vertices.setdefault(f"{head['type']} {head['id']}", [])
        elif row.strip():
            points.append([float(value) for value in row.split()[:2]])
    pairs = []
    for lines in drawn.values():
        for line in lines:
            shown = [[float(v) for v in pair.split(",")] for pair in line.get("points").split()]
            real = vertices[line.find(SVG + "title").text]
            same(len(shown), len(real), "vertices of a line")
            pairs += zip(real, shown)
    (ax, ay), (au, av) = min(pairs)
    (bx, _), (bu, _) = max(pairs)
    scale = (bu - au) / (bx - ax)
    for (x, y), (u, v) in pairs:
        check(abs(u - au - scale * (x - ax)) < 0.05 and abs(v - av + scale * (y - ay)) < 0.05, f"({x}, {y}) is drawn at ({u}, {v})")
    bar = next(text for text in labels if re.fullmatch(r"[\d.e+-]+ mm", text) and text[0] in "125")
    lengths = [float(box.get("width")) for box in root.findall(SVG + "rect")[1:]]
    check(any(abs(length - scale * float(bar.split()[0])) < 0.05 for length in lengths), f"no bar of {bar} at {scale} pixels a mm")


def heights_patches_and_colours(kit):
    place = Place(kit)
    # A low half, a high half, and lines missing in the middle.
    lines = [[(0.1 * i, 0.1 * k, 5.0 if k >= 60 else 1.0) for i in range(100)] for k in range(100) if not 40 <= k < 50]
    recording = place.scan("step", lines)
    root, image, _ = svg_of(place.view(recording, "svg", "--size", 600))
    low, high = image.at(image.width // 2, image.height * 8 // 10), image.at(image.width // 2, image.height * 2 // 10)
    check(sum(high) > sum(low) + 100, f"low ground {low}, high ground {high}")
    same(image.at(image.width // 2, image.height * 55 // 100), NOTHING, "colour of missing lines")
    labels = [text.text for text in root.iter(SVG + "text")]
    check("1.00 mm" in labels and "5.00 mm" in labels, f"heights in {labels}")

    patches = svg_of(place.view(recording, "svg", "--size", 600, "--shade", "patch"))[1]
    for row in (2, 8):
        check(patches.at(patches.width // 2, patches.height * row // 10) not in (low, high, NOTHING), "patches look like heights")

    page = Picture(place.view(recording, "png", "--size", 600))
    check(max(page.width, page.height) <= 600, f"{page.width} x {page.height} pixels")
    legend = (page.width * 7 // 10, page.width)
    for kind, colour in COLOURS.items():
        check(page.count(colour, legend) > 4, f"no {kind} in the key")


def names_of_forms(kit):
    place = Place(kit)
    # A plate of 30 x 30 mm with a pocket of 10 x 8 mm around (9, 20), and a boss of 8 x 8 mm around (22, 8).
    def height(x, y):
        return -2.0 if abs(x - 9) < 5 and abs(y - 20) < 4 else 2.0 if abs(x - 22) < 4 and abs(y - 8) < 4 else 0.0
    lines = [[(0.2 * i, 0.2 * k, height(0.2 * i, 0.2 * k)) for i in range(151)] for k in range(151)]
    recording = place.scan("forms", lines)
    root, image, (left, top) = svg_of(place.view(recording, "svg", "--size", 600, "--shade", "patch"))
    scale = image.width / 30.0
    where = {text.text: (float(text.get("x")) - left, float(text.get("y")) - top) for text in root.iter(SVG + "text")}
    for name, x, y, reach in (("pocket", 9, 20, 3), ("boss", 22, 8, 3)):
        check(name in where, f"no {name} among {sorted(where)}")
        u, v = where[name]
        check(abs(u / scale - x) < reach and abs(30 - v / scale - y) < reach, f"{name} at {u / scale:.1f}, {30 - v / scale:.1f}")
    # The names stand over the colours in both formats, and only there.
    page, plain = (Picture(place.view(recording, "png", "--size", 600, "--shade", shade)) for shade in ("patch", "height"))
    inside = (int(left), int(left) + image.width)
    check(page.count((255, 255, 255), inside) > plain.count((255, 255, 255), inside) + 100, "no ground under names")
    words = [text.text for text in svg_of(place.view(recording, "svg"))[0].iter(SVG + "text")]
    check("pocket" not in words, "names on heights")


def kept_points(kit):
    place = Place(kit)
    lines = [[(0.1 * i, 0.5 * k, 3.0 if i == 50 else 0.0) for i in range(101)] for k in range(20)]
    recording = place.scan("ridge", lines, "--levels", "explicit:1", "--features", "off")
    plain = svg_of(place.view(recording, "svg"))[1]
    marked = svg_of(place.view(recording, "svg", "--level", 0))[1]
    every = svg_of(place.view(recording, "svg", "--level", 1))[1]
    dark = (0x10, 0x10, 0x10)
    same(plain.count(dark), 0, "marks without --level")
    middle = (marked.width // 2 - 12, marked.width // 2 + 12)
    check(20 <= marked.count(dark, middle) <= 20 * 3 * 9, f"{marked.count(dark, middle)} pixels of the 60 points on the ridge")
    check(marked.count(dark, (marked.width // 5, marked.width * 2 // 5)) == 0, "points of level 0 on flat ground")
    check(every.count(dark) > 5 * marked.count(dark), "all points are more than those of level 0")


def odd_scans_and_refusals(kit):
    place = Place(kit)
    for name, lines in {"point": [[(1, 2, 3)]], "line": [[(i, 0, 0) for i in range(50)]], "column": [[(0, i, i)] for i in range(50)],
                        "wall": [[(0, 0, i) for i in range(9)]] * 2, "far": [[(i * 1000, k, 0) for i in range(99)] for k in range(3)]}.items():
        root, image, _ = svg_of(place.view(place.scan(name, lines), "svg", "--size", 300))
        check(any(image.at(i, k) != NOTHING for i in range(image.width) for k in range(image.height)), f"{name}: nothing drawn")
        stretched = any("times as large" in (text.text or "") for text in root.iter(SVG + "text"))
        same(stretched, name in ("line", "far"), f"{name}: stretched")
    off = place.scan("off", [[(i, k, 0) for i in range(9)] for k in range(9)], "--features", "off")
    check(b"no feature lines recorded" in place.view(off, "svg"), "words for a recording without features")
    kit.refused(2, "view", off, "-o", place.path("a.png"), "--shade", "patch", says="--features on")
    kit.refused(2, "view", off, "-o", place.path("a.jpg"), says="jpg")
    kit.refused(2, "view", off, "-o", place.path("a.png"), "--level", "9", says="levels 0 to")
    kit.refused(2, "view", off, "-o", place.path("a.png"), "--size", "99999", says="--size")
    kit.refused(73, "view", off, "-o", place.path("off.xyz"), "--format", "svg", says="--force")
    piped = kit.scansion("view", off, "-o", "-", "--format", "svg")
    check(piped.out.startswith(b"<?xml"), "standard output")


if __name__ == "__main__":
    run_cases("view", [feature_lines_in_their_place, heights_patches_and_colours, names_of_forms, kept_points, odd_scans_and_refusals])
