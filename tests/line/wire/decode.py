"""The examples of docs/protocol.md, decoded from what that page says and nothing else: `decode.py protocol.md`."""
import re
import struct
import sys

from cobs import cobs
from crc import Calculator, Configuration

CRC = Calculator(Configuration(32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, True, True))
HELLO = ["role", "schema", "session", "peer", "heartbeat", "echo", "held"]
NUMBERS = {"u8": "B", "u16": "H", "u32": "I", "u64": "Q", "i16": "h", "i64": "q", "Q40": "q", "Q46": "q", "Q62": "q"}
CLASSES = ["hello", "heartbeat", "ack", "nak", "bye", "reliable", "latest", "plain"]


def blocks(page, mark):
    return re.findall(rf"^```{mark}\n(.*?)^```$", page, re.M | re.S)


def example(block):
    return {name: value.strip() for name, _, value in (line.partition(" ") for line in block.splitlines())}


def decode(line):
    """Bytes of one frame, its delimiters with it -> what it says, by the names of the page."""
    stuffed = line.strip(b"\0")
    assert line.endswith(b"\0") and 0 not in stuffed
    body = cobs.decode(stuffed)
    first, kind, seq, ack, t = struct.unpack_from("<BBHHI", body)
    payload, (check,) = body[10:-4], struct.unpack("<I", body[-4:])
    said = {"version": first >> 4, "busy": first >> 3 & 1, "class": first & 7, "kind": kind, "seq": seq, "ack": ack, "t": t}
    said |= {"salt": CRC.checksum(body[:-4]) ^ check, "body": body}
    name = CLASSES[said["class"]]
    if name == "hello":
        said |= zip(HELLO, struct.unpack("<BIIIHII", payload))
    elif name == "heartbeat":
        said |= zip(["echo", "held"], struct.unpack("<II", payload))
    elif name == "latest":
        said |= {"left": struct.unpack_from("<H", payload)[0], "payload": payload[2:]}
    elif name in ("reliable", "plain"):
        said["payload"] = payload
    else:
        assert payload == b""
    assert said["version"] == 1 and len(body) <= 240
    return said


def messages(page):
    """The table of messages: name -> kind, and name and type of each field."""
    table, all_of_them = page.split("\n## Messages\n")[1].split("\n### ")[0], {}
    for kind, name, what in re.findall(r"^\| ?([0-9A-F]{2})? ?\| (\S+) \| ([^|]+) \|", table, re.M):
        if kind:
            fields = []
            all_of_them[name.strip("*")] = int(kind, 16), fields
        else:
            fields.append((name.strip("`"), what.strip("`")))
    return all_of_them


def fields_of(fields, payload):
    """A payload without optional fields -> its numbers by name."""
    said, at = {}, 0
    for name, what in fields:
        element, count = re.fullmatch(r"\[?(\w+)(?:; (\d+)\])?", what).groups()
        form = "<" + int(count or 1) * NUMBERS[element]
        said[name] = struct.unpack_from(form, payload, at)
        at += struct.calcsize(form)
    assert at == len(payload)
    return said


def salt(role, session, peer, schema):
    return CRC.checksum(struct.pack("<BIII", role, session, peer, schema))


def main(page):
    frames = [example(block) for block in blocks(page, "frame")]
    for written in frames:
        said = decode(bytes.fromhex(written.pop("line")))
        for name, value in written.items():
            meant = bytes.fromhex(value) if name in ("payload", "body") else int(value, 0)
            assert said.pop(name) == meant, (name, value)
        assert said.keys() == {"version"}, said
    examples, known = [example(block) for block in blocks(page, "message")], messages(page)
    for written in examples:
        kind, fields = known[written.pop("message")]
        assert kind == int(written.pop("kind"))
        said = fields_of(fields, bytes.fromhex(written.pop("payload")))
        assert said == {name: tuple(map(int, value.split())) for name, value in written.items()}, said
    salts = [example(block) for block in blocks(page, "salt")]
    for written in salts:
        numbers = {name: int(value, 0) for name, value in written.items()}
        assert numbers.pop("salt") == salt(**numbers)
    talk, greeted = [row.split(None, 2) for block in blocks(page, "talk") for row in block.splitlines()], {}
    for _, who, line in talk:
        said = decode(bytes.fromhex(line))
        if CLASSES[said["class"]] == "hello":
            assert said["salt"] == 0
            greeted[who] = said
        else:
            mine, other = greeted[who], greeted[{"host": "board", "board": "host"}[who]]
            assert said["salt"] == salt(mine["role"], mine["session"], other["session"], mine["schema"])
    print(f"{len(frames)} frames, {len(examples)} messages, {len(salts)} salts, {len(talk)} rows of talk")


main(open(sys.argv[1], encoding="utf-8").read())
