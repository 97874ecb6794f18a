# The unit file by systemd's own eyes, nothing booted: does it verify, is it closed enough.
# SPDX-License-Identifier: Apache-2.0
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

UNIT = os.environ["SCANSION_UNIT"]
DAEMON = os.environ["SCANSIOND"]
MOST_EXPOSURE = "20"  # 2.0 of 10


@unittest.skipUnless(shutil.which("systemd-analyze"), "SKIPPED: systemd-analyze is not installed")
class Unit(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="scansion-unit-")
        self.addCleanup(shutil.rmtree, self.folder)
        with open(UNIT) as file:
            text = file.read()
        rows = [f"ExecStart={DAEMON}" if row.startswith("ExecStart=") else row for row in text.splitlines()]
        self.unit = os.path.join(self.folder, "scansiond.service")
        with open(self.unit, "w") as out:
            out.write("\n".join(rows) + "\n")

    def analyze(self, *arguments):
        return subprocess.run(["systemd-analyze", *arguments, self.unit], capture_output=True, text=True)

    def test_verify(self):
        result = self.analyze("verify", "--man=no")
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))

    def test_exposure(self):
        result = self.analyze("security", "--offline=true", f"--threshold={MOST_EXPOSURE}")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        print(result.stdout.strip().splitlines()[-1], file=sys.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
