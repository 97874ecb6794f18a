# The promises of ranking and selection, computed anew with whole numbers only: the reference the tool is held against.
# SPDX-License-Identifier: Apache-2.0
"""Points are triples of ints: counts of one lattice. Slow and plain on purpose; it shares no code with the pipeline."""

import math
from fractions import Fraction

MM_PER_UNIT = {"m": Fraction(1000), "mm": Fraction(1), "um": Fraction(1, 1000), "in": Fraction(254, 10), "ft": Fraction(3048, 10)}


# Decimal text, exactly

def scaled(text, digits):
    """A plain decimal as a whole number of 10^-digits; fails when it has more decimals than that."""
    whole, _, fraction = text.partition(".")
    if fraction[digits:].strip("0"):
        raise ValueError(f"{text} has more than {digits} decimals")
    return int(whole + fraction[:digits].ljust(digits, "0"))


def read_xyz(path, convert=lambda text: text):
    """Scan lines of a text file: lists of (x, y, z), each coordinate passed through `convert`."""
    lines, current = [], []
    with open(path, encoding="ascii") as file:
        for row in file:
            if row.startswith("#"):
                continue
            words = row.split()
            if words:
                current.append((convert(words[0]), convert(words[1]), convert(words[2])))
            elif current:
                lines.append(current)
                current = []
    if current:
        lines.append(current)
    return lines


def read_counts(path, digits=3):
    return read_xyz(path, lambda text: scaled(text, digits))


# Distance

def squared_distance(p, a, b):
    """Squared distance of p to the segment a b as (numerator, denominator)."""
    ex, ey, ez = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    dx, dy, dz = p[0] - a[0], p[1] - a[1], p[2] - a[2]
    along = dx * ex + dy * ey + dz * ez
    to_a = dx * dx + dy * dy + dz * dz
    if along <= 0:
        return to_a, 1
    length = ex * ex + ey * ey + ez * ez
    if along >= length:
        return (p[0] - b[0]) ** 2 + (p[1] - b[1]) ** 2 + (p[2] - b[2]) ** 2, 1
    return to_a * length - along * along, length


def farthest(points, a, b):
    """(numerator, denominator, index) of the inner point farthest from the chord a b; a tie goes to the point closest to the
    middle of the interval, then to the smaller index."""
    best_n, best_d, best = -1, 1, None
    first, last = points[a], points[b]
    for k in range(a + 1, b):
        n, d = squared_distance(points[k], first, last)
        order = n * best_d - best_n * d
        if order > 0 or (order == 0 and abs(2 * k - a - b) < abs(2 * best - a - b)):
            best_n, best_d, best = n, d, k
    return best_n, best_d, best


# Selection

def textbook(points, tolerance_squared):
    """Indices that Douglas-Peucker keeps, splitting while the distance is above the tolerance; tolerance in counts, squared."""
    keep = {0, len(points) - 1}
    open_intervals = [(0, len(points) - 1)]
    while open_intervals:
        a, b = open_intervals.pop()
        if b - a < 2:
            continue
        n, d, k = farthest(points, a, b)
        if n * tolerance_squared.denominator > tolerance_squared.numerator * d:
            keep.add(k)
            open_intervals += [(a, k), (k, b)]
    return sorted(keep)


def millimetres(n, d, resolution):
    """The double that stands for a squared distance: square root of the rounded quotient, times the resolution in mm."""
    if n == 0:
        return 0.0
    return math.sqrt(float(n) / float(d)) * float(resolution.numerator) / float(resolution.denominator)


class Ranking:
    """Distances, depths and rank order of one run. D is infinite at the ends."""

    def __init__(self, points, resolution):
        count = len(points)
        self.distance = [math.inf] * count
        self.depth = [0] * count
        self.squared = [None] * count  # exact, in counts; after the minimum with the parent
        open_intervals = [(0, count - 1, None, math.inf, 1)]
        while open_intervals:
            a, b, parent, parent_mm, depth = open_intervals.pop()
            if b - a < 2:
                continue
            n, d, k = farthest(points, a, b)
            mm = millimetres(n, d, resolution)
            if parent is not None and n * parent[1] > parent[0] * d:
                n, d, mm = parent[0], parent[1], parent_mm
            self.squared[k], self.distance[k], self.depth[k] = (n, d), mm, depth
            open_intervals += [(a, k, (n, d), mm, depth + 1), (k, b, (n, d), mm, depth + 1)]
        inner = sorted(range(1, count - 1), key=lambda i: (-self.distance[i], self.depth[i], i))
        self.order = ([0] if count else []) + ([count - 1] if count > 1 else []) + inner

    def above(self, tolerance_mm):
        return [i for i, d in enumerate(self.distance) if d > tolerance_mm]


def kept_of_run(count, percent):
    """m + 1 points with m = floor((100 - k) / 100 * count), at least the end points."""
    m = math.floor((100 - percent) / 100 * count)
    return min(count, max(m + 1, min(count, 2)))


def kept_of_scan(count, percent):
    """round((100 - k) / 100 * count), halves upwards."""
    return math.floor((100 - percent) / 100 * count + Fraction(1, 2))


def largest_left_out(points, kept):
    """Exact largest squared distance in counts of any point to the polyline through the kept ones (ascending indices)."""
    worst = Fraction(0)
    for a, b in zip(kept, kept[1:]):
        if b - a > 1:
            n, d, _ = farthest(points, a, b)
            worst = max(worst, Fraction(n, d))
    return worst


def read_rearrangement(path):
    """[(line, run, count, [(j, text of d)])] of a rearrangement file."""
    runs = []
    with open(path, encoding="ascii") as file:
        for row in file:
            words = row.split()
            if words[0] == "#":
                if words[1] != "line" or words[3] != "run" or words[5] != "n+1" or len(words) != 7:
                    raise ValueError(f"not a run heading: {row!r}")
                runs.append((int(words[2]), int(words[4]), int(words[6]), []))
            else:
                runs[-1][3].append((int(words[0]), words[1]))
    return runs
