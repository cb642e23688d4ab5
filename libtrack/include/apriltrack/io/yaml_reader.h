#pragma once

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace apriltrack {

struct YamlTreeNode;

/// One node of a YAML or JSON file, with file, line and key path for messages. Cheap to copy.
///
/// The only way this project reads YAML: it refuses what the parser underneath lets pass (duplicate keys,
/// numbers in octal, non-finite numbers, unknown keys), and every complaint is an Error(kInvalidInput) that
/// reads `maps/lab.yaml:14: tags[3].size: must be > 0 (is -0.16)`.
class YamlNode {
 public:
  /// Throws Error(kIo) when the file cannot be read, Error(kInvalidInput) when it is no YAML.
  static YamlNode read_file(const std::filesystem::path& path);
  /// name: what messages call the text.
  static YamlNode read_text(const std::string& text, const std::string& name);
  /// The same for JSON, whose mistakes a YAML parser would tell in the wrong words.
  static YamlNode read_json_file(const std::filesystem::path& path);
  static YamlNode read_json_text(const std::string& text, const std::string& name);

  bool is_map() const;
  bool is_list() const;
  bool is_scalar() const;
  /// Empty value or `null`.
  bool is_null() const;

  /// A mapping's value; throws when the key is missing or this is no mapping.
  YamlNode at(std::string_view key) const;
  /// nullopt when the key is missing; throws when this is no mapping.
  std::optional<YamlNode> find(std::string_view key) const;
  /// Keys and values of a mapping in the file's order.
  std::vector<std::pair<std::string, YamlNode>> entries() const;
  /// Items of a list.
  std::vector<YamlNode> items() const;

  /// Throws, with the line of the stray key, unless every key is in `known` or starts with "x_".
  /// Duplicate keys never come this far: reading the file refuses them.
  void expect_keys(std::initializer_list<std::string_view> known) const;

  std::string as_string() const;
  /// Finite.
  double as_double() const;
  /// Decimal; a leading zero is refused, since YAML 1.1 reads 010 as 8 and YAML 1.2 as 10.
  int as_int() const;
  bool as_bool() const;
  /// A list of finite numbers; of `size` of them, if given.
  std::vector<double> as_doubles(std::optional<std::size_t> size = std::nullopt) const;
  /// The node as YAML text on one line (flow style), to keep what we do not understand.
  std::string as_yaml() const;

  /// "maps/lab.yaml:14".
  std::string where() const;
  /// "tags[3].size"; empty for the root.
  const std::string& key_path() const;
  /// Throws Error(kInvalidInput) "<where>: <key path>: <what>".
  [[noreturn]] void fail(std::string_view what) const;

 private:
  explicit YamlNode(std::shared_ptr<const YamlTreeNode> node);
  std::shared_ptr<const YamlTreeNode> node_;
};

}  // namespace apriltrack
