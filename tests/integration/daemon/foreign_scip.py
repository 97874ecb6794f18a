# A SCIP 2 sensor that is none of ours: written from the protocol alone, legal, and odd wherever the protocol lets it be.
# SPDX-License-Identifier: Apache-2.0
"""Shares no code with the driver or with scansim. Each oddity is a keyword of Sensor."""
import os
import select
import socket
import threading
import time
import tty

CODES = (0, 6, 7, 19, 65533)  # no distances


def summed(text):
    return text + chr((sum(text.encode()) & 63) + 0x30)


def coded(value, width):
    return "".join(chr((value >> 6 * (width - 1 - i) & 63) + 0x30) for i in range(width))


class Sensor(threading.Thread):
    # A URG-04LX with a quick motor; steps before 44 are its blind side.
    ARES, AMIN, AMAX, AFRT, DMIN, DMAX = 1024, 44, 725, 384, 20, 5600

    def __init__(self, tcp=False, rpm=6000, **odd):
        super().__init__(daemon=True)
        self.odd, self.rpm, self.period = odd, rpm, 60.0 / rpm
        self.sent = {}  # scan number -> distances by step, as far as they were sent undamaged
        self.requests = []
        self.clock0, self.born = odd.get("clock", 1000), time.monotonic()
        self.mode = "scip1" if odd.get("scip1") else "clock" if odd.get("in_clock_mode") else "rest"
        self.colds, self.deaf, self.scan, self.plan = odd.get("cold", 0), odd.get("deaf", 0), 0, None
        self.faults = dict(odd.get("faults", {}))  # scan number -> what happens instead
        self.ending = False
        self.server = self.client = None
        if tcp:
            self.server = socket.create_server(("127.0.0.1", 0))
            self.where = {"tcp": "127.0.0.1:%d" % self.server.getsockname()[1]}
            self.server.settimeout(30)
            self.link = None
        else:
            self.link, self.held = os.openpty()
            tty.setraw(self.held)
            self.where = {"port": os.ttyname(self.held)}
        if odd.get("streams"):
            self.plan, self.mode = self.read_plan("MD0044072501000;old"), "run"
        self.start()

    def stop(self):
        self.ending = True
        self.join(10)
        for socket_ in (self.server, self.client):
            if socket_:
                socket_.close()

    # What is measured: the number of the scan stands in its first step.
    def distance(self, scan, step):
        if step == self.AMIN:
            return 100 + scan % 3000
        return CODES[step % len(CODES)] if (step + scan) % 17 == 0 else 100 + (step * 7 + scan * 13) % 3900

    def write(self, text):
        data = text.encode()
        step = 1 if self.odd.get("drips") else len(data)
        for at in range(0, len(data), step):
            os.write(self.link, data[at:at + step])

    def answer(self, echo, status, *lines):
        self.write("\n".join([echo, summed(status), *lines]) + "\n\n")

    def rows(self, request, facts):
        rows = list(facts.items())
        if self.odd.get("shuffles"):
            rows = rows[::-1][:3] + [("XTRA", "a;b:c[d")] + rows[::-1][3:] + [("PROT", "SCIP 2.2")]
            lines = [f"{key}:{value};" for key, value in rows]
            return self.answer(request, "00", *(summed(line) for line in lines))  # the ; is summed, too
        self.answer(request, "00", *(f"{k}:{v};" + summed(f"{k}:{v}")[-1] for k, v in rows))

    def now_ms(self):
        ms = self.clock0 + int((time.monotonic() - self.born) * 1000)
        return (ms // 5 * 5 if self.odd.get("ticks") else ms) & 0xFFFFFF

    def read_plan(self, request):
        body, _, _ = request.partition(";")
        return {"kind": body[1], "multi": body[0] == "N", "start": int(body[2:6]), "end": int(body[6:10]),
                "cluster": max(1, int(body[10:12])), "skip": int(body[12]), "left": int(body[13:15]), "request": request}

    def on_request(self, request):
        self.requests.append(request)
        name, body = request.split(";")[0][:2], request.split(";")[0]
        if self.mode == "scip1":
            if request == "SCIP2.0":
                self.mode = "rest"
                return self.write("SCIP2.0\n0\n\n")
            return self.write(request + "\nE\n\n")
        if not request:
            return None
        if body == "QT":
            if self.deaf > 0:
                self.deaf -= 1
                return None
            if self.mode == "clock":
                return self.answer(request, "0E")
            if self.mode == "run" and self.odd.get("late"):
                self.send_scan(self.scan)
            self.mode = "rest"
            return self.answer(request, "00")
        if body == "VV":
            return self.rows(request, {"VEND": "Other Co.", "PROD": "Odd(1)", "FIRM": "3.3.00(16/Apr/08)", "PROT": "SCIP 2.0", "SERI": "H1"})
        if body == "PP":
            return self.rows(request, {"MODL": "ODD-04", "DMIN": self.DMIN, "DMAX": self.DMAX, "ARES": self.ARES, "AMIN": self.AMIN,
                                       "AMAX": self.AMAX, "AFRT": self.AFRT, "SCAN": self.rpm})
        if body == "II":
            if self.odd.get("terse"):
                return self.answer(request, "0B")
            return self.rows(request, {"MODL": "ODD-04", "LASR": "OFF", "SCSP": "Initial(600[rpm])<-Default setting by user",
                                       "MESM": "IDLE", "SBPS": "USB 2.0", "TIME": "002AF", "STAT": "Sensor works well."})
        if name == "TM":
            if self.odd.get("terse"):
                return self.answer(request, "0C")
            if body == "TM1":
                if self.mode != "clock":
                    return self.answer(request, "04")
                if self.odd.get("ticks"):
                    time.sleep(0.005)
                return self.answer(request, "00", summed(coded(self.now_ms(), 4)))
            self.mode = "clock" if body == "TM0" else "rest"
            return self.answer(request, "00")
        if body == "BM":
            if self.odd.get("terse"):
                return self.answer(request, "0D")
            self.colds -= 1
            return self.answer(request, "0M" if self.colds >= 0 else "02" if self.odd.get("lit") else "00")
        if name in ("MD", "MS", "ME", "ND", "NE"):
            self.plan = self.read_plan(request)
            self.answer(request, "00")
            self.mode = "run"
            return None
        return self.answer(request, "0E")

    def data(self, scan, plan):
        out, steps = "", {}
        for step in range(plan["start"], plan["end"] + 1, plan["cluster"]):
            of = [self.distance(scan, s) for s in range(step, min(step + plan["cluster"], plan["end"] + 1))]
            real = [d for d in of if d >= self.DMIN and d <= self.DMAX]
            value = min(real) if real else of[0]
            steps[step] = value
            echoes = [value]
            if plan["multi"] and step % 3 == 0 and real:
                echoes = [value, value + 150, value + 300][:2 + step % 2]
            for number, echo in enumerate(echoes):
                out += "&" * (number > 0) + (coded(min(echo, 4095), 2) if plan["kind"] == "S" else coded(echo, 3))
                if plan["kind"] == "E":
                    out += coded(1000 + step, 3)
        return out, steps

    def send_scan(self, scan):
        plan = self.plan
        left = plan["left"]
        body, tag = plan["request"].partition(";")[::2]
        echo = body[:13] + "%02d" % left + (";" + tag if tag else "")
        what = self.faults.pop(scan, None)
        if isinstance(what, str):
            return self.answer(echo, what)
        stamp = (self.clock0 + int(scan * self.period * 1000)) & 0xFFFFFF
        text, steps = self.data(scan, plan)
        lines = [summed(text[i:i + 64]) for i in range(0, len(text), 64)]
        if callable(what):
            lines = what(lines)
        elif not plan["request"].endswith(";old"):
            self.sent[scan] = steps
        self.answer(echo, "99", summed(coded(stamp, 4)), *lines)
        return None

    def run(self):
        if self.link is None:
            self.client, _ = self.server.accept()
            self.client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self.link = self.client.fileno()
        held = b""
        while not self.ending:
            # The motor turns whether anybody looks or not.
            due = self.born + (self.scan + 1) * self.period
            ready, _, _ = select.select([self.link], [], [], max(0.0, min(0.2, due - time.monotonic())))
            try:
                if ready:
                    part = os.read(self.link, 4096)
                    if not part:
                        return
                    held += part
                    *requests, held = held.replace(b"\r", b"\n").split(b"\n")
                    for request in requests:
                        self.on_request(request.decode("latin-1"))
                if time.monotonic() >= due:
                    self.scan += 1
                    if self.mode == "run" and self.scan % (self.plan["skip"] + 1) == 0:
                        self.send_scan(self.scan)
            except OSError:
                return
