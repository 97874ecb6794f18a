# The daemon on a controller of the grblHAL family that is none of ours.
# SPDX-License-Identifier: Apache-2.0
"""Needs SCANSIOND and SCANSION."""
import math
import unittest

from foreign_grbl import Controller
from port_driver_kit import PortDriverTest, exported, recordings

AREA = {"x_from": -20.0, "x_to": -10.0, "y_from": -30.0, "y_to": -22.0, "pitch": 2.0, "spacing": 2.0, "top": -1.0, "bottom": -15.0}


def dome(x, y):
    return None if (x, y) == (-16.0, -26.0) else -6.0 + math.sin(x) + 0.5 * math.cos(y)


class Foreign(PortDriverTest):
    def controller(self, **odd):
        controller = Controller(dome, **odd)
        self.addCleanup(controller.stop)
        return controller, {"name": "d", "driver": "grbl-probe", "port": controller.where, "feed": 100.0, **AREA}

    def check_dome(self, path):
        points = [point for line in exported(path) for point in line]
        want = [(1000 * x, 1000 * y, round(1000 * round(dome(x, y), 3))) for y in range(-30, -21, 2) for x in range(-20, -9, 2) if dome(x, y) is not None]
        self.assertEqual(points, want)

    def test_four_axes_other_listings_and_unknown_fields(self):
        _, device = self.controller()
        path, status = self.record(device, 5)
        self.check_dome(path)
        self.assertEqual(status["invalid"], 1)
        self.assertEqual(sum(self.check_counters(status)["rejected"].values()), 0)
        self.check_transcript(device, path, 5)

    def test_work_coordinates(self):
        controller, device = self.controller(wco=(-12.5, 3.25, -4.125, 0.0), says_wpos=True)
        path, _ = self.record(device, 5)
        self.check_dome(path)
        targets = {line for line in controller.sent if line.startswith("G38")}
        self.assertTrue(all("Z-10.875" in line for line in targets), targets)

    def test_locked_at_the_start(self):
        controller, device = self.controller(locked=True)
        daemon = self.daemon([device]).start()
        self.assertIn("home it", daemon.until_state("closed")["error"])
        daemon.stop(self)
        self.assertFalse({"$X", "$H"} & set(controller.sent))

    def test_an_alarm_that_grbl_does_not_have(self):
        controller, device = self.controller(alarm_at=9)
        daemon = self.daemon([device]).start()
        self.assertIn("ALARM:14", daemon.until_state("closed")["error"])
        daemon.stop(self)
        self.assertFalse({"$X", "$H"} & set(controller.sent))
        (path,) = recordings(daemon)
        self.check_sound(path)


if __name__ == "__main__":
    unittest.main(verbosity=2)
