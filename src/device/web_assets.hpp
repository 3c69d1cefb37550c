// The files of web/ and third_party/uplot, put into the library when it is built (cmake/embed_text.cmake).
#pragma once

#include <string_view>

namespace erard {

/// Text of an embedded file by its name without folder, for instance "report.html"; empty when there is none.
std::string_view web_asset(std::string_view name);

}  // namespace erard
