#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace apriltrack {

/// What the readers of YAML and JSON make of a file. The parsers' own trees keep no order of keys (JSON), let
/// duplicate keys pass and know no line of a missing value (YAML), so the tree is built from their events.
struct YamlTreeNode {
  enum class Kind { kNull, kScalar, kList, kMap };

  Kind kind = Kind::kNull;
  std::shared_ptr<const std::string> file;  ///< What messages call the text; shared by all nodes.
  std::size_t line = 1;  ///< From 1; of the key, for what follows a key without being a scalar.
  std::string path;
  std::string scalar;
  bool is_quoted = false;
  std::string tag;  ///< Only application tags such as OpenCV's matrix; empty otherwise.

  std::vector<std::shared_ptr<const YamlTreeNode>> children;
  std::vector<std::string> keys;                       ///< Of a map, beside children.
  std::vector<std::size_t> key_lines;                  ///< Of a map, beside children.
  std::unordered_map<std::string, std::size_t> index;  ///< Key to position.
  std::size_t num_nodes = 1;                           ///< This and all below it, aliases spelled out.
};

/// Builds a tree from a parser's events, in the order of the text. Throws Error(kInvalidInput) on duplicate
/// keys, keys that are no scalars, nesting or aliases beyond measure.
class YamlTreeBuilder {
 public:
  explicit YamlTreeBuilder(const std::string& file);

  std::shared_ptr<const YamlTreeNode> null(std::size_t line);
  /// A value, or the key of the next one; a key is no node: null pointer.
  std::shared_ptr<const YamlTreeNode> scalar(std::size_t line, std::string value, bool is_quoted,
                                             std::string tag = {});
  void begin_list(std::size_t line, std::string tag = {});
  void begin_map(std::size_t line, std::string tag = {});
  /// Ends the innermost list or map and returns it.
  std::shared_ptr<const YamlTreeNode> end();
  /// A node that was built before, in a second place.
  void repeat(std::size_t line, const std::shared_ptr<const YamlTreeNode>& node);

  /// The whole; a null node when the text was empty.
  std::shared_ptr<const YamlTreeNode> finish();

  /// Before a parser sees it: yaml-cpp holds all signs of a line in memory, 200 bytes each. Throws
  /// Error(kInvalidInput) where commas and ends of lines part more values than a tree may have.
  void refuse_too_many_values(std::string_view text) const;

  [[noreturn]] void fail(std::size_t line, const std::string& path, const std::string& what) const;

 private:
  /// Files of this project are 5 deep; parsers and our own recursion are safe far beyond 64.
  static constexpr std::size_t kMaxDepth = 64;
  /// Ten aliases of ten aliases of ... grow without bound from a few lines.
  static constexpr std::size_t kMaxRepeatedNodes = 100'000;
  /// A node takes 340 bytes, a text for it as few as two: maps of 30,000 tags with their covariances have
  /// these.
  static constexpr std::size_t kMaxNodes = 2'000'000;

  struct Level {
    std::shared_ptr<YamlTreeNode> node;
    std::string pending_key;
    std::size_t pending_line = 0;
    bool has_pending_key = false;
  };

  bool expects_key() const;
  void take_key(std::size_t line, std::string key);
  std::string next_path() const;
  [[noreturn]] void fail_of_too_many_values(std::size_t line) const;
  std::shared_ptr<YamlTreeNode> make(YamlTreeNode::Kind kind, std::size_t line);
  void begin(YamlTreeNode::Kind kind, std::size_t line, std::string tag);
  void add(std::shared_ptr<const YamlTreeNode> node);

  std::shared_ptr<const std::string> file_;
  std::vector<Level> open_;
  std::shared_ptr<const YamlTreeNode> root_;
  std::size_t num_nodes_ = 0;
  std::size_t num_repeated_nodes_ = 0;
};

/// Flow style on one line.
std::string to_flow_yaml(const YamlTreeNode& node);

std::shared_ptr<const YamlTreeNode> parse_yaml(const std::string& text, const std::string& name);
std::shared_ptr<const YamlTreeNode> parse_json(const std::string& text, const std::string& name);

}  // namespace apriltrack
