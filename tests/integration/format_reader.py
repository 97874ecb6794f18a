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
HEADER = struct.Struct("<8sBIBBI")
LINES, LEVEL, REST = 0, 1, 2
NOMINAL_NS = 1000000  # from line to line where there are no stamps
UNKNOWN = 255


def zigzag(value):
    return value >> 1 ^ -(value & 1)


def wrap(value):
    return (value + (1 << 31)) % (1 << 32) - (1 << 31)


def held(value, low, high):
    return min(max(value, low), high)


class Bits:
    def __init__(self, data, where):
        self.data, self.at, self.where = data, 0, where

    def take(self, count):
        need(self.at + count <= 8 * len(self.data), f"{self.where}: the bits are cut short")
        first, last = self.at // 8, (self.at + count + 7) // 8
        value = int.from_bytes(self.data[first:last], "little") >> self.at % 8 & (1 << count) - 1
        self.at += count
        return value

    def gamma(self):
        zeros = 0
        while not self.take(1):
            zeros += 1
        return (1 << zeros | self.take(zeros)) - 1

    def end(self):
        rest = 8 * len(self.data) - self.at
        need(rest < 8 and self.take(rest) == 0, f"{self.where}: {rest} bits too many")


class Table:
    def __init__(self, bits):
        tokens, before, classes = bits.gamma(), 48, []
        need(tokens <= 140, f"{bits.where}: {tokens} tokens")
        for _ in range(tokens):
            before += zigzag(bits.gamma())
            need(0 <= before <= 48, f"{bits.where}: class {before}")
            classes.append(before)
        weights = [(4 + (k - 1) % 4) << (k - 1) // 4 if k else 0 for k in classes]
        need(sum(weights) > 0, f"{bits.where}: a table without tokens")
        self.frequency = [max(1, 4096 * w // sum(weights)) if w else 0 for w in weights]
        self.frequency[classes.index(max(classes))] += max(0, 4096 - sum(self.frequency))
        for _ in range(sum(self.frequency) - 4096):
            self.frequency[self.frequency.index(max(self.frequency))] -= 1
        self.start = [sum(self.frequency[:t]) for t in range(tokens)]
        self.token = [t for t in range(tokens) for _ in range(self.frequency[t])]


class Coded:
    """Integers with contexts: next(context), and end() when all are taken."""

    def __init__(self, body, states):
        self.where, count = body.where, body.byte()
        need(count <= 12, f"{self.where}: {count} tables")
        self.tables, self.n = [], 0
        if not count:
            return
        starts = [0] + [body.byte() for _ in range(count - 1)] + [48]
        need(all(a < b for a, b in zip(starts, starts[1:])), f"{self.where}: tables at contexts {starts}")
        bits = Bits(body.rest(), self.where)
        tables = [Table(bits) for _ in range(count)]
        body.take((bits.at + 7) // 8)
        self.tables = [table for table, a, b in zip(tables, starts, starts[1:]) for _ in range(b - a)]
        words = body.take(body.varint())
        need(len(words) >= 4 * states and len(words) % 2 == 0, f"{self.where}: {len(words)} bytes of words")
        self.states = list(struct.unpack_from(f"<{states}I", words))
        self.words = iter(struct.unpack(f"<{len(words) // 2 - 2 * states}H", words[4 * states:]))
        self.plain = Bits(body.take(body.varint()), self.where)

    def next(self, context):
        if not self.tables:
            return 0
        table, turn = self.tables[context], self.n % len(self.states)
        self.n += 1
        x = self.states[turn]
        token = table.token[x % 4096]
        x = table.frequency[token] * (x // 4096) + x % 4096 - table.start[token]
        self.states[turn] = x << 16 | next(self.words) if x < 65536 else x
        if token >= 32:
            a, m = divmod(token - 32, 4)
            token = (4 + m << a + 3) + self.plain.take(a + 3)
        return zigzag(token)

    def end(self):
        if self.tables:
            need(set(self.states) == {65536} and next(self.words, None) is None, f"{self.where}: coded integers do not end")
            self.plain.end()


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

    def least_varint(self):
        start = self.at
        value = self.varint()
        need(self.at - start == max(1, (value.bit_length() + 6) // 7), f"{self.where}: {value} takes too many bytes")
        return value

    def signed(self):
        value = self.varint()
        return zigzag(value)

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
        return [zigzag(value) for value in struct.unpack(f"<{count}Q", woven)]

    def rest(self):
        return self.content[self.at:]

    def coded(self, states=1):
        return Coded(self, states)


class Header:
    """What stands before each body."""

    def __init__(self, payload, where):
        need(len(payload) >= HEADER.size, f"{where}: payload of {len(payload)} bytes")
        mark, version, crc, self.tolerances, place, self.stream = HEADER.unpack_from(payload)
        need(mark == MARK and version == 1, f"{where}: mark {mark}, version {version}")
        need(crc == crc32c(payload[:9] + payload[13:]), f"{where}: CRC-32C is wrong")
        need(place <= self.tolerances + 1, f"{where}: place {place}")
        self.kind = LINES if place == 0 else LEVEL if place <= self.tolerances else REST
        self.level = max(0, place - 1)
        fields = Body(payload[HEADER.size:], where)
        self.group, self.lines, self.epoch, self.first_line, self.first_time = (fields.least_varint() for _ in range(5))
        self.first_time = (self.first_line * NOMINAL_NS + zigzag(self.first_time)) % (1 << 64)
        nominal = (self.lines - 1) * NOMINAL_NS
        self.last_time = (self.first_time + nominal + zigzag(fields.least_varint())) % (1 << 64)
        self.tolerance = fields.number("d") if self.kind == LEVEL else 0.0
        self.left_out = fields.number("d") if self.kind != REST else 0.0
        self.points, size = fields.least_varint(), fields.least_varint()
        body = fields.rest()
        need(size == len(body), f"{where}: body of {len(body)} bytes, header says {size}")
        need(1 <= self.tolerances <= 16 and 1 <= self.lines <= 64, f"{where}: {self.tolerances} tolerances, {self.lines} lines")
        self.body = Body(body, where)

    def shared(self):
        """What all payloads of a group have in common."""
        return (self.tolerances, self.stream, self.group, self.lines, self.epoch, self.first_line, self.first_time,
                self.last_time)


class Run:
    """Points first .. last of the group; `knots` are those known so far, ascending; `new` the knots of the level at hand;
    `went_on` says for knots that go on from a vertex of the run above from which."""

    def __init__(self, first, count, sample):
        self.first, self.last, self.sample = first, first + count - 1, sample
        self.knots, self.new = sorted({self.first, self.last}), set()
        self.above, self.shift, self.went_on = None, 0, {}

    def __len__(self):
        return self.last - self.first + 1

    def step(self, u):
        if len(self) == 1:
            return 0
        rise = abs(u[self.last] - u[self.first]) // (len(self) - 1)
        return rise if u[self.last] >= u[self.first] else -rise

    def beside(self, i):
        return held(i + self.shift, self.above.first, self.above.last)

    def align(self, above, evens):
        self.above, self.shift = above, above.first - above.sample + self.sample - self.first
        for u in evens:
            step = self.step(u)
            if step and step == above.step(u):
                self.shift = (2 * (u[self.first] - u[above.first]) + step) // (2 * step) + above.first - self.first
                break


class Line:
    def __init__(self, index):
        self.index, self.runs, self.invalid, self.stamps, self.plane = index, [], 0, {}, None
        self.first = self.end = 0  # its points in the group


def folded(value):
    return 2 * value if value >= 0 else -2 * value - 1


def turned(value):
    """The zigzag form as 32 bits, read from the other end."""
    return int(f"{folded(value):032b}"[::-1], 2)


def on_line(u, a, b, i):
    return u[a] + (u[b] - u[a]) * (i - a) // (b - a)


def polyline(u, run):
    """The polyline through the run's knots at each of its points, rounded down."""
    out = [u[run.first]]
    for a, b in zip(run.knots, run.knots[1:]):
        rise, base, width = u[b] - u[a], u[a], b - a
        out.extend(base + rise * step // width for step in range(1, width + 1))
    return out


def chords(u, run):
    """The same as the rest counts it: each point a whole number of rounded steps behind a knot."""
    out = [u[run.first]]
    for a, b in zip(run.knots, run.knots[1:]):
        step = ((u[b] - u[a]) << 16) // (b - a)
        out.extend(wrap(u[a] + (step * i >> 16)) for i in range(1, b - a))
        out.append(u[b])
    return out


class Fan:
    """Directions of a sensor that turns."""

    def __init__(self, table, limit):
        axes, self.shift, count, turn = table.byte(), table.byte(), table.varint(), table.signed()
        self.axes = (axes & 3, axes >> 2)
        need(max(self.axes) <= 2 and self.axes[0] != self.axes[1] and self.shift <= 30 and 1 <= count <= min(limit, 65536),
             f"{table.where}: a fan of axes {self.axes}, shift {self.shift}, {count} directions")
        self.directions = [(0, 0), (0, 0)]
        for _ in range(count):
            (x, y), (x2, y2) = self.directions[-1], self.directions[-2]
            self.directions.append(tuple(self.wide((self.wide(turn * a) >> 30) - b + table.signed()) for a, b in ((x, x2), (y, y2))))
        del self.directions[:2]

    @staticmethod
    def wide(value):
        return (value + (1 << 63)) % (1 << 64) - (1 << 63)

    def coordinate(self, axis, n, d):
        need(0 <= d < len(self.directions), f"direction {d} of {len(self.directions)}")
        return self.wide(self.directions[d][self.axes.index(axis)] * n + (1 << self.shift >> 1)) >> self.shift


class Group:
    """One group: the line table, then level after level."""

    def __init__(self, header):
        self.header = header
        table = header.body.blob()
        header.body.end()
        flags = table.byte()
        need(flags <= 31, f"{table.where}: flags {flags}")
        self.residuals = bool(flags & 1)
        self.axes, self.even = [], []
        self.ruled = [bool(flags >> 2 + axis & 1) for axis in range(3)]
        for axis in range(3):
            base, step = table.signed(), table.varint()
            self.axes.append((base, step >> 2, bool(step & 1)))
            self.even.append(bool(step & 2))
            need(self.even[axis] or not self.ruled[axis], f"{table.where}: axis {axis} is ruled and not even")
        self.fan = Fan(table, header.points) if flags & 2 else None
        self.lines, self.runs, self.count = [], [], 0
        last = [0] * 4
        while len(self.lines) < header.lines:
            self.read_line(table, header.first_line + len(self.lines), last)
        need(len(self.lines) == header.lines, f"{table.where}: lines repeated beyond the end")
        table.end()
        need(self.count == header.points, f"{table.where}: {self.count} points in the table, header says {header.points}")
        self.level = [UNKNOWN] * self.count
        self.coarser = {}
        self.u = [[0] * self.count for _ in range(3)]
        self.remainder = [[0] * self.count for _ in range(3)]
        self.ulps = [[0] * self.count for _ in range(3)]

    def read_line(self, table, index, last):
        line, flags = Line(index), table.byte()
        need(flags < 128 and not (flags & 64 and flags & 31), f"{table.where}: line flags {flags}")
        if flags & 32:
            counts = [table.varint()]
            samples = [0]
        else:
            counts, samples = [], []
            for _ in range(table.varint()):
                line.invalid += table.varint()
                samples.append(line.invalid + sum(counts))
                counts.append(table.varint())
            line.invalid += table.varint()
        for bit in range(4):
            if flags >> bit & 1:
                last[bit] = line.stamps[bit] = (last[bit] + table.signed()) % (1 << 64)
        if flags & 16:
            line.plane = struct.unpack("<3d", table.take(24))
        need(all(count >= 1 for count in counts), f"{table.where}: a run without points")
        self.add_line(line, counts, samples)
        if flags & 64:
            more = table.varint()
            need(more >= 1, f"{table.where}: a line repeated no times")
            for i in range(more):
                same = Line(index + 1 + i)
                same.invalid = line.invalid
                self.add_line(same, counts, samples)

    def add_line(self, line, counts, samples):
        line.first = self.count
        for count, sample in zip(counts, samples):
            line.runs.append(Run(self.count, count, sample))
            self.count += count
        line.end = self.count
        self.runs += line.runs
        self.lines.append(line)

    def add(self, header):
        """A level or the rest, in their order."""
        body = header.body
        if header.kind != REST and header.level and not header.points:
            body.end()
            return
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

    def count_at(self, axis, i):
        def number(k):
            base, step, _ = self.axes[k]
            return wrap(base + step * self.u[k][i])
        if self.fan and axis in self.fan.axes:
            value = self.fan.coordinate(axis, *map(number, self.fan.axes))
        else:
            value = number(axis)
        return wrap(value + self.remainder[axis][i])

    @staticmethod
    def store(values, where, what):
        for i, value in zip(where, what):
            values[i] = value

    # Levels

    def read_level(self, body, k):
        """Gives the new points, ascending."""
        if k == 0:
            self.read_even(body)
            self.align()
        follow = body.byte()
        need(follow <= 1, f"{body.where}: follow {follow}")
        coded = body.coded()
        inner = [self.positions(coded, run, follow) for run in self.runs]
        coded.end()
        for axis in self.uneven():
            mode, u = body.byte(), self.u[axis]
            need(mode <= 4, f"{body.where}: mode {mode}")
            coded = body.coded()
            before = None
            for run, points in zip(self.runs, inner):
                if k == 0:
                    above = run.above
                    u[run.first] = wrap((u[above.first] if above else u[before.first] if before else 0) + coded.next(0))
                    if run.last != run.first:
                        u[run.last] = wrap((u[above.last] if above else u[run.first]) + coded.next(0))
                self.read_inner(u, mode, coded, run, points)
                before = run
            coded.end()
        ends = [] if k else [i for run in self.runs for i in {run.first, run.last}]
        return sorted(ends + [i for points in inner for i in points])

    def read_ruled(self, body, u):
        first, advance = wrap(body.signed()), wrap(body.signed())
        coded, first, pitch, phase = body.coded(), first - advance, 0, 1 << 31
        for run in self.runs:
            first = u[run.first] = wrap(first + advance + coded.next(0))
            if len(run) == 1:
                continue
            whole, fraction = wrap((pitch >> 32) + coded.next(1)), pitch % (1 << 32) ^ turned(coded.next(2))
            pitch, phase = (whole << 32) + fraction, phase ^ turned(coded.next(3))
            missing, at = {}, run.first
            for _ in range(folded(coded.next(4))):
                at += folded(coded.next(5)) + 1
                missing[at] = folded(coded.next(6)) + 1
            need(at <= run.last, f"{body.where}: samples are missing beyond the run")
            sample = 0
            for i in range(run.first + 1, run.last + 1):
                sample += 1 + missing.get(i, 0)
                u[i] = wrap(first + (pitch * sample + phase >> 32))
        coded.end()

    def uneven(self):
        return [axis for axis in range(3) if not self.even[axis]]

    def read_even(self, body):
        for u, even, ruled in zip(self.u, self.even, self.ruled):
            if not even:
                continue
            if ruled:
                self.read_ruled(body, u)
                continue
            first, advance, step = (wrap(body.signed()) for _ in range(3))
            coded, first = body.coded(), first - advance
            for run in self.runs:
                first = u[run.first] = wrap(first + advance + coded.next(0))
                if len(run) > 1:
                    u[run.last] = wrap(first + step * (len(run) - 1) + coded.next(1))
                    step = run.step(u)
                    u[run.first:run.last] = [first + step * i for i in range(len(run) - 1)]
            coded.end()

    def align(self):
        evens, before = [u for u, even, ruled in zip(self.u, self.even, self.ruled) if even and not ruled], None
        for line in self.lines:
            if not line.runs:
                continue
            at = 0
            for run in line.runs if before else []:
                middle = run.sample + len(run) // 2
                while at + 1 < len(before) and before[at].sample + len(before[at]) <= middle:
                    at += 1
                run.align(before[at], evens)
            before = line.runs

    def positions(self, coded, run, follow):
        """The run's new inner points, ascending, as (point, candidate it goes on from or None)."""
        old, new, candidates = run.knots, {}, []
        if follow and run.above and len(run) > 2:
            above = run.above
            behind = held(run.first + run.shift, above.first, above.last)
            candidates = [j for j in above.knots if above.first < j < above.last and j > behind]
        for a, b in zip(old, old[1:]):
            at, last = a, 0
            while b - at >= 2:
                while candidates and candidates[0] - run.shift < b:
                    place = candidates[0] - run.shift
                    if place > at and place > a + 2 and (b == run.last or place + 2 < b):
                        break
                    candidates.pop(0)
                place = candidates[0] - run.shift if candidates and candidates[0] - run.shift < b else None
                if place is None:
                    context = min(8, (b - at - 1).bit_length()) - 1 + (8 if last else 0)
                else:
                    context = 16 + last + (8 if candidates[0] in run.above.new else 0)
                event = coded.next(context)
                last = event = 2 * event if event >= 0 else -2 * event - 1
                need(event < 8 and (event < 2 or place is not None), f"{coded.where}: event {event}")
                if event == 0:
                    break
                if event == 2:
                    at = min(place + 2, b - 1)
                    candidates.pop(0)
                    continue
                if event == 1:
                    count = (b if place is None else max(at + 1, place - 2)) - at - 1
                    p = coded.next(31 + min(14, count.bit_length())) if count > 1 else 0
                    i = at + 1 + p + (count if p < 0 else 0)
                    new[i] = None
                else:
                    i = place + event - 5
                    new[i] = candidates.pop(0)
                need(at < i < b, f"{coded.where}: a point outside its segment")
                at = i
        run.new = set(new)
        run.went_on.update((i, j) for i, j in new.items() if j is not None)
        run.knots = sorted([*old, *new])
        self.coarser[run.first] = old
        return new

    def read_inner(self, u, mode, coded, run, points):
        coarser = self.coarser[run.first]
        curve = polyline(u, run.above) if run.above and points else None
        for i in sorted(points):
            right = coarser[bisect_left(coarser, i)]
            left = run.knots[bisect_left(run.knots, i) - 1]
            straight = on_line(u, left, right, i)
            guess, context = (u[left] if mode == 1 else straight), 1
            if curve:
                start = run.above.first
                a, b, at = (run.went_on.get(j, run.beside(j)) - start for j in (left, right, i))
                goes_on = points[i] is not None
                bend = curve[at] - on_line(curve, a, b, at) if a < at < b else 0
                context = 2 + min(19, abs(curve[at] - straight - bend).bit_length()) + (20 if goes_on else 0)
                guess = (straight, u[left], straight + bend, u[left] + curve[at] - curve[a], curve[at])[mode]
            u[i] = wrap(guess + coded.next(context))

    # Rest

    def read_rest(self, body, new):
        axis = body.byte()
        need(axis <= 2, f"{body.where}: lines along axis {axis}")
        curves = [u if even else [value for run in self.runs for value in chords(u, run)] for u, even in zip(self.u, self.even)]
        neighbours = self.neighbours(curves[axis])
        starts = [run.first for run in self.runs for _ in range(len(run))]
        for axis in self.uneven():
            mode = body.byte()
            need(mode <= 4, f"{body.where}: mode {mode}")
            if mode not in (0, 4):
                self.read_plain(self.u[axis], curves[axis], mode, zip(new, body.planes(len(new))), starts, neighbours)
                continue
            weights = [body.signed() for _ in range(8 if mode else 14)]
            need(all(-32768 <= w <= 32767 for w in weights), f"{body.where}: weights {weights}")
            coded = body.coded(2)
            beside = [(None, 0, 0)] * self.count if mode else neighbours
            self.read_fitted(self.u[axis], curves[axis], weights, coded, new, starts, beside)
            coded.end()

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
                    j = self.walk(curve, curve[i], j, before)
                    out.append((j, before.first, before.end))
            before = line
        return out

    @staticmethod
    def walk(curve, here, j, before):
        while j + 1 < before.end and abs(here - curve[j + 1]) <= abs(here - curve[j]):
            j += 1
        for _ in range(8):
            if j == before.first or abs(here - curve[j - 1]) >= abs(here - curve[j]):
                break
            j -= 1
        return j

    @staticmethod
    def read_fitted(u, curve, weights, coded, new, starts, neighbours):
        size = [0 if i + 1 == len(u) or starts[i + 1] == i + 1 else min(abs(wrap(curve[i + 1] - curve[i])), 1 << 20) // 2
                for i in range(len(u))]  # of points of levels; new ones get theirs below
        known = [True] * len(u)
        for i in new:
            known[i] = False
        begun = None
        for i in new:
            start, (j, first, end) = starts[i], neighbours[i]
            if begun != start:
                begun, fast, slow, before = start, -4, -16, 0
            near = [wrap(u[i - n] - curve[i - n]) if i - n >= start else 0 for n in range(1, 7)] + [fast + 4, slow + 16]
            a, b = (size[i - 1],) * 2 if known[i - 1] else (size[i - n] if i - n >= start else 0 for n in (2, 3))
            activity = 2 * max(a, b) + a + b
            if j is None:
                activity *= 2
            else:
                k = [held(j + n, first, end - 1) for n in range(-1, 2)]
                near += [wrap(u[n] - curve[n]) for n in k] + [u[k[n + 1]] - curve[i + n] for n in (-1, 0, 1)]
                activity += size[k[0]] + 2 * size[k[1]] + size[k[2]]
            octave = (activity + 1).bit_length() - 1
            residual = coded.next(2 * octave + (2 * (activity + 1) >> octave) % 2)
            size[i] = min(abs(residual), 1 << 20)
            u[i] = wrap(curve[i] + (2048 + sum(w * d for w, d in zip(weights, near)) >> 12) + residual)
            fast, slow = wrap(fast + (wrap(16 * before - fast) >> 3)), wrap(slow + (wrap(16 * before - slow) >> 5))
            before = wrap(u[i] - curve[i])

    @staticmethod
    def read_plain(u, curve, mode, residuals, starts, neighbours):
        for i, residual in residuals:
            j = neighbours[i][0]
            if mode == 1 or mode == 2 and i - 2 < starts[i]:
                guess = u[i - 1]
            elif mode == 2:
                guess = 2 * u[i - 1] - u[i - 2]
            else:
                guess = curve[i] if j is None else u[j]
            u[i] = wrap(guess + residual)


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
        self.origin = [int(count) for count in facts.get("origin", "0 0 0").split(" ")]
        need(len(self.origin) == 3, f"origin {self.origin}")
        self.form = {None: None, "float32": "f", "float64": "d"}[facts.get("source")]
        self.exact = "exact" in facts
        need(not self.exact or facts["exact"] == "yes" and self.form, f"exact {facts.get('exact')} of {facts.get('source')}")
        self.level_count = int(facts["level_count"])
        self.stored = int(facts.get("stored_levels", self.level_count + 1))
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
        need(group.residuals == self.exact, f"{where}: residuals")
        times = [line.stamps.get(2, line.index * NOMINAL_NS % (1 << 64)) for line in group.lines]
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
        said = {key: int(self.totals.get(key, 0)) for key in have}
        need(have == said, f"the recording holds {have}, scansion.end says {said}")

    def value(self, group, axis, i):
        """A Fraction, or a float when the recording keeps IEEE values."""
        value = (self.origin[axis] + group.count_at(axis, i)) * self.resolution
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
