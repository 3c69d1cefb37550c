#include "bench/markdown_block.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "erard/device/error.hpp"
#include "erard/device/output_file.hpp"

namespace erard::bench {
namespace {

/// Where `line` stands in the text; npos unless exactly once.
std::size_t only_place(const std::string& text, const std::string& line) {
  const std::size_t place = text.find(line);
  return place == std::string::npos || text.find(line, place + 1) != std::string::npos ? std::string::npos : place;
}

}  // namespace

MarkdownBlock::MarkdownBlock(std::filesystem::path file, const std::string& name) : file_(std::move(file)) {
  const std::string begin = fmt::format("<!-- {}: written by the program, do not edit -->\n", name);
  const std::string end = fmt::format("<!-- end of {} -->\n", name);
  OutputFile probe(file_);  // throws now rather than after minutes of measuring
  before_ = begin;
  after_ = end;
  if (!std::filesystem::exists(file_)) return;
  std::ifstream in(file_, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::size_t first = only_place(text, begin), last = only_place(text, end);
  if (first == std::string::npos || last == std::string::npos || last < first)
    throw InputError(fmt::format("{}: has no place for the tables, must have the lines \"{}\" and \"{}\" once each",
                                 file_.string(), begin.substr(0, begin.size() - 1), end.substr(0, end.size() - 1)));
  before_ = text.substr(0, first + begin.size());
  after_ = text.substr(last);
}

void MarkdownBlock::replace(const std::string& text) const {
  OutputFile file(file_);
  file.write(before_ + text + after_);
  file.commit();
}

}  // namespace erard::bench
