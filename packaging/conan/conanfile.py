"""Recipe of Conan 2, not run: see packaging/README.md."""

import os
import re

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load

ROOT = os.path.join("..", "..")


class AprilTrack(ConanFile):
    name = "apriltrack"
    license = "BSD-3-Clause"
    description = "Fiducial tracking that keeps the pose through motion blur"
    settings = "os", "arch", "compiler", "build_type"
    requires = (
        "eigen/3.4.0", "fmt/10.2.1", "yaml-cpp/0.8.0", "nlohmann_json/3.11.3", "cli11/2.4.1", "apriltag/3.4.2", "highway/1.1.0",
        "ceres-solver/2.2.0", "opencv/4.10.0", "ffmpeg/7.0.1", "libjpeg-turbo/3.0.2", "lz4/1.9.4", "zstd/1.5.5", "bzip2/1.0.8", "sqlite3/3.45.3",
    )

    def set_version(self):
        header = load(self, os.path.join(self.recipe_folder, ROOT, "libtrack/include/apriltrack/base/version.h"))
        self.version = ".".join(re.findall(r"define APRILTRACK_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", header))

    def export_sources(self):
        for pattern in ("CMakeLists.txt", "LICENSE", "README.md", "CHANGELOG.md", "apps/*", "calib/*", "cmake/*", "docs/*", "examples/*", "libtrack/*", "maps/*",
                        "third_party/*"):
            copy(self, pattern, os.path.join(self.recipe_folder, ROOT), self.export_sources_folder)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        CMakeDeps(self).generate()
        toolchain = CMakeToolchain(self)
        toolchain.variables["APRILTRACK_BUILD_TESTS"] = False
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()

    def package_info(self):
        # The installed configuration is the project's own.
        self.cpp_info.builddirs = [os.path.join("lib", "cmake", "apriltrack")]
        self.cpp_info.set_property("cmake_find_mode", "none")
