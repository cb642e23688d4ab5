#include "apriltrack/io/yaml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "apriltrack/base/error.h"
#include "apriltrack/io/input_file.h"
#include "apriltrack/io/numbers.h"
#include "yaml_tree.h"

namespace apriltrack {
namespace {

using Kind = YamlTreeNode::Kind;

/// What stands there, for a message.
std::string describe(const YamlTreeNode& node) {
  constexpr std::size_t kMaxLength = 60;
  switch (node.kind) {
    case Kind::kNull:
      return "is empty";
    case Kind::kList:
      return fmt::format("is a list of {}", node.children.size());
    case Kind::kMap:
      return fmt::format("is a mapping of {} keys", node.children.size());
    case Kind::kScalar:
      break;
  }
  if (node.scalar.size() <= kMaxLength) return fmt::format("is '{}'", node.scalar);
  return fmt::format("is '{}...'", node.scalar.substr(0, kMaxLength));
}

/// YAML 1.1 reads 010 as 8, YAML 1.2 as 10, and "-010" likewise.
bool has_leading_zero(std::string_view text) {
  if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
  return text.size() > 1 && text[0] == '0' &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

bool is_non_finite_word(std::string_view text) {
  if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
  if (text.starts_with('.')) text.remove_prefix(1);
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower == "inf" || lower == "nan" || lower == "infinity";
}

}  // namespace

YamlNode::YamlNode(std::shared_ptr<const YamlTreeNode> node) : node_(std::move(node)) {}

YamlNode YamlNode::read_file(const std::filesystem::path& path) {
  return read_text(apriltrack::read_file(path), path.string());
}

YamlNode YamlNode::read_text(const std::string& text, const std::string& name) {
  return YamlNode(parse_yaml(text, name));
}

YamlNode YamlNode::read_json_file(const std::filesystem::path& path) {
  return read_json_text(apriltrack::read_file(path), path.string());
}

YamlNode YamlNode::read_json_text(const std::string& text, const std::string& name) {
  return YamlNode(parse_json(text, name));
}

bool YamlNode::is_map() const {
  return node_->kind == Kind::kMap;
}
bool YamlNode::is_list() const {
  return node_->kind == Kind::kList;
}
bool YamlNode::is_scalar() const {
  return node_->kind == Kind::kScalar;
}
bool YamlNode::is_null() const {
  return node_->kind == Kind::kNull;
}

YamlNode YamlNode::at(std::string_view key) const {
  auto value = find(key);
  if (!value) fail(fmt::format("'{}' is missing", key));
  return *std::move(value);
}

std::optional<YamlNode> YamlNode::find(std::string_view key) const {
  if (!is_map()) fail(fmt::format("must be a mapping with a key '{}' ({})", key, describe(*node_)));
  const auto found = node_->index.find(std::string(key));
  if (found == node_->index.end()) return std::nullopt;
  return YamlNode(node_->children[found->second]);
}

std::vector<std::pair<std::string, YamlNode>> YamlNode::entries() const {
  if (!is_map()) fail(fmt::format("must be a mapping ({})", describe(*node_)));
  std::vector<std::pair<std::string, YamlNode>> entries;
  entries.reserve(node_->children.size());
  for (std::size_t i = 0; i < node_->children.size(); ++i) {
    entries.emplace_back(node_->keys[i], YamlNode(node_->children[i]));
  }
  return entries;
}

std::vector<YamlNode> YamlNode::items() const {
  if (!is_list()) fail(fmt::format("must be a list ({})", describe(*node_)));
  std::vector<YamlNode> items;
  items.reserve(node_->children.size());
  for (const auto& child : node_->children) items.push_back(YamlNode(child));
  return items;
}

void YamlNode::expect_keys(std::initializer_list<std::string_view> known) const {
  if (!is_map()) fail(fmt::format("must be a mapping ({})", describe(*node_)));
  for (std::size_t i = 0; i < node_->keys.size(); ++i) {
    const std::string& key = node_->keys[i];
    if (key.starts_with("x_") || std::find(known.begin(), known.end(), key) != known.end()) continue;
    const std::string path = node_->path.empty() ? key : node_->path + "." + key;
    throw invalid_input(fmt::format("{}:{}", *node_->file, node_->key_lines[i]),
                        fmt::format("{}: unknown key; known here are {} and x_... for your own", path,
                                    fmt::join(known, ", ")));
  }
}

std::string YamlNode::as_string() const {
  if (!is_scalar()) fail(fmt::format("must be a text ({})", describe(*node_)));
  return node_->scalar;
}

double YamlNode::as_double() const {
  const std::string& text = node_->scalar;
  if (is_scalar() && has_leading_zero(text))
    fail(fmt::format("must be a number without leading zeros (is '{}')", text));
  const auto value = is_scalar() ? parse_double(text) : std::nullopt;
  if (value ? !std::isfinite(*value) : is_scalar() && is_non_finite_word(text)) {
    fail(fmt::format("must be a finite number (is '{}')", text));
  }
  if (!value) fail(fmt::format("must be a number ({})", describe(*node_)));
  return *value;
}

int YamlNode::as_int() const {
  const std::string& text = node_->scalar;
  if (is_scalar() && has_leading_zero(text)) {
    fail(fmt::format(
        "must be a decimal number without leading zeros, which some readers take for octal (is '{}')", text));
  }
  const auto value = is_scalar() ? parse_integer(text) : std::nullopt;
  if (!value) fail(fmt::format("must be a whole number ({})", describe(*node_)));
  using Limits = std::numeric_limits<int>;
  if (*value < Limits::min() || *value > Limits::max()) {
    fail(fmt::format("must lie in [{}, {}] (is {})", Limits::min(), Limits::max(), *value));
  }
  return static_cast<int>(*value);
}

bool YamlNode::as_bool() const {
  const std::string& text = node_->scalar;
  if (is_scalar() && (text == "true" || text == "True" || text == "TRUE")) return true;
  if (is_scalar() && (text == "false" || text == "False" || text == "FALSE")) return false;
  fail(fmt::format("must be true or false ({})", describe(*node_)));
}

std::vector<double> YamlNode::as_doubles(std::optional<std::size_t> size) const {
  const std::string wanted =
      size ? fmt::format("must be a list of {} numbers", *size) : "must be a list of numbers";
  if (!is_list() || (size && node_->children.size() != *size))
    fail(fmt::format("{} ({})", wanted, describe(*node_)));
  std::vector<double> values;
  values.reserve(node_->children.size());
  for (const auto& child : node_->children) values.push_back(YamlNode(child).as_double());
  return values;
}

std::string YamlNode::as_yaml() const {
  return to_flow_yaml(*node_);
}

std::string YamlNode::where() const {
  return fmt::format("{}:{}", *node_->file, node_->line);
}

const std::string& YamlNode::key_path() const {
  return node_->path;
}

void YamlNode::fail(std::string_view what) const {
  throw invalid_input(where(),
                      node_->path.empty() ? std::string(what) : node_->path + ": " + std::string(what));
}

}  // namespace apriltrack
