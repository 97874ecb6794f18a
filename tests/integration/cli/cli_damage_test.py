# Cut and flipped recordings: verify tells the truth, recover brings back every whole group, nothing else is passed off as whole.
# SPDX-License-Identifier: Apache-2.0

import concurrent.futures
import os
import random
import struct

from cli_kit import check, clip, digest, run_cases, same
from reference import read_xyz

MAGIC = b"\x89MCAP0\r\n"
CHUNK = 0x06
CHUNK_HEAD = 49  # of a chunk, before its messages
TAIL = 64 << 10  # bytes that are cut off one by one


class Recording:
    """A sound recording, where its groups stand by our own reading of the container, and its points by group."""

    def __init__(self, kit, name, source):
        self.kit, self.path = kit, os.path.join(kit.root, name + ".mcap")
        kit.compress(source, self.path, "--features", "off")  # messages about features have tests of their own
        with open(self.path, "rb") as file:
            self.data = file.read()
        self.block_of, self.group_starts, self.group_ends = zip(*groups(self.data))
        report = verify(kit, self.path)
        check(report["sound"] and report["finished"], f"verify of a fresh recording: {clip(report)}")
        same(report["groups"], len(self.group_ends), "groups")
        points = os.path.join(kit.root, "all.xyz")
        kit.scansion("export", self.path, "-o", points, "--force")
        self.lines = read_xyz(points)
        self.groups = [self.lines[i:i + 64] for i in range(0, len(self.lines), 64)]
        same(len(self.groups), report["groups"], "groups of 64 lines")

    def whole_groups(self, cut):
        return sum(end <= cut for end in self.group_ends)

    def lines_of(self, groups):
        return [line for group in self.groups[:groups] for line in group]


def scene(kit, name, *words):
    """A recording of a synthetic scene."""
    return Recording(kit, name, kit.scene(os.path.join(kit.root, name + ".xyz"), *words))


def chunks(data):
    """Where each chunk record of an MCAP file starts and ends."""
    check(data.startswith(MAGIC) and data.endswith(MAGIC), "no MCAP file")
    at, found = len(MAGIC), []
    while at < len(data) - len(MAGIC):
        opcode, length = struct.unpack_from("<BQ", data, at)
        if opcode == CHUNK:
            found.append((at, at + 9 + length))
        at += 9 + length
    same(at, len(data) - len(MAGIC), "end of the last record")
    return found


def groups(data):
    """Of each group: where its chunk starts; where it starts (the first of a chunk with it); where its last payload ends."""
    found = []
    for start, end in chunks(data):
        at, begun = start + CHUNK_HEAD, start
        while at < end:
            _, length, channel = struct.unpack_from("<BQH", data, at)
            if channel == 1 and at > start + CHUNK_HEAD:
                found.append((start, begun, at))
                begun = at
            at += 9 + length
        found.append((start, begun, end))
    return found


def verify(kit, path, expect=None):
    outcome = kit.quick("verify", path, "--json")
    check(expect is None or outcome.code == expect, f"{outcome}; expected exit {expect}")
    report = outcome.json()
    same(outcome.code, 0 if report["sound"] else 1, f"{outcome}: exit code of {clip(report)}")
    return report


def in_parallel(function, items, workers=2):
    """Calls `function` with every item on two threads; the work is in the processes they start."""
    with concurrent.futures.ThreadPoolExecutor(workers) as pool:
        try:
            for _ in pool.map(function, items):
                pass
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


class Cutter:
    """Checks one cut after the other; recovered files that were seen before are not looked at twice."""

    def __init__(self, recording):
        self.recording, self.kit = recording, recording.kit
        self.seen = {}
        self.done = 0

    def __call__(self, cut):
        kit, recording = self.kit, self.recording
        path = os.path.join(kit.root, f"cut-{cut}.mcap")
        out = os.path.join(kit.root, f"recovered-{cut}.mcap")
        with open(path, "wb") as file:
            file.write(recording.data[:cut])
        whole = recording.whole_groups(cut)
        lines = recording.lines_of(whole)
        what = f"cut at byte {cut} of {len(recording.data)}"
        report = verify(kit, path, expect=1)
        same((report["sound"], report["finished"]), (False, False), f"{what}: verify")
        same((report["groups"], report["lines"], report["points"]), (whole, len(lines), sum(map(len, lines))), f"{what}: verify's counts")
        # The last chunk may stand without some of its groups, or its message indexes.
        least = recording.block_of[whole - 1] if whole > 0 else 0
        check(least <= report["good_bytes"] <= cut, f"{what}: {report['good_bytes']} good bytes")
        outcome = kit.quick("recover", path, "-o", out, "--json")
        recovered = outcome.json()
        same((recovered["groups"], recovered["lines"], recovered["points"]), (whole, len(lines), sum(map(len, lines))), f"{what}: recovered")
        # A cut between two chunks leaves nothing behind that tells of more; one between groups of a chunk does.
        torn = any(block < cut < end for block, end in zip(recording.block_of, recording.group_ends))
        same((recovered["anything_lost"], outcome.code), (torn, int(torn)), f"{what}: whether anything was lost, exit code")
        key = digest(out)
        if self.seen.get(key) != whole:
            same(verify(kit, out)["sound"], True, f"{what}: verify of the recovered file")
            points = os.path.join(kit.root, f"recovered-{cut}.xyz")
            kit.scansion("export", out, "-o", points)
            same(read_xyz(points) == lines, True, f"{what}: the points recovered are those of the first {whole} groups")
            os.remove(points)
            self.seen[key] = whole
        os.remove(path)
        os.remove(out)
        self.done += 1


def noise(kit):
    """A recording of a little over 64 KiB: pure noise takes many bytes but little time to read."""
    generator = random.Random(47)
    source = os.path.join(kit.root, "noise.xyz")
    with open(source, "w", encoding="ascii") as file:
        for line in range(960):
            file.writelines(f"{i}.{generator.randrange(1000):03d} {line} {generator.randrange(10**7) / 1000}\n" for i in range(16))
            file.write("\n")
    recording = Recording(kit, "noise", source)
    check(recording.group_ends[0] < len(recording.data) - TAIL, f"a recording of {len(recording.data)} bytes is too small for this test")
    return recording


def cut_in_its_tail(kit):
    """Around the ends of groups, at record ends and at random places of the last 64 KiB."""
    recording = noise(kit)
    size = len(recording.data)
    near = {end + d for end in recording.group_ends for d in (-1, 0, 1)}
    near |= {size - d for d in (1, 2, 8, 9, 30, 37, 38, 500, TAIL)}
    cuts = {c for c in near if size - TAIL <= c < size} | set(random.Random(61).sample(range(size - TAIL, size), 60))
    cut_all(recording, sorted(cuts))


def cut_all(recording, cuts):
    cutter = Cutter(recording)
    in_parallel(cutter, cuts)
    print(f"  {cutter.done} cuts, {len(cutter.seen)} different recovered files")


# Every byte of the tail is an hour's work on a busy machine: in four parts, so that --only can take one.


def cut_at_every_byte_quarter_1(kit):
    cut_at_every_byte(kit, 1)


def cut_at_every_byte_quarter_2(kit):
    cut_at_every_byte(kit, 2)


def cut_at_every_byte_quarter_3(kit):
    cut_at_every_byte(kit, 3)


def cut_at_every_byte_quarter_4(kit):
    cut_at_every_byte(kit, 4)


def cut_at_every_byte(kit, quarter):
    kit.needs_long("16,384 cuts")
    recording = noise(kit)
    first = len(recording.data) - TAIL + (quarter - 1) * (TAIL // 4)
    cut_all(recording, range(first, first + TAIL // 4))


def cut_in_its_head(kit):
    """Down to nothing: never sound, and either nothing or an empty recording comes back."""
    recording = scene(kit, "head", "steps", "--lines", 3, "--points", 30)
    start, first = recording.group_starts[0], recording.group_ends[0]
    cuts = range(first + 1) if kit.long else sorted({*range(0, 40), *range(0, first, 29), start, first - 1, first})

    def cut_at(cut):
        path = os.path.join(kit.root, f"head-{cut}.mcap")
        out = path + ".out"
        with open(path, "wb") as file:
            file.write(recording.data[:cut])
        for words in (["verify", path], ["info", path], ["export", path, "-o", out + ".xyz"]):
            outcome = kit.quick(*words)
            check(outcome.code in ((1, 65) if words[0] == "verify" else (0, 65)), f"cut at byte {cut}: {outcome}")
            same(os.path.exists(out + ".xyz"), words[0] == "export" and outcome.code == 0, f"cut at byte {cut}: {outcome}: output")
        outcome = kit.quick("recover", path, "-o", out)
        # Right behind the head or the first chunk nothing tells that there was more.
        check(outcome.code in ((0, 1) if cut in (start, first) else (1, 65)), f"cut at byte {cut}: {outcome}")
        same(os.path.exists(out), outcome.code != 65, f"cut at byte {cut}: {outcome}: output")
        if outcome.code != 65:
            same(verify(kit, out)["groups"], int(cut == first), f"cut at byte {cut}: groups recovered")

    in_parallel(cut_at, cuts)


def flipped_bytes(kit):
    """Every single changed byte of a small recording is found (a sample without --long), and other groups come back."""
    recording = scene(kit, "flip", "part", "--lines", 130, "--points", 24, "--seed", 6)
    size = len(recording.data)
    same(len(recording.groups), 3, "groups")
    generator = random.Random(53)
    places = range(size) if kit.long else sorted(generator.sample(range(size), 260))
    masks = {at: generator.randrange(1, 256) for at in range(size)}
    undetected = []

    def flip(at):
        data = bytearray(recording.data)
        data[at] ^= masks[at]
        path = os.path.join(kit.root, f"flip-{at}.mcap")
        with open(path, "wb") as file:
            file.write(data)
        outcome = kit.quick("verify", path)
        if outcome.code not in (1, 65):
            undetected.append((at, masks[at], outcome.code))
        if at % (1 if size < 2000 else 23) == 0 or not kit.long:
            recover_flipped(at, path)
        os.remove(path)

    def recover_flipped(at, path):
        out = path + ".out"
        outcome = kit.quick("recover", path, "-o", out, "--json")
        check(outcome.code in (0, 1), f"byte {at} flipped: {outcome}")
        report = outcome.json()
        # One byte belongs to one group at most.
        hit = [i for i, end in enumerate(recording.group_ends) if at < end][:1]
        inside = hit and at >= (recording.group_ends[hit[0] - 1] if hit[0] else 0)
        least = 2 if inside else 3
        check(report["groups"] >= least, f"byte {at} flipped: {report['groups']} of 3 groups came back")
        same(outcome.code, int(report["anything_lost"]), f"byte {at} flipped: exit code")
        if report["groups"] < 3:
            same(report["anything_lost"], True, f"byte {at} flipped: a lost group is told")
        same(verify(kit, out)["sound"], True, f"byte {at} flipped: verify of the recovered file")
        points = out + ".xyz"
        kit.scansion("export", out, "-o", points)
        got = read_xyz(points)
        candidates = [recording.lines] + [[line for j, group in enumerate(recording.groups) if j != i for line in group] for i in range(3)]
        check(got in candidates, f"byte {at} flipped: the recovered points are not those of the groups")
        os.remove(out)
        os.remove(points)

    in_parallel(flip, places)
    check(not undetected, f"{len(undetected)} of {len(places)} flipped bytes are not found by verify, "
                          f"as (byte, mask, exit code): {clip(undetected)}; the file has {size} bytes")
    print(f"  {len(places)} of {size} bytes flipped")


def damaged_blocks(kit):
    """Zeroed, doubled, removed and swapped pieces."""
    recording = scene(kit, "blocks", "part", "--lines", 320, "--points", 60, "--seed", 8)
    data, ends = recording.data, recording.group_ends
    group = lambda i: slice(ends[i - 1], ends[i])
    changed = {
        "a zeroed block in a group": data[:ends[1] + 600] + bytes(512) + data[ends[1] + 1112:],
        "a group missing": data[:ends[1]] + data[ends[2]:],
        "a group twice": data[:ends[2]] + data[group(2)] + data[ends[2]:],
        "two groups swapped": data[:ends[1]] + data[group(3)] + data[group(2)] + data[ends[3]:],
        "bytes between groups": data[:ends[1]] + b"noise" * 100 + data[ends[1]:],
        "no head": data[ends[0]:],
        "a zeroed head": bytes(200) + data[200:],
        "bytes behind the end": data + b"tail",
        "itself behind itself": data + data,
    }
    for name, damaged in changed.items():
        path = os.path.join(kit.root, "damaged.mcap")
        out = os.path.join(kit.root, "out.mcap")
        with open(path, "wb") as file:
            file.write(damaged)
        outcome = kit.scansion("verify", path, expect=None)
        check(outcome.code in (1, 65), f"{name}: {outcome}")
        outcome = kit.scansion("recover", path, "-o", out, "--force", "--json", expect=None)
        check(outcome.code in (0, 1), f"{name}: {outcome}")
        report = outcome.json()
        lost = {"a zeroed block in a group": 1, "a group missing": 1, "no head": 1}.get(name, 0)
        if name not in ("a group twice", "two groups swapped", "itself behind itself"):
            same(report["groups"], len(recording.groups) - lost, f"{name}: groups that came back")
        check(report["groups"] >= len(recording.groups) - 2, f"{name}: {report['groups']} groups came back")
        same(report["anything_lost"] or report["groups"] == len(recording.groups), True, f"{name}: {clip(report)}")
        same(verify(kit, out)["sound"], True, f"{name}: verify of the recovered file")
        kit.scansion("export", out, "-o", os.path.join(kit.root, "out.xyz"), "--force")
        got = read_xyz(os.path.join(kit.root, "out.xyz"))
        remaining = iter(recording.lines)
        check(all(line in remaining for line in got), f"{name}: lines came back changed, doubled or in another order")


def unfinished_recordings(kit):
    """What info, export and --strict do with a recording that was cut off."""
    recording = scene(kit, "unfinished", "ribs", "--lines", 2200, "--points", 10)
    path = os.path.join(kit.root, "open.mcap")
    lines = recording.lines_of(32)
    second_end = chunks(recording.data)[1][1]
    same(second_end, recording.group_ends[31], "end of the 32nd group and of the second chunk")
    # Behind the chunk's message indexes, within the next chunk: without its indexes no chunk is whole.
    wrong = []
    indexes = 5 * (15 + 16 * 16)
    for bytes_more in (indexes + 300, indexes):
        with open(path, "wb") as file:
            file.write(recording.data[:second_end + bytes_more])
        info = kit.info(path)
        got, want = (info["complete"], info["lines"], info["points"]), (False, 2048, sum(map(len, lines)))
        if got != want:
            wrong.append(f"cut {bytes_more} bytes behind the second chunk: {got}, expected {want}")
    check(not wrong, f"complete, lines, points in info of an unfinished recording: {wrong}")
    same(kit.info(recording.path)["complete"], True, "info of a finished recording")
    out = os.path.join(kit.root, "open.xyz")
    outcome = kit.scansion("export", path, "-o", out)
    check("unfinished" in outcome.err, f"{outcome} does not say unfinished")
    same(read_xyz(out) == lines, True, "points of an unfinished recording")
    kit.scansion("export", path, "-o", out, "--force", "--strict", expect=1)
    same(read_xyz(out) == lines, True, "points of an unfinished recording with --strict")
    kit.scansion("export", recording.path, "-o", out, "--force", "--strict")
    # A group lost in the middle is a gap: told by info, and an error with --strict.
    data, ends = recording.data, recording.group_ends
    with open(path, "wb") as file:
        file.write(data[:ends[0] + 500] + b"\0" * 64 + data[ends[0] + 564:])
    kit.refused(65, "export", path, "-o", os.path.join(kit.root, "none.xyz"), says=(path, "byte "), folders=[kit.root])
    fixed = os.path.join(kit.root, "fixed.mcap")
    same(kit.scansion("recover", path, "-o", fixed, "--json", expect=1).json()["lost"], [[64, 127]], "lines lost")
    info = kit.info(fixed)
    same((info["gaps"], info["gap_list"][0]["first"], info["gap_list"][0]["count"]), (1, 64, 64), "gaps in info")
    kit.scansion("export", fixed, "-o", out, "--force", "--strict", expect=1)
    same(read_xyz(out) == recording.groups[0] + [line for g in recording.groups[2:] for line in g], True, "the other points")
    kit.scansion("export", fixed, "-o", out, "--force")
    same(kit.scansion("export", fixed, "-o", "-", "--lines", "64:128").out.count(b"\n"), 1, "rows of lost lines, the heading aside")


def recordings_cut_to_a_level(kit):
    """`export --level K -o cut.mcap` is sound and holds the same points, and says so when asked for more."""
    recording = scene(kit, "levels", "part", "--lines", 150, "--points", 80)
    stored = len(kit.info(recording.path)["points_per_level"])
    size = None
    for k in range(stored):
        cut = os.path.join(kit.root, f"level-{k}.mcap")
        kit.scansion("export", recording.path, "--level", k, "-o", cut)
        same(verify(kit, cut)["sound"], True, f"verify of a recording cut to level {k}")
        info = kit.info(cut)
        same((info["lossless"], info["points"]), (k == stored - 1, sum(map(len, recording.lines))), f"info of level {k}")
        same(info["points_per_level"], kit.info(recording.path)["points_per_level"][:k + 1], f"points of levels up to {k}")
        for lower in range(k + 1):
            a, b = (os.path.join(kit.root, name) for name in ("a.xyz", "b.xyz"))
            kit.scansion("export", recording.path, "--level", lower, "-o", a, "--force")
            kit.scansion("export", cut, "--level", lower, "-o", b, "--force")
            same(digest(b), digest(a), f"level {lower} of a recording cut to level {k}")
        kit.scansion("export", cut, "-o", b, "--force")
        same(read_xyz(b), read_xyz(a), f"all points of a recording cut to level {k}")
        for words in ([] if k == stored - 1 else (["--level", k + 1], ["--reduction", "95"], ["--tolerance", "0"], ["--what", "rearrangement"])):
            kit.refused(2, "export", cut, "-o", os.path.join(kit.root, "none.xyz"), *words, says=("level", str(k)), folders=[kit.root])
        tolerances = kit.info(recording.path)["levels"]
        for tolerance in tolerances[:k + 1]:  # what the level holds is answered from it
            kit.scansion("export", recording.path, "--tolerance", repr(tolerance * 1.3), "-o", a, "--force")
            kit.scansion("export", cut, "--tolerance", repr(tolerance * 1.3), "-o", b, "--force")
            same(digest(b), digest(a), f"tolerance {tolerance * 1.3} of a recording cut to level {k}")
        check(size is None or os.path.getsize(cut) > size, f"level {k} is no larger than level {k - 1}")
        size = os.path.getsize(cut)
        # A cut recording can be damaged and recovered as well.
        broken, out = os.path.join(kit.root, "broken.mcap"), os.path.join(kit.root, "fixed.mcap")
        with open(cut, "rb") as file:
            data = file.read()
        with open(broken, "wb") as file:
            file.write(data[:groups(data)[1][2]])
        verify(kit, broken, expect=1)
        kit.scansion("recover", broken, "-o", out, "--force", expect=None)
        same(verify(kit, out)["groups"], 2, f"groups recovered of a recording cut to level {k}")
    kit.scansion("compare", recording.path, cut)  # the last one holds every point


if __name__ == "__main__":
    run_cases("damage and repair", [
        cut_in_its_tail, cut_at_every_byte_quarter_1, cut_at_every_byte_quarter_2, cut_at_every_byte_quarter_3,
        cut_at_every_byte_quarter_4, cut_in_its_head, flipped_bytes, damaged_blocks, unfinished_recordings, recordings_cut_to_a_level])
