// Strict reading of YAML maps: every key is expected, every complaint one sentence with file, line and key.
#pragma once

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "erard/device/error.hpp"
#include "printable.hpp"

namespace erard {

/// Letters to change, add or drop to make one word of the other (Levenshtein).
inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row[b.size()];
}

/// ", did you mean X or Y?" for the known names nearest to a wrong one; empty when none is near.
inline std::string suggest(std::string_view wrong, const std::vector<std::string>& known) {
  std::size_t nearest = 1 + wrong.size() / 3;
  std::vector<std::string> names;
  for (const std::string& name : known) {
    const std::size_t distance = edit_distance(wrong, name);
    if (distance > nearest) continue;
    if (distance < nearest) names.clear();
    nearest = distance;
    if (names.size() < 3) names.push_back(name);
  }
  return names.empty() ? "" : fmt::format(", did you mean {}?", fmt::join(names, " or "));
}

/// A map of a YAML file whose keys must all be asked for: finish() complains of the others.
class YamlSection {
 public:
  /// @param name  of the section, for complaints: "contacts JH", empty for the whole file
  YamlSection(std::string file, std::string name, const YAML::Node& node, int line)
      : file_(std::move(file)), name_(std::move(name)), node_(node), line_(line) {
    if (!node.IsMap()) reject(line, fmt::format("must be a mapping of keys to values{}", where()));
    for (const auto& entry : node) {
      const std::string key = entry.first.Scalar();
      if (!entry.first.IsScalar() || key.empty())
        reject(line_of(entry.first), fmt::format("a key must be a word{}", where()));
      if (std::find(keys_.begin(), keys_.end(), key) != keys_.end())
        reject(line_of(entry.first),
               fmt::format("{} stands twice{}, each key may stand once", printable(key), where()));
      keys_.push_back(key);
      lines_.push_back(line_of(entry.first));
    }
  }

  const std::vector<std::string>& keys() const { return keys_; }
  bool has(const std::string& key) const { return std::find(keys_.begin(), keys_.end(), key) != keys_.end(); }
  int line(const std::string& key) const {
    const auto at = std::find(keys_.begin(), keys_.end(), key);
    return at == keys_.end() ? line_ : lines_[static_cast<std::size_t>(at - keys_.begin())];
  }

  YAML::Node required(const std::string& key) {
    asked_.insert(key);
    if (!has(key)) reject_missing(key);
    return node_[key];
  }

  YamlSection section(const std::string& key) {
    const YAML::Node node = required(key);
    return {file_, name_.empty() ? key : name_ + " " + key, node, line(key)};
  }

  std::string word(const std::string& key) {
    const YAML::Node node = required(key);
    if (!node.IsScalar() || node.Scalar().empty())
      reject(line(key), fmt::format("{}{} must be a single word", key, where()));
    return node.Scalar();
  }
  /// One of the allowed words.
  std::string choice(const std::string& key, const std::vector<std::string>& allowed) {
    const std::string value = word(key);
    if (std::find(allowed.begin(), allowed.end(), value) == allowed.end())
      reject(line(key),
             fmt::format("{} = {}{}, must be one of {}", key, printable(value), where(), fmt::join(allowed, ", ")));
    return value;
  }
  std::vector<std::string> words(const std::string& key) {
    const YAML::Node node = required(key);
    if (!node.IsSequence()) reject(line(key), fmt::format("{}{} must be a list [..]", key, where()));
    std::vector<std::string> list;
    for (const YAML::Node& item : node) {
      if (!item.IsScalar()) reject(line(key), fmt::format("{}{} must be a list of single words", key, where()));
      list.push_back(item.Scalar());
    }
    return list;
  }

  /// Complains of keys that nobody asked for.
  void finish() const {
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      if (asked_.contains(keys_[i])) continue;
      const std::vector<std::string> known(asked_.begin(), asked_.end());
      reject(lines_[i], fmt::format("key {} is not known{}{}", printable(keys_[i]), where(), suggest(keys_[i], known)));
    }
  }
  /// Names a key that may be absent, so that finish() and suggestions know it.
  bool optional(const std::string& key) {
    asked_.insert(key);
    return has(key);
  }

  [[noreturn]] void reject(int line, std::string_view complaint) const {
    throw InputError(fmt::format("{}:{}: {}", file_, line, complaint));
  }
  std::string where() const { return name_.empty() ? "" : " in " + name_; }

 private:
  /// A key that is not there may be there misspelt.
  [[noreturn]] void reject_missing(const std::string& key) const {
    for (std::size_t i = 0; i < keys_.size(); ++i)
      if (!asked_.contains(keys_[i]) && edit_distance(key, keys_[i]) <= 1 + key.size() / 4)
        reject(lines_[i], fmt::format("key {} is not known{}, did you mean {}?", printable(keys_[i]), where(), key));
    reject(line_, fmt::format("key {} is missing{}", key, where()));
  }

  static int line_of(const YAML::Node& node) { return node.Mark().line + 1; }

  std::string file_, name_;
  YAML::Node node_;
  int line_;
  std::vector<std::string> keys_;
  std::vector<int> lines_;
  std::set<std::string> asked_;
};

}  // namespace erard
