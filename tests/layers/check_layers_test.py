"""Plants one breach at a time in a copy of the tree and expects scripts/check_layers to name it.

  check_layers_test.py SOURCE-FOLDER
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(sys.argv.pop(1)).resolve()


class PlantedBreach(unittest.TestCase):
    # One copy serves all tests: each leaves it as it was.
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.root = pathlib.Path(cls.temporary.name)
        for folder in ("libtrack", "calib", "apps"):
            shutil.copytree(SOURCE / folder, cls.root / folder)
        (cls.root / "docs").mkdir()
        shutil.copy(SOURCE / "docs/architecture.md", cls.root / "docs")

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def setUp(self):
        self.before = {}  # of what was changed; None where there was no file

    def tearDown(self):
        for path, text in self.before.items():
            if text is not None:
                path.write_text(text)
                continue
            path.unlink(missing_ok=True)
            if not any(path.parent.iterdir()):
                path.parent.rmdir()

    def write(self, file, text):
        path = self.root / file
        self.before.setdefault(path, path.read_text() if path.exists() else None)
        path.write_text(text)

    def check(self):
        command = [sys.executable, str(SOURCE / "scripts/check_layers"), str(self.root)]
        return subprocess.run(command, capture_output=True, text=True)

    def plant(self, file, line):
        """Adds a line to the end of a file, or makes the file; returns its file:line."""
        path = self.root / file
        before = path.read_text() if path.exists() else "// new\n"
        self.write(file, before + line + "\n")
        return f"{file}:{before.count(chr(10)) + 1}"

    def replace(self, file, old, new):
        path = self.root / file
        text = path.read_text()
        self.assertEqual(text.count(old), 1, f"{old!r} in {file}")
        self.write(file, text.replace(old, new))

    def expect_breach(self, *words):
        run = self.check()
        self.assertEqual(run.returncode, 1, run.stdout + run.stderr)
        lines = [line for line in run.stdout.splitlines() if all(word in line for word in words)]
        self.assertEqual(len(lines), 1, run.stdout)

    def test_the_copy_is_clean_before(self):
        run = self.check()
        self.assertEqual(run.returncode, 0, run.stdout)
        self.assertIn("0 breaches", run.stdout)

    def test_include_of_an_upper_floor(self):
        place = self.plant("libtrack/src/base/error.cpp", '#include "apriltrack/geometry/pose.h"')
        self.expect_breach(place + ":", "base may not include geometry", "floor 0", "floor 1")

    def test_include_of_an_upper_floor_in_a_public_header_with_blanks_and_angles(self):
        place = self.plant("libtrack/include/apriltrack/tags/tag_key.h", "  #  include <apriltrack/detect/detector.h>")
        self.expect_breach(place + ":", "tags may not include detect")

    def test_include_of_a_neighbour_on_the_same_floor(self):
        place = self.plant("libtrack/src/eval/new.cpp", '#include "apriltrack/source/frame_source.h"')
        self.expect_breach(place + ":", "eval may not include source")

    def test_library_that_the_table_does_not_give(self):
        place = self.plant("libtrack/src/tracker/new.cpp", "#include <opencv2/core.hpp>")
        self.expect_breach(place + ":", "tracker may not include opencv")
        place = self.plant("libtrack/src/detect/new.cpp", "#include <ceres/ceres.h>")
        self.expect_breach(place + ":", "detect may not include ceres")

    def test_opencv_by_the_back_door(self):
        place = self.plant("libtrack/src/detect/new.cpp", '#include "apriltrack/image/opencv_bridge.h"')
        self.expect_breach(place + ":", "detect", "opencv_bridge.h")

    def test_library_in_a_public_header(self):
        place = self.plant("libtrack/include/apriltrack/io/csv.h", "#include <fmt/format.h>")
        self.expect_breach(place + ":", "public headers", "fmt")

    def test_system_header_in_a_public_header(self):
        place = self.plant("libtrack/include/apriltrack/io/csv.h", "#include <unistd.h>")
        self.expect_breach(place + ":", "public headers")

    def test_private_header_of_another_module(self):
        place = self.plant("libtrack/src/sim/new.cpp", '#include "../detect/merge.h"')
        self.expect_breach(place + ":", "neither apriltrack/")

    def test_room_of_a_module_uses_the_modules_private_headers(self):
        self.plant("libtrack/src/tags/formats/new.cpp", '#include "../tag_fields.h"')
        self.plant("libtrack/src/tags/formats/new.cpp", '#include "foreign_map.h"')
        run = self.check()
        self.assertEqual(run.returncode, 0, run.stdout)

    def test_room_of_another_module(self):
        place = self.plant("libtrack/src/tags/formats/new.cpp", '#include "../../io/yaml_tree.h"')
        self.expect_breach(place + ":", "neither apriltrack/")

    def test_room_entered_beside_its_door(self):
        place = self.plant("libtrack/src/tags/new.cpp", '#include "formats/foreign_map.h"')
        self.expect_breach(place + ":", "neither apriltrack/")
        place = self.plant("libtrack/src/sim/new.cpp", '#include "../tags/formats/formats.h"')
        self.expect_breach(place + ":", "neither apriltrack/")

    def test_room_that_goes_upwards(self):
        place = self.plant("libtrack/src/tags/formats/new.cpp", '#include "apriltrack/detect/detector.h"')
        self.expect_breach(place + ":", "tags may not include detect")

    def test_room_of_apps_that_goes_upwards(self):
        place = self.plant("apps/cli/new.cpp", '#include "files/inputs.h"')
        self.expect_breach(place + ":", "apps/cli may not include apps/files")
        place = self.plant("apps/pages/new.cpp", '#include "commands/track/track_record.h"')
        self.expect_breach(place + ":", "apps/pages may not include apps/commands/track")

    def test_command_that_includes_another(self):
        place = self.plant("apps/commands/detect/new.cpp", '#include "commands/track/track_record.h"')
        self.expect_breach(place + ":", "apps/commands/detect may not include apps/commands/track")

    def test_page_of_a_command_uses_the_commands_own_files(self):
        self.plant("apps/commands/track/page/new.cpp", '#include "commands/track/track_record.h"')
        self.assertEqual(self.check().returncode, 0, self.check().stdout)

    def test_header_of_apps_that_is_named_from_elsewhere(self):
        place = self.plant("apps/pages/new.cpp", '#include "../cli/console.h"')
        self.expect_breach(place + ":", "'../cli/console.h' is named")
        place = self.plant("apps/pages/new.cpp", '#include "no_such.h"')
        self.expect_breach(place + ":", "'no_such.h' is neither apriltrack/")

    def test_file_of_apps_in_no_room(self):
        self.plant("apps/new.cpp", "#include <vector>")
        self.expect_breach("apps/new.cpp:", "is in no room of apps")
        (self.root / "apps/odd").mkdir()
        self.plant("apps/odd/new.cpp", "#include <vector>")
        self.expect_breach("apps/odd/new.cpp:", "is in no room of apps")

    def test_folder_of_apps_with_too_many_files(self):
        for number in range(40):
            self.plant(f"apps/commands/detect/new_{number}.cpp", "#include <vector>")
        self.expect_breach("apps/commands/detect:", "has 41 files; 40 are the most")

    def test_table_of_rooms_that_goes_upwards(self):
        self.replace("docs/architecture.md", "| apps/cli | |", "| apps/cli | pages |")
        self.expect_breach("docs/architecture.md", "apps/cli may not include apps/pages")

    def test_private_header_beside_the_one_that_is_excepted(self):
        place = self.plant("libtrack/src/detect/library_detector.cpp", '#include "../tags/tag_fields.h"')
        self.expect_breach(place + ":", "neither apriltrack/")
        place = self.plant("libtrack/src/detect/new.cpp", '#include "../tags/native_family.h"')
        self.expect_breach(place + ":", "neither apriltrack/")

    def test_private_header_whose_exception_is_gone(self):
        self.replace("docs/architecture.md", "| `detect/library_detector.cpp` |", "| `detect/merge.cpp` |")
        self.expect_breach("libtrack/src/detect/library_detector.cpp:", "'../tags/native_family.h'", "neither apriltrack/")

    def test_exception_that_goes_upwards(self):
        self.replace("docs/architecture.md", "| `detect/library_detector.cpp` |", "| `image/response.cpp` |")
        self.expect_breach("docs/architecture.md", "image/response.cpp may not be excepted")

    def test_type_of_a_library_in_a_public_header(self):
        file = "libtrack/include/apriltrack/tags/new.h"
        self.plant(file, "struct apriltag_family;")
        self.expect_breach(file + ":2:", "no type of another library", "apriltag_family")

    def test_unknown_library(self):
        place = self.plant("apps/new.cpp", "#include <boost/any.hpp>")
        self.expect_breach(place + ":", "no rule knows <boost/any.hpp>")

    def test_module_that_the_table_does_not_have(self):
        (self.root / "libtrack/src/extra").mkdir()
        self.plant("libtrack/src/extra/new.cpp", "#include <vector>")
        self.expect_breach("libtrack/src/extra/new.cpp", "'extra' is no module")

    def test_cmake_that_differs_from_the_table(self):
        self.replace("libtrack/CMakeLists.txt", "apriltrack_add_module(geometry DEPENDS base", "apriltrack_add_module(geometry DEPENDS base io")
        self.expect_breach("libtrack/CMakeLists.txt:", "geometry: DEPENDS ['base', 'io'] differ from the table's ['base']")

    def test_table_that_goes_upwards(self):
        self.replace("docs/architecture.md", "| 1 matter | geometry | base |", "| 1 matter | geometry | base, image |")
        self.expect_breach("docs/architecture.md", "geometry (floor 1) may not include image (floor 1)")

    def test_file_that_is_opened_past_the_door(self):
        for number, line in enumerate((
                "std::ifstream file(path);", 'FILE* file = std::fopen("x", "r");', "const cv::Mat picture = cv::imread(path);",
                "const auto root = YAML::LoadFile(path);", "const int fd = ::open(path, O_RDONLY | O_CLOEXEC);",
                "const int fd = ::open(path,\n    O_RDWR);", "cv::VideoCapture capture(path);", "sqlite3_open_v2(path, &raw, 0, nullptr);",
                "avformat_open_input(&file, path, nullptr, nullptr);")):
            place = self.plant(f"libtrack/src/tags/new_{number}.cpp", line)
            self.expect_breach(place + ":", "past the door")
            (self.root / place.split(":")[0]).unlink()
        self.plant("libtrack/src/tags/new.cpp", "const int fd = ::open(path,\n    O_WRONLY | O_CREAT, 0600);  // no std::ifstream\n")
        self.assertEqual(self.check().returncode, 0, self.check().stdout)

    def test_circle_of_units(self):
        self.plant("libtrack/src/base/first.h", '#include "second.h"')
        self.plant("libtrack/src/base/second.h", "#pragma once")
        self.plant("libtrack/src/base/second.cpp", '#include "third.h"')
        place = self.plant("libtrack/src/base/third.h", '#include "first.h"')
        self.expect_breach("module base:", "3 units include each other in a circle: first, second, third", place + " includes first",
                           "libtrack/src/base/second.cpp:2 includes third")

    def test_circle_through_a_public_header_and_a_room(self):
        self.plant("libtrack/include/apriltrack/camera/new.h", "#pragma once")
        self.plant("libtrack/src/camera/formats/new.cpp", '#include "apriltrack/camera/new.h"')
        self.plant("libtrack/src/camera/formats/new.cpp", '#include "beside.h"')
        self.plant("libtrack/src/camera/formats/beside.h", '#include "apriltrack/camera/new.h"')
        self.expect_breach("module camera:", "2 units include each other in a circle: formats/beside, new")

    def test_files_of_one_unit_are_no_circle(self):
        self.plant("libtrack/src/base/first.h", "#pragma once")
        self.plant("libtrack/src/base/first.cpp", '#include "first.h"')
        self.plant("libtrack/src/base/second.cpp", '#include "first.h"')
        self.assertEqual(self.check().returncode, 0, self.check().stdout)

    def test_circle_that_grows(self):
        self.plant("libtrack/src/sim/scenes.h", '#include "grown.h"')
        self.plant("libtrack/src/sim/grown.h", '#include "scenes.h"')
        self.expect_breach("module sim:", "3 units include each other in a circle: grown, named_scenes, scenes")

    def test_circle_that_shrank_is_taken_off_the_list(self):
        self.replace("docs/architecture.md", "| circle in sim | named_scenes, scenes |", "| circle in sim | named_scenes, scenes, streaks |")
        self.expect_breach("docs/architecture.md:", "no circle in sim has these any more", ": streaks")

    def test_circle_off_the_list(self):
        self.replace("docs/architecture.md", "| circle in sim | named_scenes, scenes |\n", "")
        self.expect_breach("module sim:", "2 units include each other in a circle: named_scenes, scenes")

    def test_table_that_is_gone(self):
        self.write("docs/architecture.md", "# nothing\n")
        self.assertNotEqual(self.check().returncode, 0)


if __name__ == "__main__":
    unittest.main()
