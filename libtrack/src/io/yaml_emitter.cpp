#include <fmt/format.h>

#include <cctype>
#include <string_view>

#include "yaml_tree.h"

namespace apriltrack {
namespace {

/// Whether a plain scalar may stay plain inside [] and {}, where more characters have a meaning. Narrow on
/// purpose: quotes do no harm to a text that is no number.
bool can_stay_plain(std::string_view text) {
  if (text.empty()) return false;
  const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  const bool starts_well = is_word(text[0]) || ((text[0] == '-' || text[0] == '+' || text[0] == '.') &&
                                                text.size() > 1 && (is_word(text[1]) || text[1] == '.'));
  if (!starts_well || text.back() == ' ' || text.back() == ':') return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (!is_word(text[i]) && std::string_view("-+._/ :@()=").find(text[i]) == std::string_view::npos)
      return false;
    if (text[i] == ':' && text[i + 1] == ' ') return false;
  }
  return true;
}

std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += {'\\', c};
    } else if (c == '\n') {
      out += "\\n";
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string scalar_text(std::string_view text, bool is_quoted) {
  return !is_quoted && can_stay_plain(text) ? std::string(text) : quoted(text);
}

void append(const YamlTreeNode& node, std::string& out) {
  using Kind = YamlTreeNode::Kind;
  if (!node.tag.empty()) out += fmt::format("!<{}> ", node.tag);
  if (node.kind == Kind::kNull) out += "null";
  if (node.kind == Kind::kScalar) out += scalar_text(node.scalar, node.is_quoted);
  if (node.kind != Kind::kList && node.kind != Kind::kMap) return;
  const bool is_map = node.kind == Kind::kMap;
  out += is_map ? '{' : '[';
  for (std::size_t i = 0; i < node.children.size(); ++i) {
    if (i > 0) out += ", ";
    if (is_map) out += scalar_text(node.keys[i], false) + ": ";
    append(*node.children[i], out);
  }
  out += is_map ? '}' : ']';
}

}  // namespace

std::string to_flow_yaml(const YamlTreeNode& node) {
  std::string out;
  append(node, out);
  return out;
}

}  // namespace apriltrack
