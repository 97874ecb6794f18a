# A controller of the grblHAL family that is none of ours: written from the protocol alone, with all in which it may differ from Grbl 1.1.
# SPDX-License-Identifier: Apache-2.0
"""Shares no code with the driver or with scansim. It moves at once; what it says is what matters here."""
import os
import re
import select
import threading
import tty


class Controller(threading.Thread):
    """`height(x, y)`: of the part in machine coordinates, or None. `wco`: work offset, four axes. `says_wpos`: $10 has no MPos."""

    def __init__(self, height, wco=(0.0, 0.0, 0.0, 0.0), says_wpos=False, locked=False, alarm_at=None):
        super().__init__(daemon=True)
        self.height, self.wco, self.says_wpos, self.alarm_at = height, wco, says_wpos, alarm_at
        self.at, self.probe, self.probes = [0.0, 0.0, 0.0, 0.0], None, 0
        self.state = "Alarm" if locked else "Idle"
        self.reports = 0
        self.sent = []
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        self.where = os.ttyname(self.slave)
        self.ending = False
        self.start()

    def stop(self):
        self.ending = True
        self.join(10)

    def say(self, *lines):
        os.write(self.master, "".join(line + "\r\n" for line in lines).encode())

    def numbers(self, values):
        return ",".join(f"{v:.3f}" for v in values)

    def report(self):
        self.reports += 1
        place = [a - b for a, b in zip(self.at, self.wco)] if self.says_wpos else self.at
        fields = [("WPos:" if self.says_wpos else "MPos:") + self.numbers(place), "Bf:100,1023", "FS:0,0", "Ln:0"]
        if abs(self.at[2] - (self.surface() or -1e9)) < 1e-9:
            fields.append("Pn:PR")
        if self.reports % 10 == 1:
            fields.append("WCO:" + self.numbers(self.wco))
        elif self.reports % 10 == 2:
            fields += ["Ov:100,100,100", "A:", "TLR:0", "H:1,7", "NEW:x"]
        self.say(f"<{self.state}|{'|'.join(fields)}>")

    def surface(self):
        z = self.height(round(self.at[0], 3), round(self.at[1], 3))
        return None if z is None else round(z, 3)

    def on_line(self, line):
        line = line.upper().replace(" ", "")
        self.sent.append(line)
        if line in ("", "$G", "$#", "$$", "$I"):
            self.listing(line)
            self.say("ok")
        elif self.state == "Alarm":
            self.say("error:9")
        elif line.startswith("G38."):
            self.on_probe(line)
        else:
            words = dict(re.findall(r"([XYZ])(-?[0-9.]+)", line))
            if line.startswith("G53"):
                for axis, value in words.items():
                    self.at["XYZ".index(axis)] = float(value)
            self.say("ok")

    def listing(self, line):
        if line == "$I":
            self.say("[VER:1.1f.20240330:Odd one]", "[OPT:VNML+,100,1024,3,0]", "[AXS:4:XYZA]", "[NEWOPT:ENUMS,RT+,ES,REBOOT]", "[FIRMWARE:grblHAL]",
                     "[SIGNALS:HSEP]", "[NVS STORAGE:*FLASH]", "[DRIVER:Odd]", "[BOARD:None]")
        elif line == "$$":
            self.say("$0=5.0", "$10=511", "$13=0", "$20=0", "$22=0", "$23=0", "$100=250.00000", "$101=250.00000", "$102=250.00000", "$103=250.00000",
                     "$122=200.000", "$130=300.000", "$131=300.000", "$132=100.000", "$300=grblHAL", "$341=0", "$398=100", "$481=0")
        elif line == "$#":
            probe = self.probe or ([0.0] * 4, 0)
            self.say("[G54:" + self.numbers(self.wco) + "]", "[G59.3:0.000,0.000,0.000,0.000]", "[G28:0.000,0.000,0.000,0.000]",
                     "[G92:0.000,0.000,0.000,0.000]", "[HOME:0.000,0.000,0.000,0.000:7]", "[TLO:0.000,0.000,0.000,0.000]",
                     "[PRB:" + self.numbers(probe[0]) + f":{probe[1]}]", "[TLR:0.000]")
        elif line == "$G":
            self.say("[GC:G0 G54 G17 G21 G90 G94 G49 G98 G50 M5 M9 T0 F0 S0.]")

    def on_probe(self, line):
        self.probes += 1
        if self.probes == self.alarm_at:
            self.state = "Alarm"
            return self.say("ALARM:14", "[MSG:Emergency stop]", "ok")  # a number that the table of Grbl does not have
        bottom = float(re.search(r"Z(-?[0-9.]+)", line).group(1)) + self.wco[2]
        surface = self.surface()
        hit = surface is not None and surface > bottom
        self.at[2] = surface if hit else bottom
        self.probe = (list(self.at), int(hit))
        # The end position also when nothing was met, and messages in between.
        return self.say("[MSG:Probing]", "[PRB:" + self.numbers(self.at) + f":{int(hit)}]", "ok")

    def run(self):
        self.say("", "GrblHAL 1.1f ['$' or '$HELP' for help]")
        if self.state == "Alarm":
            self.say("[MSG:'$H'|'$X' to unlock]")
        held = b""
        while not self.ending:
            if not select.select([self.master], [], [], 0.1)[0]:
                continue
            for byte in os.read(self.master, 4096):
                if byte in b"?\x80":
                    self.report()
                elif byte == 0x18:
                    held = b""
                    self.say("", "GrblHAL 1.1f ['$' or '$HELP' for help]")
                elif byte in b"!~":
                    self.state = "Hold:0" if byte == 0x21 else "Idle"
                elif byte in b"\r\n":
                    self.on_line(held.decode("latin-1"))
                    held = b""
                elif byte < 0x80:
                    held += bytes([byte])
