# Reads a recording and prints its points, written from docs/FORMAT.md and the MCAP specification alone.
# SPDX-License-Identifier: Apache-2.0
"""usage: format_reader.py RECORDING [--level K] [--csv]

Prints `x y z` rows in the input's unit, a blank line between scan lines that have points; --csv: `x,y,z,line` rows.
Decimals are exact. Every checksum, count and field is checked; exit 1 with the reason when one is wrong. Shares no code with
the programs: what they write and this cannot read is a fault of one of them or of the page.
"""
import argparse
import math
import struct
import sys
from bisect import bisect_left
from fractions import Fraction

import zstandard

from format_container import Fields, FormatError, crc32c, need, read_container

MARK = b"\x89SCNGRP\n"
HEADER = struct.Struct("<8sBBBBIIHHQQQddIII")
LINES, LEVEL, REST = 0, 1, 2
UNKNOWN = 255


class Body(Fields):
    """The numbers of a payload body."""

    def byte(self):
        return self.take(1)[0]

    def varint(self):
        value = 0
        for shift in range(0, 70, 7):
            byte = self.byte()
            value |= (byte & 0x7F) << shift
            if byte < 0x80:
                need(value < 1 << 64, f"{self.where}: a varint is too large")
                return value
        raise FormatError(f"{self.where}: a varint has more than ten bytes")

    def signed(self):
        value = self.varint()
        return value >> 1 ^ -(value & 1)

    def packed(self, size):
        if size == 0:
            return b""
        head = self.varint()
        stored, method = self.take(head >> 2), head & 3
        if method == 0:
            out = stored
        elif method == 1:
            frame = zstandard.ZstdDecompressor().decompressobj()
            out = frame.decompress(stored)
            need(frame.eof and not frame.unused_data, f"{self.where}: not one zstd frame")
        else:
            need(method == 2 and len(stored) == 1, f"{self.where}: method {method} with {len(stored)} bytes")
            out = stored * size
        need(len(out) == size, f"{self.where}: {len(out)} bytes, want {size}")
        return out

    def blob(self):
        return Body(self.packed(self.varint()), self.where)

    def planes(self, count):
        width = self.byte()
        need(width <= 8, f"{self.where}: {width} planes")
        woven = bytearray(8 * count)
        for plane in range(width):
            woven[plane::8] = self.packed(count)
        return [value >> 1 ^ -(value & 1) for value in struct.unpack(f"<{count}Q", woven)]


class Header:
    """The 76 bytes before each body."""

    def __init__(self, payload, where):
        need(len(payload) >= HEADER.size, f"{where}: payload of {len(payload)} bytes")
        (mark, version, self.kind, self.level, self.tolerances, self.stream, self.group, self.lines, self.epoch, self.first_line,
         self.first_time, self.last_time, self.tolerance, self.left_out, self.points, size, crc) = HEADER.unpack_from(payload)
        body = payload[HEADER.size:]
        need(mark == MARK and version == 1, f"{where}: mark {mark}, version {version}")
        need(size == len(body), f"{where}: body of {len(body)} bytes, header says {size}")
        need(crc == crc32c(payload[:72] + body), f"{where}: CRC-32C is wrong")
        need(1 <= self.tolerances <= 16 and 1 <= self.lines <= 64, f"{where}: {self.tolerances} tolerances, {self.lines} lines")
        self.body = Body(body, where)

    def shared(self):
        """What all payloads of a group have in common."""
        return (self.tolerances, self.stream, self.group, self.lines, self.epoch, self.first_line, self.first_time,
                self.last_time)


class Run:
    """Points first .. last of the group; `knots` are those known so far, ascending."""

    def __init__(self, first, count):
        self.first, self.last, self.knots = first, first + count - 1, []

    def __len__(self):
        return self.last - self.first + 1


class Line:
    def __init__(self, index):
        self.index, self.runs, self.invalid, self.stamps, self.plane = index, [], 0, {}, None
        self.first = self.end = 0  # its points in the group


def on_line(u, a, b, i):
    return u[a] + (u[b] - u[a]) * (i - a) // (b - a)


def polyline(u, run):
    """The polyline through the run's knots at each of its points, rounded down."""
    out = [u[run.first]]
    for a, b in zip(run.knots, run.knots[1:]):
        rise, base, width = u[b] - u[a], u[a], b - a
        out.extend(base + rise * step // width for step in range(1, width + 1))
    return out


class Group:
    """One group: the line table, then level after level."""

    def __init__(self, header):
        self.header = header
        table = header.body.blob()
        header.body.end()
        flags = table.byte()
        need(flags <= 1, f"{table.where}: flags {flags}")
        self.residuals = bool(flags)
        self.axes = []
        for _ in range(3):
            base, step = table.signed(), table.varint()
            self.axes.append((base, step >> 1, bool(step & 1)))
        self.lines, self.runs, self.count = [], [], 0
        last = [0] * 4
        for i in range(header.lines):
            self.read_line(table, header.first_line + i, last)
        table.end()
        need(self.count == header.points, f"{table.where}: {self.count} points in the table, header says {header.points}")
        self.level = [UNKNOWN] * self.count
        self.u = [[0] * self.count for _ in range(3)]
        self.remainder = [[0] * self.count for _ in range(3)]
        self.ulps = [[0] * self.count for _ in range(3)]

    def read_line(self, table, index, last):
        line, flags = Line(index), table.byte()
        need(flags < 64, f"{table.where}: line flags {flags}")
        if flags & 32:
            counts = [table.varint()]
        else:
            counts = []
            for _ in range(table.varint()):
                line.invalid += table.varint()
                counts.append(table.varint())
            line.invalid += table.varint()
        for bit in range(4):
            if flags >> bit & 1:
                last[bit] = line.stamps[bit] = (last[bit] + table.signed()) % (1 << 64)
        if flags & 16:
            line.plane = struct.unpack("<3d", table.take(24))
        line.first = self.count
        for count in counts:
            need(count >= 1, f"{table.where}: a run without points")
            line.runs.append(Run(self.count, count))
            self.count += count
        line.end = self.count
        self.runs += line.runs
        self.lines.append(line)

    def add(self, header):
        """A level or the rest, in their order."""
        body = header.body
        if header.kind == REST:
            new = [i for i in range(self.count) if self.level[i] == UNKNOWN]
            self.read_rest(body, new)
        else:
            new = self.read_level(body, header.level)
        need(len(new) == header.points, f"{body.where}: {len(new)} points, header says {header.points}")
        for values, (_, _, split) in zip(self.remainder, self.axes):
            if split:
                self.store(values, new, body.planes(len(new)))
        if self.residuals:
            for values in self.ulps:
                self.store(values, new, body.planes(len(new)))
        self.store(self.level, new, [header.level] * len(new))
        body.end()

    @staticmethod
    def store(values, where, what):
        for i, value in zip(where, what):
            values[i] = value

    # Levels

    def read_level(self, body, k):
        """Gives the new points, ascending."""
        inner = self.positions(body, k)
        coarser = [[run.first, run.last] if k == 0 else run.knots for run in self.runs]
        ends = [] if k else [sorted({run.first, run.last}) for run in self.runs]
        for run, old, points in zip(self.runs, coarser, inner):
            run.knots = sorted({*old, *points})
        new = sorted(i for points in ends + inner for i in points)
        for u in self.u:
            mode = body.byte()
            need(mode <= 2, f"{body.where}: mode {mode}")
            residuals = iter(body.planes(len(new)))
            before = None
            for run, old, points in zip(self.runs, coarser, inner):
                if k == 0:
                    u[run.first] = (u[before.first] if before else 0) + next(residuals)
                    if run.last != run.first:
                        u[run.last] = (u[before.last] if before else 0) + next(residuals)
                self.read_inner(u, mode, residuals, run, before, old, points)
                before = run
        return new

    def positions(self, body, k):
        """For each run its new inner points, ascending."""
        counts, skips, out = body.blob(), body.blob(), []
        for run in self.runs:
            unknown = [i for i in range(run.first + 1, run.last) if self.level[i] == UNKNOWN]
            at, points = -1, []
            for _ in range(counts.varint()):
                at += skips.varint() + 1
                need(at < len(unknown), f"{body.where}: level {k} has a point outside its run")
                points.append(unknown[at])
            out.append(points)
        counts.end()
        skips.end()
        return out

    @staticmethod
    def read_inner(u, mode, residuals, run, before, coarser, points):
        """`coarser`: the points of the run that are known without this level."""
        curve = polyline(u, before) if mode == 2 and before and points else None
        for i in points:
            right = coarser[bisect_left(coarser, i)]
            left = run.knots[bisect_left(run.knots, i) - 1]
            guess = u[left] if mode == 1 else on_line(u, left, right, i)
            if curve:
                a, b, at = (min(j - run.first, len(before) - 1) for j in (left, right, i))
                if a != b:
                    guess += curve[at] - on_line(curve, a, b, at)
            u[i] = guess + next(residuals)

    # Rest

    def read_rest(self, body, new):
        axis = body.byte()
        need(axis <= 2, f"{body.where}: lines along axis {axis}")
        modes, weights = [], []
        for _ in range(3):
            modes.append(body.byte())
            need(modes[-1] <= 3, f"{body.where}: mode {modes[-1]}")
            weights.append([body.signed() for _ in range(7)] if modes[-1] == 0 else None)
            need(not weights[-1] or all(-32768 <= w <= 32767 for w in weights[-1]), f"{body.where}: weights {weights[-1]}")
        curves = [[value for run in self.runs for value in polyline(u, run)] for u in self.u]
        neighbours = self.neighbours(curves[axis])
        starts = [run.first for run in self.runs for _ in range(len(run))]
        for u, curve, mode, weight in zip(self.u, curves, modes, weights):
            self.read_axis(u, curve, mode, weight, zip(new, body.planes(len(new))), starts, neighbours)

    def neighbours(self, curve):
        """For each point (j, first, end): its neighbour in the line before and that line's points; j None without one."""
        out, before = [], None
        for line in self.lines:
            if line.first == line.end:
                continue
            if before is None:
                out += [(None, 0, 0)] * line.end
            else:
                j = before.first
                for i in range(line.first, line.end):
                    if self.level[i] == UNKNOWN:
                        j = self.walk(curve, curve[i], j, before)
                    out.append((j, before.first, before.end))
            before = line
        return out

    @staticmethod
    def walk(curve, here, j, before):
        for _ in range(8):
            if j + 1 == before.end or abs(here - curve[j + 1]) > abs(here - curve[j]):
                break
            j += 1
        for _ in range(8):
            if j == before.first or abs(here - curve[j - 1]) >= abs(here - curve[j]):
                break
            j -= 1
        return j

    @staticmethod
    def read_axis(u, curve, mode, weights, residuals, starts, neighbours):
        for i, residual in residuals:
            start = starts[i]
            j, first, end = neighbours[i]
            if mode == 0:
                near = [i - n if i - n >= start else None for n in (1, 2, 3, 4)]
                near += [n if j is not None and first <= n < end else None for n in ((j, j + 1, j - 1) if j is not None else ())]
                total = sum(weight * (u[n] - curve[n]) for weight, n in zip(weights, near) if n is not None)
                guess = curve[i] + (2048 + total) // 4096
            elif mode == 1 or mode == 2 and i - 2 < start:
                guess = u[i - 1]
            elif mode == 2:
                guess = 2 * u[i - 1] - u[i - 2]
            else:
                guess = curve[i] if j is None else u[j]
            u[i] = guess + residual


# Values


def ordered(value, form):
    """The rank of a float or double among all of its kind: 0 is +0, -1 is -0, next representable numbers are neighbours."""
    bits = int.from_bytes(struct.pack(">" + form, value), "big")
    top = 1 << 8 * struct.calcsize(form) - 1
    return bits if bits < top else top - 1 - bits


def from_ordered(rank, form):
    size = struct.calcsize(form)
    bits = rank if rank >= 0 else (1 << 8 * size - 1) - 1 - rank
    return struct.unpack(">" + form, bits.to_bytes(size, "big"))[0]


def nearest(value, form):
    """The number of the source type nearest to a Fraction, ties to even."""
    double = value.numerator / value.denominator
    if form == "d":
        return double
    rank = ordered(double, "f")
    return min((from_ordered(rank + step, "f") for step in (0, -1, 1)),
               key=lambda x: (abs(Fraction(x) - value), struct.pack("<f", x)[0] & 1))


def ieee_text(value, form):
    """The shortest text that gives the same number of the source type."""
    wanted = struct.pack(form, value)
    return next(text for text in (f"{value:.{digits}g}" for digits in range(1, 18)) if struct.pack(form, float(text)) == wanted)


def decimal(value):
    """A Fraction as text: exact when it has finitely many decimals, else the shortest text of the nearest double."""
    rest, twos, fives = value.denominator, 0, 0
    while rest % 2 == 0:
        rest, twos = rest // 2, twos + 1
    while rest % 5 == 0:
        rest, fives = rest // 5, fives + 1
    if rest != 1:
        return ieee_text(value.numerator / value.denominator, "d")
    places = max(twos, fives)
    digits = f"{abs(value.numerator) * 10 ** places // value.denominator:0{places + 1}}"
    sign = "-" if value < 0 else ""
    return sign + (digits[:-places] + "." + digits[-places:] if places else digits)


class Recording:
    """`groups` hold the decoded points; `points(level)` gives them as (line index, [x, y, z]), exact."""

    def __init__(self, data, level=None):
        try:
            self.read(data, level)
        except (ValueError, ArithmeticError, LookupError, StopIteration, struct.error, zstandard.ZstdError) as error:
            raise FormatError(f"{type(error).__name__}: {error}") from error

    def read(self, data, level):
        container = read_container(data)
        self.facts, self.totals, self.gaps = container.facts, container.totals, container.gaps
        facts = self.facts
        need(facts["format"] == "1", f"format {facts['format']}, want 1")
        numerator, denominator = map(int, facts["resolution"].split("/"))
        need(numerator > 0 and denominator > 0 and math.gcd(numerator, denominator) == 1, f"resolution {facts['resolution']}")
        self.resolution = Fraction(numerator, denominator)
        self.origin = [int(count) for count in facts["origin"].split(" ")]
        need(len(self.origin) == 3, f"origin {facts['origin']}")
        self.form = {"decimal": None, "float32": "f", "float64": "d"}[facts["source"]]
        need(facts["exact"] == "no" or facts["exact"] == "yes" and self.form, f"exact {facts['exact']} of {facts['source']}")
        self.level_count, self.stored = int(facts["level_count"]), int(facts["stored_levels"])
        wanted = self.stored if level is None else min(level + 1, self.stored)
        self.groups = [self.read_group(sequence, time, payloads, wanted) for sequence, time, payloads in container.groups]
        self.check_order()
        self.check_totals()

    def read_group(self, sequence, time, payloads, wanted):
        where = f"group {sequence}"
        headers = [Header(payload, f"{where} payload {i}") for i, payload in enumerate(payloads)]
        first = headers[0]
        self.check_headers(where, headers)
        need((first.group, first.first_time) == (sequence, time), f"{where}: the message has another number or time")
        group = Group(first)
        need(group.residuals == (self.facts["exact"] == "yes"), f"{where}: residuals")
        times = [line.stamps.get(2, line.index * 1000000 % (1 << 64)) for line in group.lines]
        need((first.first_time, first.last_time) == (times[0], times[-1]), f"{where}: times of the header")
        for header in headers[1:wanted + 1]:
            group.add(header)
        group.headers = headers
        return group

    def check_headers(self, where, headers):
        first, levels, rest = headers[0], [h for h in headers if h.kind == LEVEL], [h for h in headers if h.kind == REST]
        kinds = [(LINES, 0)] + [(REST if k == self.level_count else LEVEL, k) for k in range(self.stored)]
        need([(header.kind, header.level) for header in headers] == kinds, f"{where}: kinds and levels")
        need(len({header.shared() for header in headers}) == 1, f"{where}: headers differ")
        need((first.tolerances, first.stream) == (self.level_count, int(self.facts["stream"])), f"{where}: not of this recording")
        tolerances, left = [header.tolerance for header in levels], [header.left_out for header in levels]
        need(tolerances == sorted(set(tolerances), reverse=True) and all(t > 0 for t in tolerances), f"{where}: {tolerances}")
        need(all(0 <= x <= t for x, t in zip(left, tolerances)) and left == sorted(left, reverse=True), f"{where}: left out {left}")
        need(first.tolerance == 0 and first.left_out >= left[0], f"{where}: {first.left_out} for lines")
        for header in rest:
            need((header.tolerance, header.left_out) == (0, 0), f"{where}: rest leaves something out")
            need(sum(h.points for h in headers[1:]) == first.points, f"{where}: the points of the levels are not all points")

    def check_order(self):
        """Groups and lines ascend, and what is missing between them is named by a gap message."""
        holes = sorted((gap["first"], gap["count"] or math.inf) for gap in self.gaps)
        for before, after in zip(self.groups, self.groups[1:]):
            end, start = before.header.first_line + before.header.lines, after.header.first_line
            need(before.header.group < after.header.group and end <= start, f"group {after.header.group}: out of order")
            for first, count in holes:
                if first <= end < start:
                    end = max(end, first + count)
            need(end >= start, f"group {after.header.group}: lines {end} to {start - 1} are missing and no gap says so")

    def check_totals(self):
        if self.totals is None:
            return
        lines = [line for group in self.groups for line in group.lines]
        have = {"lines": len(lines), "points": sum(group.count for group in self.groups),
                "runs": sum(len(line.runs) for line in lines), "invalid": sum(line.invalid for line in lines),
                "gaps": len(self.gaps), "groups": len(self.groups)}
        said = {key: int(self.totals[key]) for key in have}
        need(have == said, f"the recording holds {have}, scansion.end says {said}")

    def value(self, group, axis, i):
        """A Fraction, or a float when the recording keeps IEEE values."""
        base, step, _ = group.axes[axis]
        value = (self.origin[axis] + base + step * group.u[axis][i] + group.remainder[axis][i]) * self.resolution
        if not group.residuals:
            return value
        return from_ordered(ordered(nearest(value, self.form), self.form) + group.ulps[axis][i], self.form)

    def points(self, level=None):
        level = UNKNOWN - 1 if level is None else level
        for group in self.groups:
            for line in group.lines:
                for i in range(line.first, line.end):
                    if group.level[i] <= level:
                        yield line.index, [self.value(group, axis, i) for axis in range(3)]

    def rows(self, level=None, csv=False):
        """The points up to the level as text, without an end of line."""
        before = None
        for index, point in self.points(level):
            if not csv and before not in (None, index):
                yield ""
            before = index
            row = [ieee_text(x, self.form) if isinstance(x, float) else decimal(x) for x in point]
            yield ",".join(row + [str(index)]) if csv else " ".join(row)


def main():
    parser = argparse.ArgumentParser(description="Prints the points of a recording; a second opinion on docs/FORMAT.md.")
    parser.add_argument("recording")
    parser.add_argument("--level", type=int, help="only the points of this stored level and the coarser ones")
    parser.add_argument("--csv", action="store_true", help="x,y,z,line rows")
    options = parser.parse_args()
    with open(options.recording, "rb") as file:
        data = file.read()
    try:
        recording = Recording(data, options.level)
    except FormatError as error:
        sys.exit(f"{options.recording}: {error}")
    for row in recording.rows(options.level, options.csv):
        print(row)
    print(f"{options.recording}: {'complete' if recording.totals else 'unfinished'}, {len(recording.groups)} groups", file=sys.stderr)


if __name__ == "__main__":
    main()
