"""Wrong includes in a small tree of its own are caught, right ones are not."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

CHECKER = Path(__file__).parents[2] / "tools/lint/check_layers.py"


class CheckLayers(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.root = Path(directory.name)
        self.write("common/CMakeLists.txt", "foreach(folder fault math link)\nendforeach()\n")
        self.write("services/contact/CMakeLists.txt", "foreach(folder model bake server)\nendforeach()\n")
        self.write("services/coupling/CMakeLists.txt", "foreach(folder device loop)\nendforeach()\n")
        self.write("services/view/CMakeLists.txt", "foreach(folder model render)\nendforeach()\n")
        self.write("common/fault/fault.hpp", "")
        self.write("common/math/pose.hpp", "#include <vector>\n#include <Eigen/Core>\n#include \"fault/fault.hpp\"\n")
        self.write("common/link/link.hpp", "#include \"dds/dds.h\"\n#include \"math/pose.hpp\"\n")
        self.write("services/contact/model/contact.hpp", "#include \"math/pose.hpp\"\n")
        self.write("services/contact/server/server.cpp", "#include \"contact/model/contact.hpp\"\n")
        self.write("services/contact/main.cpp", "#include \"contact/model/contact.hpp\"\n")
        self.write("services/coupling/loop/loop.hpp", "")
        self.write("tests/contact/contact_test.cpp", "#include \"contact/model/contact.hpp\"\n#include <dds/dds.h>\n")

    def write(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def run_checker(self):
        done = subprocess.run([sys.executable, CHECKER, self.root], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout + done.stderr

    def assert_caught(self, path, text, reason):
        self.write(path, text)
        code, output = self.run_checker()
        self.assertEqual(code, 1, output)
        self.assertIn(path + ":", output)
        self.assertIn(reason, output)
        self.assertIn("1 wrong includes", output)

    def test_a_tree_whose_arrows_point_down_passes(self):
        code, output = self.run_checker()
        self.assertEqual(code, 0, output)

    def test_a_lower_folder_may_not_include_a_higher_one(self):
        self.assert_caught("common/fault/fault.hpp", "#include \"math/pose.hpp\"\n", "common/math is above common/fault")

    def test_an_include_beside_the_file_is_followed_too(self):
        self.assert_caught("common/fault/fault.hpp", "#  include \"../math/pose.hpp\"\n", "common/math is above")

    def test_common_may_not_include_a_service(self):
        self.assert_caught("common/math/bad.cpp", "#include \"contact/model/contact.hpp\"\n", "common includes no service")

    def test_services_may_not_include_one_another(self):
        self.assert_caught("services/view/model/bad.cpp", "#include \"coupling/loop/loop.hpp\"\n", "services never")

    def test_the_product_may_not_include_tools(self):
        self.write("tools/cli/report.hpp", "")
        self.assert_caught("services/view/model/bad.cpp", "#include \"cli/report.hpp\"\n", "does not include tools")

    def test_a_library_stays_behind_its_folder(self):
        self.assert_caught("services/contact/model/bad.cpp", "#include <dds/dds.h>\n", "dds belongs to common/link")
        self.write("services/contact/model/bad.cpp", "")
        self.assert_caught("services/view/model/bad.cpp", "#include <opencv2/core.hpp>\n", "services/view/render")

    def test_a_folder_must_have_its_place_in_the_order(self):
        self.write("services/contact/extra/extra.hpp", "")
        self.assert_caught("services/contact/server/bad.cpp", "#include \"contact/extra/extra.hpp\"\n", "not in the order")


if __name__ == "__main__":
    unittest.main()
