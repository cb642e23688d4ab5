#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace apriltrack::test {

/// What a test needs of another project, to compare with.
struct Judge {
  std::string name;
  std::string package;  ///< Which has it: "colmap", "@mcap/core of npm".
  bool is_there = false;
};

/// Whether a shell command ends with 0, its talk thrown away.
bool succeeds(const std::string& command);

/// A program on the PATH.
Judge program_judge(const std::string& program, const std::string& package);

/// Modules of Python, such as "numpy, yaml"; python_with() has them.
Judge python_judge(const std::string& modules, const std::string& package);
/// The Python that has these modules: Debian's own, which alone sees Debian's packages, before the one on the
/// PATH. "python3" where none has them.
std::string python_with(const std::string& modules);

/// Packages of npm, one after the other; and node.
std::vector<Judge> node_judges(const std::vector<std::string>& packages);
/// node as a command of the shell, which finds them in $NODE_PATH and where `scripts/setup --judges` puts
/// them.
std::string node();

/// Empty where all are there; else which is not, and how to get it.
std::string missing_judge(const std::vector<Judge>& judges);
inline std::string missing_judge(const Judge& judge) {
  return missing_judge(std::vector{judge});
}

/// Whether the environment says APRILTRACK_JUDGES=required.
bool are_judges_required();

}  // namespace apriltrack::test

/// For what a test needs of other projects, a Judge or a vector of them: where it is not there, the test is
/// skipped by its name, or fails where judges are required.
#define APRILTRACK_NEED_JUDGE(...)                                                                   \
  if (const std::string missing = ::apriltrack::test::missing_judge(__VA_ARGS__); missing.empty()) { \
  } else if (::apriltrack::test::are_judges_required())                                              \
    FAIL() << missing << ", and APRILTRACK_JUDGES=required";                                         \
  else                                                                                               \
    GTEST_SKIP() << missing
