#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace apriltrack::test {

/// A page as two independent parsers of HTML and XML read it (tests/report/read_page.py), which also refuse
/// what asks for the network.
class ReadReport {
 public:
  /// A failed expectation where the page is not there or not well-formed.
  explicit ReadReport(const std::filesystem::path& page);

  /// The cells behind the first one of the first row that is called so; a failed expectation where there is
  /// none.
  std::vector<std::string> row(const std::string& name) const;
  bool has_row(const std::string& name) const;
  /// Texts of all elements of a kind, such as "h2".
  std::vector<std::string> texts(const std::string& element) const;
  /// All of the page's source but the pictures' bytes and the scripts that draw scenes.
  const std::string& source() const { return source_; }

 private:
  struct Element {
    std::string name, attributes, text;
  };
  std::vector<Element> elements_;
  std::string source_;
};

/// The numbers in a text, in order, "0.25 s (5 frames)" giving 0.25 and 5.
std::vector<double> numbers_in(const std::string& text);

}  // namespace apriltrack::test
