# Reads the MCAP side of a recording, written from docs/FORMAT.md and the MCAP specification alone.
# SPDX-License-Identifier: Apache-2.0
"""A second opinion on the container: every record but the payloads is built again and compared with the file.

`read_container` gives the metadata, the groups' payloads and the gap messages, or raises FormatError with the byte offset.
Shares no code with the programs; the payloads are format_reader.py's.
"""
import json
import struct
import zlib
from dataclasses import dataclass, field

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = range(1, 9)
STATISTICS, METADATA, METADATA_INDEX, _, DATA_END = range(11, 16)
CHUNK_GROUPS = 16
CHUNK_LIMIT = 192 << 20
SMALL_LIMIT = 64 << 10
METADATA_SOON, METADATA_STRIDE = 16, 256  # copies of the metadata stand behind these many groups

SCHEMAS = [  # name, encoding, data; ids from 1
    ("scansion.Lines", "scansion", ""),
    ("scansion.Level", "scansion", ""),
    ("scansion.Gap", "jsonschema",
     '{"type":"object","properties":{"first":{"type":"integer"},"count":{"type":["integer","null"]},"reason":{"type":"string"}}}'),
    ("scansion.Features", "jsonschema",
     '{"title":"scansion.Features","type":"object","properties":{"group":{"type":"integer","minimum":0},"lines":{"'
     'type":"array","items":{"type":"object","properties":{"id":{"type":"integer"},"piece":{"type":"integer","defa'
     'ult":0},"type":{"enum":["convex","concave","step-top","step-bottom","ridge","valley"]},"per_mm":{"type":"int'
     'eger","minimum":1,"description":"counts of x, y, z a mm"},"vertices":{"type":"array","items":{"type":"intege'
     'r"},"description":"rows of x, y, z in counts, scan line, sample; each less the row before"}},"required":["id'
     '","type","per_mm","vertices"]}}},"required":["group","lines"]}'),
    ("scansion.Patches", "jsonschema",
     '{"title":"scansion.Patches","type":"object","properties":{"group":{"type":"integer","minimum":0},"runs":{"type'
     '":"array","items":{"type":"array"}},"merges":{"type":"array","items":{"type":"array"'
     ',"items":{"type":"integer"},"minItems":2,"maxItems":2}},"patches":{"type":"array","items":{"type":"object","re'
     'quired":["id","label","shape","samples"]}},"forms":{"type":"array","items":{"type":"object","required":["kind"'
     ',"patches","confidence"]}}},"required":["group"]}'),
]
NOTE_LIMIT = 32 << 20
FACTS = ("format device stream unit resolution levels level_count origin source exact stored_levels rounding_mm gap_mm "
         "started_ns features floor").split()
TOTALS = "lines points runs groups invalid gaps rounding_mm ended_ns".split()
# Entries that may be missing, and what they say then.
OPTIONAL = {"origin": "0 0 0", "source": "decimal", "exact": None, "stored_levels": None, "rounding_mm": "0", "gap_mm": None,
            "started_ns": None, "features": None, "floor": None, "invalid": "0", "gaps": "0", "ended_ns": None}


class FormatError(Exception):
    """The bytes are not what docs/FORMAT.md says."""


def need(condition, reason):
    if not condition:
        raise FormatError(reason)


def _crc32c_table():
    table = []
    for byte in range(256):
        for _ in range(8):
            byte = byte >> 1 ^ (0x82F63B78 if byte & 1 else 0)
        table.append(byte)
    return table


def crc32c(data, table=_crc32c_table()):
    crc = 0xFFFFFFFF
    for byte in data:
        crc = table[(crc ^ byte) & 0xFF] ^ crc >> 8
    return crc ^ 0xFFFFFFFF


def text(value):
    data = value.encode()
    return struct.pack("<I", len(data)) + data


def record(opcode, content):
    return struct.pack("<BQ", opcode, len(content)) + content


class Fields:
    """Takes the fields of one record's content, front to back."""

    def __init__(self, content, where):
        self.content, self.where, self.at = bytes(content), where, 0

    def take(self, size):
        need(self.at + size <= len(self.content), f"{self.where}: ends after {len(self.content)} bytes")
        self.at += size
        return self.content[self.at - size:self.at]

    def number(self, code):
        return struct.unpack("<" + code, self.take(struct.calcsize("<" + code)))[0]

    def sized(self, code="I"):
        return self.take(self.number(code))

    def text(self):
        return self.sized().decode()

    def end(self):
        need(self.at == len(self.content), f"{self.where}: {len(self.content) - self.at} bytes too many")


@dataclass
class Container:
    facts: dict = None  # metadata `scansion`
    totals: dict = None  # metadata `scansion.end`; None: unfinished
    groups: list = field(default_factory=list)  # [(sequence, log time, [payload, ...])]
    gaps: list = field(default_factory=list)  # the JSON objects
    features: list = field(default_factory=list)  # the JSON objects of the messages, and so
    patches: list = field(default_factory=list)


def records(data, start):
    """(offset, opcode, content) up to the first record that is cut off."""
    at = start
    while at + 9 <= len(data):
        opcode, size = struct.unpack_from("<BQ", data, at)
        if at + 9 + size > len(data):
            return
        yield at, opcode, data[at + 9:at + 9 + size]
        at += 9 + size


def parse_metadata(content, where, keys):
    fields = Fields(content, where)
    fields.text()
    entries = Fields(fields.sized(), where)
    fields.end()
    values, checked = {}, 0
    while entries.at < len(entries.content):
        checked = entries.at
        key = entries.text()
        values[key] = entries.text()
    crc = crc32c(entries.content[:checked])
    need(list(values) and list(values)[-1] == "crc32c", f"{where}: the last entry is not crc32c")
    need(values.pop("crc32c") == f"{crc:08x}", f"{where}: crc32c is wrong")
    wanted = [key for key in keys if key in values or key not in OPTIONAL]
    need(list(values) == wanted and "" not in values.values(), f"{where}: entries {list(values)}, want {wanted}")
    idle = [key for key, value in values.items() if key in OPTIONAL and value == OPTIONAL[key]]
    need(not idle, f"{where}: entries {idle} say nothing")
    return values


def channels(facts):
    """[(id, topic, message encoding, schema id)] that follow from the metadata; that of gaps comes with the first of them."""
    count = int(facts["level_count"])
    stored = int(facts.get("stored_levels", count + 1))
    need(1 <= count <= 16 and 1 <= stored <= count + 1, f"{stored} of {count} + 1 levels are stored")
    names = ["lines"] + [f"lod{k}" for k in range(count)] + ["rest"]
    rows = [(i + 1, f"scan/{facts['device']}/{name}", "scansion", 2 if i else 1) for i, name in enumerate(names)]
    need(facts.get("features") in (None, "yes"), f"features {facts.get('features')}")
    texts = ["gaps", "features", "patches"] if "features" in facts else ["gaps"]
    return rows[:stored + 1] + [(count + 3 + i, f"scan/{facts['device']}/{name}", "json", 3 + i) for i, name in enumerate(texts)]


class Checker:
    """Walks the records, keeps what the summary must say, and compares every record with the one built again."""

    def __init__(self, data):
        self.data = data
        self.out = Container()
        self.names, self.schemas, self.channels, self.metadata_record = {}, [], [], b""
        self.chunks, self.metadata, self.counts, self.times = [], [], {}, []
        self.metadata_due = False

    def expect(self, at, wanted, what):
        have = self.data[at:at + len(wanted)]
        if have == wanted:
            return at + len(wanted)
        first = next((i for i, (a, b) in enumerate(zip(have, wanted)) if a != b), len(have))
        raise FormatError(f"byte {at + first}: {what} is not what the metadata and the payloads ask for: "
                          f"{have[first:first + 16].hex(' ')}, want {wanted[first:first + 16].hex(' ')}")

    def head(self):
        """Header, Schemas, Channels, Metadata."""
        wanted = MAGIC + record(HEADER, text("scansion") + text("scansion 1"))
        at = self.expect(0, wanted, "the head")
        found = next((row for row in records(self.data, at) if row[1] not in (SCHEMA, CHANNEL)), None)
        need(found, "the head is cut off: no metadata, nothing can be read")
        offset, opcode, content = found
        need(opcode == METADATA, f"byte {offset}: opcode {opcode} in the head")
        self.out.facts = parse_metadata(content, f"byte {offset}: metadata scansion", FACTS)
        self.metadata_record = self.built_metadata("scansion", self.out.facts)
        schemas = SCHEMAS if "features" in self.out.facts else SCHEMAS[:3]
        self.schemas = [record(SCHEMA, struct.pack("<H", i + 1) + b"".join(map(text, row))) for i, row in enumerate(schemas)]
        rows = channels(self.out.facts)
        self.channels = [record(CHANNEL, struct.pack("<HH", i, schema) + text(topic) + text(encoding) + struct.pack("<I", 0))
                         for i, topic, encoding, schema in rows]
        self.names = {row[0]: row[1].rsplit("/", 1)[1] for row in rows}
        self.gap_row = list(self.names.values()).index("gaps")
        self.gap_definitions = self.schemas[2] + self.channels[self.gap_row]
        self.metadata.append((offset, len(self.metadata_record), "scansion"))
        return self.expect(at, self.definitions(False) + self.metadata_record, "the head")

    def definitions(self, gaps):
        """Schemas and channels, those of gaps among them or not."""
        return b"".join(built for i, built in enumerate(self.schemas) if gaps or i != 2) + b"".join(
            built for i, built in enumerate(self.channels) if gaps or i != self.gap_row)

    @staticmethod
    def built_metadata(name, values):
        entries = b"".join(text(key) + text(value) for key, value in values.items())
        entries += text("crc32c") + text(f"{crc32c(entries):08x}")
        return record(METADATA, text(name) + struct.pack("<I", len(entries)) + entries)

    def chunk(self, at, content):
        """Groups or one text message; gives the offset behind its message indexes, or None if those are cut off."""
        where = f"byte {at}: chunk"
        need(len(content) <= CHUNK_LIMIT, f"{where} of {len(content)} bytes")
        fields = Fields(content, where)
        fields.take(24)
        crc, compression, inner = fields.number("I"), fields.text(), fields.sized("Q")
        fields.end()
        need(compression == "", f"{where}: compression {compression}")
        need(crc == zlib.crc32(inner), f"{where}: uncompressed_crc is wrong")
        first_gap = inner.startswith(self.gap_definitions)
        messages, used = [], len(self.gap_definitions) if first_gap else 0
        for offset, opcode, message in records(inner, used):
            need(opcode == MESSAGE, f"{where}: opcode {opcode} inside")
            channel, sequence, log_time, publish_time = struct.unpack_from("<HIQQ", message)
            need(log_time == publish_time, f"{where}: log_time {log_time}, publish_time {publish_time}")
            messages.append((offset, channel, sequence, log_time, message[22:]))
            used = offset + 9 + len(message)
        need(used == len(inner) and messages, f"{where}: {len(inner) - used} bytes are no message")
        rows = {}  # messages of a channel, in the order of their first ones
        for message in messages:
            rows.setdefault(message[1], []).append(message)
        rows = list(rows.values())
        sets = len(rows[0])
        need(sets <= CHUNK_GROUPS and len(messages) == sets * len(rows), f"{where}: {len(messages)} messages on {len(rows)} channels")
        need(messages == [row[i] for i in range(sets) for row in rows], f"{where}: messages are out of order")
        times = [message[3] for message in rows[0]]
        need(all([message[3] for message in row] == times for row in rows), f"{where}: messages of a group have different times")
        indexes_end = at + 9 + len(content) + (15 + 16 * sets) * len(rows)
        if indexes_end > len(self.data):
            return None  # cut off inside the block
        need(first_gap == (not self.out.gaps and self.names.get(messages[0][1]) == "gaps"),
             f"{where}: the channel of gaps belongs into the chunk of the first of them")
        for i in range(sets):
            self.messages(where, [row[i] for row in rows], sets)
        body = struct.pack("<QQQI", min(times), max(times), len(inner), zlib.crc32(inner)) + text("")
        built = record(CHUNK, body + struct.pack("<Q", len(inner)) + inner)
        end = self.expect(at, built, "the chunk")
        indexes = [record(MESSAGE_INDEX, struct.pack("<HI", row[0][1], 16 * sets) + b"".join(
            struct.pack("<QQ", message[3], message[0]) for message in row)) for row in rows]
        starts = [end + sum(map(len, indexes[:i])) for i in range(len(indexes))]
        places = b"".join(struct.pack("<HQ", row[0][1], start) for row, start in zip(rows, starts))
        done = self.expect(end, b"".join(indexes), "a message index")
        self.chunks.append(record(CHUNK_INDEX, struct.pack("<QQQQ", min(times), max(times), at, len(built)) + struct.pack(
            "<I", len(places)) + places + struct.pack("<Q", done - end) + text("") + struct.pack("<QQ", len(inner), len(inner))))
        self.times += times
        for message in messages:
            self.counts[message[1]] = self.counts.get(message[1], 0) + 1
        return done

    def messages(self, where, messages, sets):
        names = [self.names.get(message[1]) for message in messages]
        sequences = {message[2] for message in messages}
        need(not self.metadata_due, f"{where}: a copy of the metadata should stand before a group in it")
        need(sets == 1 or "lines" in names, f"{where}: several messages {names}")
        if names == ["gaps"]:
            need(sequences == {len(self.out.gaps)}, f"{where}: gap message {sequences}, want {len(self.out.gaps)}")
            need(len(messages[0][4]) <= SMALL_LIMIT, f"{where}: gap message of {len(messages[0][4])} bytes")
            gap = json.loads(messages[0][4])
            need(list(gap) == ["first", "count", "reason"], f"{where}: gap with the keys {list(gap)}")
            self.out.gaps.append(gap)
            return
        if names in (["features"], ["patches"]):
            written = len(self.out.features) + len(self.out.patches)
            need(sequences == {written}, f"{where}: message {sequences} about features and patches, want {written}")
            need(len(messages[0][4]) <= NOTE_LIMIT, f"{where}: {names[0]} message of {len(messages[0][4])} bytes")
            note = json.loads(messages[0][4])
            need("group" in note, f"{where}: {names[0]} message without a group")
            (self.out.features if names == ["features"] else self.out.patches).append(note)
            return
        texts = ("gaps", "features", "patches")
        need(names == [name for name in self.names.values() if name not in texts], f"{where}: messages {names}")
        need(len(sequences) == 1, f"{where}: messages of the groups {sequences}")
        self.out.groups.append((sequences.pop(), messages[0][3], [message[4] for message in messages]))
        self.metadata_due = len(self.out.groups) == METADATA_SOON or len(self.out.groups) % METADATA_STRIDE == 0

    def data_section(self, at):
        """Gives the offset of the summary, or None when the recording is unfinished."""
        while at is not None:
            found = next(records(self.data, at), None)
            if found is None:
                return None
            _, opcode, content = found
            if self.metadata_due:
                self.metadata.append((at, len(self.metadata_record), "scansion"))
                at, self.metadata_due = self.expect(at, self.metadata_record, "the copy of the metadata"), False
            elif opcode == CHUNK:
                at = self.chunk(at, content)
            elif opcode == METADATA:
                return self.end_of_data(at)
            else:
                raise FormatError(f"byte {at}: opcode {opcode} in the data section")
        return None

    def end_of_data(self, at):
        end = at + len(self.metadata_record)
        self.metadata.append((at, len(self.metadata_record), "scansion"))
        self.expect(at, self.metadata_record, "the last copy of the metadata")
        found = next(records(self.data, end), None)
        if found is None:
            return None
        _, opcode, content = found
        need(opcode == METADATA, f"byte {end}: opcode {opcode} where scansion.end should stand")
        totals = parse_metadata(content, f"byte {end}: metadata scansion.end", TOTALS)
        built = self.built_metadata("scansion.end", totals)
        self.metadata.append((end, len(built), "scansion.end"))
        at = self.expect(end, built, "metadata scansion.end")
        built = record(DATA_END, struct.pack("<I", zlib.crc32(self.data[:at])))
        if at + len(built) > len(self.data):
            return None
        self.out.totals = totals
        return self.expect(at, built, "DataEnd")

    def summary(self, start):
        """False when the file ends inside."""
        times = self.times or [0]
        counts = b"".join(struct.pack("<HQ", i, count) for i, count in sorted(self.counts.items()))
        absent = 0 if self.out.gaps else 1
        statistics = struct.pack("<QHIIIIQQ", sum(self.counts.values()), len(self.schemas) - absent,
                                 len(self.channels) - absent, 0, len(self.metadata), len(self.chunks), min(times), max(times))
        indexes = [record(METADATA_INDEX, struct.pack("<QQ", offset, size) + text(name)) for offset, size, name in self.metadata]
        statistics = record(STATISTICS, statistics + struct.pack("<I", len(counts)) + counts)
        built = self.definitions(bool(self.out.gaps)) + b"".join([statistics] + self.chunks + indexes)
        built += struct.pack("<BQQQ", FOOTER, 20, start, 0)
        built += struct.pack("<I", zlib.crc32(built)) + MAGIC
        left = len(self.data) - start
        self.expect(start, built[:left], "the summary")
        need(left <= len(built), f"byte {start + len(built)}: {left - len(built)} bytes behind the end")
        return left == len(built)


def read_container(data):
    """Checks the whole file. An unfinished one gives its whole chunks and `totals` None."""
    checker = Checker(data)
    summary = checker.data_section(checker.head())
    if summary is None or not checker.summary(summary):
        checker.out.totals = None
    return checker.out
