// CSV tables from files nobody vouches for: bounded in size, exact in number, every complaint one sentence with its place.
#pragma once

#ifndef CSV_IO_NO_THREAD
#define CSV_IO_NO_THREAD  // the files are short: no reader thread
#endif

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wstringop-truncation"  // the library cuts long file names, which nobody reads here
#endif
#include <libfccp/csv.h>
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif

#include "erard/device/error.hpp"
#include "printable.hpp"

namespace erard::csv {

inline constexpr long long kMaxBytes = 64LL << 20;  // over two hours at 1 kHz; a pipe without end stops here
inline constexpr int kMaxLineLength = 4000;         // a row of a trajectory needs 800, a licence line 120

/// Throws InputError "file: complaint".
[[noreturn]] inline void reject(const std::filesystem::path& file, std::string_view complaint) {
  throw InputError(fmt::format("{}: {}", printable(file.string(), 4096), complaint));
}

/// Throws InputError "file:line: complaint".
[[noreturn]] inline void reject(const std::filesystem::path& file, unsigned line, std::string_view complaint) {
  throw InputError(fmt::format("{}:{}: {}", printable(file.string(), 4096), line, complaint));
}

/// Bytes of a file, checked before any of them is parsed: text only, short lines, an end within kMaxBytes.
class CheckedBytes final : public io::ByteSourceBase {
 public:
  explicit CheckedBytes(std::filesystem::path file) : file_(std::move(file)) {
    std::error_code ignored;  // an unreadable place is told by fopen below
    if (std::filesystem::is_directory(file_, ignored)) reject(file_, "is a folder, must be a CSV file");
    stream_.reset(std::fopen(file_.c_str(), "rb"));
    if (!stream_) reject(file_, fmt::format("cannot be read: {}", std::strerror(errno)));
  }

  int read(char* buffer, int size) override {
    const std::size_t count = std::fread(buffer, 1, static_cast<std::size_t>(size), stream_.get());
    if (std::ferror(stream_.get()) != 0) reject(file_, line_, "cannot be read on from here");
    for (std::size_t i = 0; i < count; ++i) check(static_cast<unsigned char>(buffer[i]));
    return static_cast<int>(count);
  }

 private:
  void check(unsigned char byte) {
    if (++bytes_ > kMaxBytes)
      reject(file_, line_, fmt::format("the file does not end, must be at most {} MiB", kMaxBytes >> 20));
    if (byte == '\n') {
      ++line_;
      length_ = 0;
    } else if (++length_ > kMaxLineLength) {
      reject(file_, line_, fmt::format("the line does not end, must have at most {} characters", kMaxLineLength));
    } else if ((byte < 0x20 && byte != '\t' && byte != '\r') || byte == 0x7f) {
      reject(file_, line_, fmt::format("byte 0x{:02x} is not text, must be a CSV file", byte));
    }
  }

  struct Close {
    void operator()(std::FILE* stream) const noexcept { std::fclose(stream); }
  };

  std::filesystem::path file_;
  std::unique_ptr<std::FILE, Close> stream_;
  long long bytes_ = 0;
  unsigned line_ = 1;
  int length_ = 0;
};

/// What becomes of columns that are not known.
enum class OtherColumns { rejected, ignored };

/// A CSV file with a header that names some of N known columns, in any order. `#` starts a comment line; blank lines,
/// CRLF and a UTF-8 byte order mark are read over. Every complaint is an InputError.
template <std::size_t N>
class Table {
 public:
  /// @param columns  names the header may use
  /// @param rule     what the header must name, as the end of a complaint
  Table(std::filesystem::path file, const std::array<const char*, N>& columns, std::string rule,
        OtherColumns others = OtherColumns::rejected)
      : file_(std::move(file)),
        columns_(columns),
        rule_(std::move(rule)),
        reader_(file_.string(), std::unique_ptr<io::ByteSourceBase>(new CheckedBytes(file_))) {
    const io::ignore_column others_too = io::ignore_missing_column | io::ignore_extra_column;
    read_header(others == OtherColumns::ignored ? others_too : io::ignore_missing_column,
                std::make_index_sequence<N>{});
  }

  bool has(std::size_t column) const { return reader_.has_column(columns_[column]); }

  /// Reads the next row; the numbers of columns the header does not name stay as they are.
  bool next(std::array<double, N>& row) { return next_row(row, std::make_index_sequence<N>{}); }

  /// Complaint about the whole header, or about the row just read.
  [[noreturn]] void reject_header(std::string_view complaint) {
    reject(file_, reader_.get_file_line(), fmt::format("{}, {}", complaint, rule_));
  }
  [[noreturn]] void reject_row(std::string_view complaint) { reject(file_, reader_.get_file_line(), complaint); }

 private:
  template <std::size_t... I>
  void read_header(io::ignore_column policy, std::index_sequence<I...>) try {
    reader_.read_header(policy, columns_[I]...);
  } catch (const io::error::header_missing&) {
    reject(file_, reader_.get_file_line() + 1, fmt::format("the file ends without a header, {}", rule_));
  } catch (const io::error::extra_column_in_header& error) {
    reject_header(fmt::format("header column \"{}\" is not known", printable(error.column_name)));
  } catch (const io::error::duplicated_column_in_header& error) {
    reject_header(fmt::format("header column \"{}\" stands twice", printable(error.column_name)));
  }

  template <std::size_t... I>
  bool next_row(std::array<double, N>& row, std::index_sequence<I...>) try {
    std::array<const char*, N> text{};
    if (!reader_.read_row(text[I]...)) return false;
    for (std::size_t i = 0; i < N; ++i)
      if (text[i] != nullptr) row[i] = parse(columns_[i], text[i]);
    return true;
  } catch (const io::error::too_few_columns&) {
    reject_row("the row has fewer values than the header has columns, must have one for each");
  } catch (const io::error::too_many_columns&) {
    reject_row("the row has more values than the header has columns, must have one for each");
  }

  // The library's own conversion is a few bits off and takes an empty cell for 0.
  double parse(const char* column, std::string_view text) {
    std::string_view digits = text;
    if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
    double value = 0;
    const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (failure != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value))
      reject_row(fmt::format("{} = \"{}\", must be a finite number", column, printable(text)));
    return value;
  }

  using Reader = io::CSVReader<static_cast<unsigned>(N), io::trim_chars<' ', '\t'>, io::no_quote_escape<','>,
                               io::throw_on_overflow, io::single_and_empty_line_comment<'#'>>;

  std::filesystem::path file_;
  std::array<const char*, N> columns_;
  std::string rule_;
  Reader reader_;
};

}  // namespace erard::csv
