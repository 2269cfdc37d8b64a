// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/python/words.hpp"

#include <algorithm>
#include <regex>

namespace capstan::python {
namespace {

/// The text with each match replaced by what `word` makes of it.
template <typename Word>
auto replaced(const std::string& text, const std::regex& pattern, const Word& word) -> std::string {
  std::string result;
  auto rest = text.begin();
  for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match) {
    result.append(rest, (*match)[0].first).append(word(*match));
    rest = (*match)[0].second;
  }
  return result.append(rest, text.end());
}

auto argument_of(const std::smatch& match) -> std::string {
  enum : std::size_t { kQuoted = 1, kQuotedIs, kBlamed, kBlamedIs, kPlain, kPlainIs, kAxis, kName, kValue, kOption };
  for (const std::size_t mapping : {kQuoted, kBlamed, kPlain}) {
    if (match[mapping].matched) {
      return "map={\"" + match.str(mapping) + "\": \"" + match.str(mapping + 1) + "\"}";
    }
  }
  if (match[kAxis].matched) {
    return "coupled_to=[" + match.str(kAxis) + "]";
  }
  if (match[kName].matched) {
    return match.str(kName) + "=\"" + match.str(kValue) + "\"";
  }
  std::string option = match.str(kOption);
  std::replace(option.begin(), option.end(), '-', '_');
  return option;
}

/// Lines count the header and from 1.
auto row_of(const std::string& line) -> std::string {
  return "row " + std::to_string(std::stol(line) - 2);
}

}  // namespace

auto in_python(const std::string& sentence) -> std::string {
  // A mapping stands in quotes, before the fault that it has, or plain; what an option gets is never "out" ("leave
  // --target out").
  static const std::regex kOption(
      R"re(--map "([^"=]+)=([^"]*)"|--map ([^ "=]+)=([^:;"]*)(?=: )|)re"
      R"re(--map ([^ "=]+)=([^ ,;:")]+)|--coupled-to (\d+)|)re"
      R"re(--(target|model|base|arithmetic) (?!out\b)([\w/]+)|--(map|target|model|base|test|coupled-to)\b)re");
  static const std::regex kHeader(std::string(kArrays) + ":1: ");
  static const std::regex kLine("(" + std::string(kArrays) + ":|\\bline )(\\d{1,9})\\b");
  std::string text = replaced(sentence, kOption, argument_of);
  if (text.find(kArrays) == std::string::npos) {
    return text;
  }
  text = std::regex_replace(text, kHeader, std::string(kArrays) + ": ");
  return replaced(text, kLine, [](const std::smatch& match) {
    return (match.str(1) == "line " ? "" : std::string(kArrays) + ", ") + row_of(match.str(2));
  });
}

}  // namespace capstan::python
