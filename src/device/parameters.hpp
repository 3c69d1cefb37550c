// The named numbers of an action file and the rules they are held to.
#pragma once

#include <charconv>
#include <cmath>
#include <map>

#include "erard/device/action_file.hpp"
#include "yaml_section.hpp"

namespace erard {

enum class Rule { any, positive, not_negative, at_least_one, zero_to_one };

class Parameters {
 public:
  Parameters(std::string file, YamlSection& section, const std::vector<Setting>& settings) : file_(std::move(file)) {
    for (const std::string& name : section.keys()) list_.push_back(read(section, name));
    std::vector<std::string> names;
    for (std::size_t i = 0; i < list_.size(); ++i) {
      place_[list_[i].name] = i;
      names.push_back(list_[i].name);
    }
    for (const Setting& setting : settings) {
      const auto at = place_.find(setting.name);
      if (at == place_.end())
        throw InputError(fmt::format("--set {}={}: {} has no parameter of this name{}", printable(setting.name),
                                     setting.value, file_, suggest(setting.name, names)));
      if (!std::isfinite(setting.value))
        throw InputError(fmt::format("--set {}={}: must be a finite number", setting.name, setting.value));
      list_[at->second].value = setting.value;
      list_[at->second].line = 0;
    }
    is_used_.assign(list_.size(), false);
  }

  /// The number that a key of the mechanism names, in the unit and within the rule that the key asks for.
  double get(const YamlSection& section, const std::string& key, const std::string& name, std::string_view unit,
             Rule rule) {
    const auto at = place_.find(name);
    if (at == place_.end())
      section.reject(section.line(key), fmt::format("{} = {}{}, must name a parameter{}", key, printable(name),
                                                    section.where(), suggest(name, section_names())));
    const Parameter& p = list_[at->second];
    is_used_[at->second] = true;
    if (p.unit != unit)
      reject(p, fmt::format("has the unit {}, must have {} to be the {}{}", p.unit, unit, key, section.where()));
    check(p, rule);
    return p.value;
  }

  /// Complains of the first parameter that the mechanism does not use: it would silently do nothing.
  void finish() const {
    for (std::size_t i = 0; i < list_.size(); ++i)
      if (!is_used_[i]) reject(list_[i], "is used nowhere in the mechanism, remove it or name it there");
  }

  /// "file:line: NAME = value unit, rule", or "--set NAME=value: rule".
  [[noreturn]] void reject(const Parameter& p, std::string_view rule) const {
    if (p.line == 0) throw InputError(fmt::format("--set {}={}: {}", p.name, p.value, rule));
    throw InputError(fmt::format("{}:{}: {} = {} {}, {}", file_, p.line, p.name, p.value, p.unit, rule));
  }
  [[noreturn]] void reject(const std::string& name, std::string_view rule) const {
    reject(list_[place_.at(name)], rule);
  }

  const std::vector<Parameter>& list() const { return list_; }

 private:
  Parameter read(YamlSection& section, const std::string& name) {
    YamlSection entry = section.section(name);
    Parameter p{name, 0, "", "", section.line(name)};
    const YAML::Node value = entry.required("value");
    const std::string text = value.IsScalar() ? value.Scalar() : "(not a number)";
    const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
    const char* end = text.data() + text.size();
    const auto [stop, failure] = std::from_chars(begin, end, p.value);
    if (failure != std::errc{} || stop != end || !std::isfinite(p.value))
      entry.reject(p.line, fmt::format("{} = {}, must be a finite number", name, printable(text)));
    p.unit = entry.word("unit");
    p.source = entry.word("source");
    entry.finish();
    return p;
  }

  void check(const Parameter& p, Rule rule) const {
    if (rule == Rule::positive && !(p.value > 0)) reject(p, "must be > 0");
    if (rule == Rule::not_negative && !(p.value >= 0)) reject(p, "must be >= 0");
    if (rule == Rule::at_least_one && !(p.value >= 1)) reject(p, "must be >= 1");
    if (rule == Rule::zero_to_one && !(p.value >= 0 && p.value <= 1)) reject(p, "must be 0 to 1");
  }

  std::vector<std::string> section_names() const {
    std::vector<std::string> names;
    for (const Parameter& p : list_) names.push_back(p.name);
    return names;
  }

  std::string file_;
  std::vector<Parameter> list_;
  std::map<std::string, std::size_t> place_;
  std::vector<bool> is_used_;
};

}  // namespace erard
