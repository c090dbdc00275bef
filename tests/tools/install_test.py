"""The installed tree runs from a bare prefix, and its unit files are good.

Usage: install_test.py BUILD_DIR CMAKE
"""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

BUILD, CMAKE = sys.argv[1:3]
BARE = {"PATH": "/usr/bin:/bin", "HOME": "/nonexistent", "LANG": "C.UTF-8"}


class InstalledTree(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = tempfile.TemporaryDirectory()
        cls.prefix = Path(cls.directory.name) / "prefix"
        subprocess.run([CMAKE, "--install", BUILD, "--prefix", cls.prefix], check=True, capture_output=True)

    @classmethod
    def tearDownClass(cls):
        cls.directory.cleanup()

    def tact(self, *arguments):
        """Runs the installed tact with nothing of the checkout in reach."""
        environment = dict(BARE, TACT_CACHE=self.directory.name + "/cache", XDG_RUNTIME_DIR=self.directory.name)
        return subprocess.run([self.prefix / "bin/tact", *arguments], cwd="/", env=environment, capture_output=True,
                              text=True, check=False, timeout=240)

    def test_every_program_and_data_file_is_there(self):
        for name in ("bin/tact", "libexec/tact/tact-contact", "libexec/tact/tact-coupling", "libexec/tact/tact-view",
                     "share/tact/roudi.toml", "share/tact/dds/haptic.xml", "share/tact/scenes/alpha.toml",
                     "share/tact/realtime/rt_setup.sh"):
            self.assertTrue((self.prefix / name).is_file(), name)

    def test_it_finds_its_scenes(self):
        done = self.tact("scenes", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("alpha", [scene["name"] for scene in json.loads(done.stdout)])

    def test_the_doctor_names_every_check(self):
        done = self.tact("doctor", "--json")
        self.assertIn(done.returncode, (0, 1), done.stderr)
        checks = {finding["check"]: finding for finding in json.loads(done.stdout)}
        for check in ("real-time priority", "locked memory", "shared memory", "RouDi", "DDS", "CPU idle states",
                      "CPU features", "real-time throttling", "kernel", "haptic device"):
            self.assertIn(check, checks)
            self.assertIn(checks[check]["level"], ("ok", "warn", "fail"))
            self.assertTrue(checks[check]["level"] == "ok" or checks[check]["advice"], check)

    def test_a_session_runs(self):
        report = Path(self.directory.name) / "report.json"
        done = self.tact("run", "peg", "--view", "off", "--for", "1s", "--report", str(report))
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertGreater(json.loads(report.read_text())["ticks"], 0)
        self.assertEqual(report.with_suffix(".png").read_bytes()[:4], b"\x89PNG")

    def test_the_unit_files_are_good(self):
        units = sorted((self.prefix / "lib/systemd/system").iterdir())
        self.assertEqual(len(units), 5)
        for unit in units:
            done = subprocess.run(["systemd-analyze", "verify", "--man=no", unit], capture_output=True, text=True,
                                  check=False, env=dict(BARE, SYSTEMD_UNIT_PATH=f"{unit.parent}:"))
            self.assertEqual((done.returncode, done.stderr), (0, ""), unit.name)

    def test_real_time_setup_says_what_it_would_do(self):
        script = self.prefix / "share/tact/realtime/rt_setup.sh"
        done = subprocess.run([script, "--dry-run", "ann"], capture_output=True, text=True, check=True)
        for word in ("/etc/security/limits.d/60-tact.conf", "/etc/udev/rules.d/60-tact.rules", "usermod -a -G tact ann"):
            self.assertIn(word, done.stdout)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
