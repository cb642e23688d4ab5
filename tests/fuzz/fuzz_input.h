#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "apriltrack/base/error.h"

namespace apriltrack::fuzz {

/// The bytes as a file, for readers take paths; the same file every time. ending: ".yaml".
std::filesystem::path file_of(std::string_view bytes, const std::string& ending = "");

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// What a reader may do: give something, or throw Error. Any other exception ends the process, which is a
/// finding; so is a message without words.
template <class Function>
bool reads(const Function& function) {
  try {
    function();
    return true;
  } catch (const Error& error) {
    if (error.cause().empty()) __builtin_trap();
    return false;
  }
}

}  // namespace apriltrack::fuzz
