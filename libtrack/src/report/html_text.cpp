#include "html_text.h"

#include <algorithm>
#include <cstdint>

namespace apriltrack {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD

struct Character {
  std::size_t length = 0;  ///< Bytes; 0 when they are no UTF-8.
  std::uint32_t code = 0;
};

/// The first character of non-empty text (RFC 3629).
Character first_character(std::string_view text) {
  const auto lead = static_cast<std::uint8_t>(text.front());
  if (lead < 0x80) return {1, lead};
  const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < length) return {};
  std::uint32_t code = lead & (0x7Fu >> length);
  for (const char byte : text.substr(1, length - 1)) {
    if ((static_cast<std::uint8_t>(byte) & 0xC0) != 0x80) return {};
    code = code << 6 | (static_cast<std::uint8_t>(byte) & 0x3Fu);
  }
  constexpr std::uint32_t kSmallest[] = {0, 0, 0x80, 0x800, 0x10000};
  return code < kSmallest[length] ? Character{} : Character{length, code};
}

/// Char of XML 1.0, section 2.2.
bool is_xml(std::uint32_t code) {
  if (code < 0x20) return code == '\t' || code == '\n' || code == '\r';
  return code < 0xD800 || (code > 0xDFFF && code < 0xFFFE) || (code >= 0x10000 && code <= 0x10FFFF);
}

std::string_view entity_of(std::uint32_t code) {
  switch (code) {
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '&':
      return "&amp;";
    case '"':
      return "&quot;";
    case '\'':
      return "&#39;";
    default:
      return {};
  }
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const Character character = first_character(text);
    if (character.length == 0 || !is_xml(character.code)) {
      out += kReplacement;
    } else if (const auto entity = entity_of(character.code); !entity.empty()) {
      out += entity;
    } else {
      out += text.substr(0, character.length);
    }
    text.remove_prefix(std::max<std::size_t>(character.length, 1));
  }
  return out;
}

bool is_number_or_blank(std::string_view cell) {
  if (cell.empty() || cell == "-" || cell == "\xE2\x80\x93" || cell == "none" || cell == "n/a") return true;
  if (cell.starts_with("- (")) return true;
  if (cell.front() == '-' || cell.front() == '+' || cell.front() == '<' || cell.front() == '>')
    cell.remove_prefix(1);
  if (!cell.empty() && cell.front() == ' ') cell.remove_prefix(1);
  return !cell.empty() && is_digit(cell.front());
}

}  // namespace apriltrack
