#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace apriltrack::test {

/// A recording or tool of the shared folder beside the checkout (or in $APRILTRACK_SHARED), such as
/// "data/room_gentle"; nullopt when it is not there. Tests that need it skip, and say so.
std::optional<std::filesystem::path> shared_path(const std::string& name);

/// A file of the source tree, such as "maps/room.yaml".
std::filesystem::path source_path(const std::string& name);

/// A fresh, empty folder of the running test's own; removed when the test program ends well.
std::filesystem::path temporary_folder();

}  // namespace apriltrack::test

/// Declares `variable` as the path of a shared recording, or skips the test with a message.
#define APRILTRACK_SHARED_OR_SKIP(variable, name)                                                    \
  const auto variable##_or_none = ::apriltrack::test::shared_path(name);                             \
  if (!variable##_or_none)                                                                           \
    GTEST_SKIP() << "shared recording '" << (name) << "' is not beside this checkout: test not run"; \
  const std::filesystem::path variable = *variable##_or_none
