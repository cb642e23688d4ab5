// Pages are read by two parsers of Python's library, one of them a strict XML parser (read_page.py).
#include "apriltrack/report/html_page.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <sstream>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "html_text.h"
#include "page_elements.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

using test::elements_of;
using testing::Contains;
using testing::HasSubstr;
using testing::IsSupersetOf;

const std::string kNasty = "a < b & c > \"d\" 'e' </p><script>&amp;";

std::string all_bytes() {
  std::string bytes;
  for (int i = 0; i < 256 * 4 + 1; ++i) bytes += static_cast<char>(i * 7 % 256);
  return bytes;
}

TEST(HtmlPage, TextIsShownAsItIs) {
  HtmlPage page(kNasty);
  page.heading(kNasty + "h");
  page.paragraph(kNasty + "p");
  page.code("one <two>\n  three");
  page.table({{kNasty + "1"}, {{kNasty + "2"}}, kNasty + "3"});
  EXPECT_THAT(elements_of(page),
              IsSupersetOf({"title||" + kNasty, "h1||" + kNasty, "h2||" + kNasty + "h", "p||" + kNasty + "p",
                            std::string(R"(code||one <two>\n  three)"), "th|scope=col|" + kNasty + "1",
                            "th|scope=row|" + kNasty + "2", "caption||" + kNasty + "3"}));
}

TEST(HtmlPage, WhatIsNoTextDoesNotBreakThePage) {
  HtmlPage page("title");
  // Control characters, a lone byte, a cut sequence, an overlong one, half a surrogate pair; and good text.
  page.paragraph(std::string("a\x01\x1F") + "b\xFF" + "c\xE2\x82");
  page.paragraph("d\xC0\xAF e\xED\xA0\x80");
  page.paragraph("\xC3\xA9 \xE2\x82\xAC \xF0\x9F\x98\x80");
  const auto lines = elements_of(page);
  EXPECT_THAT(lines, Contains(R"(p||a\ufffd\ufffdb\ufffdc\ufffd\ufffd)"));
  EXPECT_THAT(lines, Contains(R"(p||d\ufffd\ufffd e\ufffd)"));
  EXPECT_THAT(lines, Contains(R"(p||\xe9 \u20ac \U0001f600)"));
}

TEST(HtmlPage, PicturesAndVideosAreInside) {
  const auto folder = test::temporary_folder();
  const std::string png = "\x89PNG\r\n\x1A\n" + all_bytes();
  const std::string mp4 = std::string("\0\0\0\x20", 4) + "ftypisom" + all_bytes();
  write_file_atomically(folder / "a.png", png);
  write_file_atomically(folder / "b.mp4", mp4);
  HtmlPage page("title");
  page.picture(folder / "a.png", "a \"picture\"");
  page.video(folder / "b.mp4", "a video");
  std::filesystem::remove(folder / "a.png");
  const auto lines = elements_of(page, folder);
  EXPECT_THAT(lines, Contains("img|alt=a \"picture\" src=data:image/png;base64|"));
  EXPECT_THAT(lines, Contains("figcaption||a \"picture\""));
  EXPECT_THAT(lines, Contains(testing::AllOf(testing::StartsWith("video|controls=controls"),
                                             HasSubstr("src=data:video/mp4;base64"))));
  EXPECT_EQ(read_file(folder / "data_img"), png);
  EXPECT_EQ(read_file(folder / "data_video"), mp4);
}

TEST(HtmlPage, ColumnsOfNumbersAreFlushRight) {
  HtmlPage page("title");
  page.table({{"run", "error", "words"},
              {{"1", "0.5 px", "1"}, {"2", "-", "two"}, {"3", "< 0.1 px", "3"}, {"4", "- (2/9)", ""}},
              ""});
  const auto lines = elements_of(page);
  EXPECT_THAT(lines,
              IsSupersetOf({"th|scope=col|run", "th|scope=col class=number|error", "th|scope=col|words",
                            "th|scope=row|1", "td|class=number|0.5 px", "td|class=number|- (2/9)",
                            "td|class=number|-", "td|class=number|< 0.1 px", "td||1", "td||two"}));
}

TEST(HtmlPage, AnEmptyPageIsAPage) {
  const auto lines = elements_of(HtmlPage("only a title"));
  EXPECT_THAT(lines, Contains("h1||only a title"));
  EXPECT_THAT(lines, Contains("meta|charset=utf-8|"));
  EXPECT_THAT(lines, Contains("meta|name=viewport content=width=device-width, initial-scale=1|"));
}

TEST(HtmlPage, FilesOfOtherKindsAreRefused) {
  const auto folder = test::temporary_folder();
  write_file_atomically(folder / "words.png", "no picture");
  write_file_atomically(folder / "words.mp4", "");
  HtmlPage page("title");
  const auto expect_error = [&](auto act, ErrorKind kind, const std::string& part) {
    try {
      act();
      FAIL() << "no error that says " << part;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), kind);
      EXPECT_THAT(error.what(), HasSubstr(part));
    }
  };
  expect_error([&] { page.picture(folder / "words.png", ""); }, ErrorKind::kInvalidInput,
               "words.png: is no PNG");
  expect_error([&] { page.video(folder / "words.mp4", ""); }, ErrorKind::kInvalidInput,
               "words.mp4: is no MP4");
  expect_error([&] { page.picture(folder / "none.png", ""); }, ErrorKind::kIo, "none.png");
  expect_error([&] { page.video(folder / "none.mp4", ""); }, ErrorKind::kIo, "none.mp4");
  expect_error([&] { write_html_page(folder / "missing" / "x.html", page); }, ErrorKind::kIo,
               "missing/x.html");
  EXPECT_THAT(elements_of(page), testing::Not(Contains(testing::StartsWith("figure"))))
      << "nothing half added";
}

TEST(HtmlPage, RaggedTablesAreMisuse) {
  HtmlPage page("title");
  EXPECT_THROW(page.table({{"a", "b"}, {{"1"}}, ""}), MisuseError);
  EXPECT_THROW(page.table({{}, {}, ""}), MisuseError);
}

}  // namespace
}  // namespace apriltrack
