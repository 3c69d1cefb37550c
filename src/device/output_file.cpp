#include "erard/device/output_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "erard/device/error.hpp"

namespace erard {
namespace {

std::filesystem::path part_of(const std::filesystem::path& path) {
  std::filesystem::path part = path;
  part += ".part";
  return part;
}

}  // namespace

void prepare_output_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  std::error_code also;
  if (!std::filesystem::is_directory(folder, also))
    throw InputError(fmt::format("{}: cannot be used as output folder ({}); name a folder that can be written",
                                 folder.string(),
                                 error  ? error.message()
                                 : also ? also.message()
                                        : "it is not a folder"));
  OutputFile probe(folder / "probe");  // not committed: leaves nothing
}

OutputFile::OutputFile(std::filesystem::path path) : path_(std::move(path)), part_(part_of(path_)) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path_, ignored))
    throw InputError(fmt::format("{}: is a folder, must be a file", path_.string()));
  errno = 0;
  stream_.open(part_, std::ios::binary | std::ios::trunc);
  if (!stream_)
    throw InputError(fmt::format("{}: cannot be written ({}); name a place that can", path_.string(),
                                 errno != 0 ? std::strerror(errno) : "unknown reason"));
}

OutputFile::~OutputFile() {
  if (is_committed_) return;
  stream_.close();
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
}

void OutputFile::close() {
  stream_.close();
  if (!stream_) throw std::runtime_error(fmt::format("{}: not written whole, is the disk full?", path_.string()));
}

void OutputFile::publish() {
  std::filesystem::rename(part_, path_);
  is_committed_ = true;
}

void commit_together(std::initializer_list<OutputFile*> files) {
  for (OutputFile* file : files) file->close();
  for (OutputFile* file : files) file->publish();
}

}  // namespace erard
