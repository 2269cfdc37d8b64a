// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/mcap_log.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "capstan/tools/log/mcap_format.hpp"
#include "capstan/tools/log/mcap_reader.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr std::size_t kMostColumns = 2000;
constexpr std::size_t kLongestArray = 64;  // longer ones are pictures or clouds, no signals
constexpr int kDeepest = 16;

/// The contract's name at the end of a path: "joint/axis0/q1_rad" has axis0/q1_rad.
auto contract_part(const std::string& path) -> std::string {
  for (std::size_t at = 0; at != std::string::npos;
       at = path.find('/', at) == std::string::npos ? std::string::npos : path.find('/', at) + 1) {
    const std::string rest = path.substr(at);
    const auto slash = rest.find('/');
    const bool axis = rest.starts_with("axis") && slash != std::string::npos && slash > 4 &&
                      std::all_of(rest.begin() + 4, rest.begin() + static_cast<std::ptrdiff_t>(slash),
                                  [](char c) { return c >= '0' && c <= '9'; });
    if (axis || rest == "temperature_C") {
      return rest;
    }
  }
  return path;
}

auto printable(std::string name) -> std::string {
  for (char& c : name) {
    c = c == ',' ? ';' : (static_cast<unsigned char>(c) < ' ' || c == '"' || c == '\x7F') ? '_' : c;
  }
  return name;
}

class Table {
 public:
  void take(const McapMessage& message) {
    if (message.channel.encoding != "json") {
      foreign_.insert(message.channel.topic + " (" + message.channel.encoding + ")");
      return;
    }
    const auto parsed = nlohmann::json::parse(message.data, nullptr, false);
    if (parsed.is_discarded()) {
      ++unreadable_;
      return;
    }
    rows_.push_back({message.time_ns, message.channel.id, {}});
    topics_.insert({message.channel.id, message.channel.topic});
    std::string topic = message.channel.topic;
    topic.erase(0, topic.find_first_not_of('/'));
    flatten(topic, parsed, 0);
    if (rows_.back().cells.empty()) {
      rows_.pop_back();
    }
  }

  [[nodiscard]] auto foreign() const -> const std::set<std::string>& { return foreign_; }
  [[nodiscard]] auto unreadable() const -> std::size_t { return unreadable_; }
  [[nodiscard]] auto empty() const -> bool { return rows_.empty(); }
  [[nodiscard]] auto too_many_columns() const -> bool { return too_many_; }
  /// Throws BadInput where a signal has two values at a time. @param name  of the file
  auto csv(const std::string& name) -> std::string;

 private:
  struct Row {
    std::uint64_t time_ns;
    std::uint16_t channel;
    std::vector<std::pair<std::size_t, double>> cells;
  };

  void flatten(const std::string& path, const nlohmann::json& value, int depth) {
    if (value.is_number() || value.is_boolean()) {
      const double number = value.is_boolean() ? static_cast<double>(value.get<bool>()) : value.get<double>();
      if (const auto column = column_of(path); column && std::isfinite(number)) {
        rows_.back().cells.emplace_back(*column, number);
      }
    } else if (value.is_object() && depth < kDeepest) {
      for (const auto& [key, member] : value.items()) {
        flatten(path + "/" + key, member, depth + 1);
      }
    } else if (value.is_array() && depth < kDeepest && value.size() <= kLongestArray) {
      for (std::size_t i = 0; i < value.size(); ++i) {
        flatten(path + "[" + std::to_string(i) + "]", value[i], depth + 1);
      }
    }
  }

  auto column_of(const std::string& path) -> std::optional<std::size_t> {
    if (const auto known = by_path_.find(path); known != by_path_.end()) {
      return known->second;
    }
    if (names_.size() == kMostColumns) {
      too_many_ = true;
      return std::nullopt;
    }
    std::string name = printable(contract_part(path));
    for (const std::string& other : {printable(path), printable(path) + "_"}) {
      name = taken_.count(name) > 0 ? other : name;
    }
    while (!taken_.insert(name).second) {
      name += '_';
    }
    names_.push_back(name);
    return by_path_[path] = names_.size() - 1;
  }

  [[noreturn]] void refuse_two(const std::string& name, const std::string& seconds, const Row& other) const;

  std::map<std::uint16_t, std::string> topics_;  // by channel
  std::vector<std::string> names_;
  std::set<std::string> taken_ = {"time_s"};
  std::map<std::string, std::size_t> by_path_;
  std::vector<Row> rows_;
  std::set<std::string> foreign_;
  std::size_t unreadable_ = 0;
  bool too_many_ = false;
};

auto seconds_text(std::uint64_t time_ns) -> std::string {
  constexpr std::uint64_t kSecond = 1'000'000'000;
  char text[48];
  std::snprintf(text, sizeof(text), "%llu.%09llu", static_cast<unsigned long long>(time_ns / kSecond),
                static_cast<unsigned long long>(time_ns % kSecond));
  return text;
}

void Table::refuse_two(const std::string& name, const std::string& seconds, const Row& other) const {
  const std::string& topic = topics_.at(other.channel);
  std::string channels;
  for (const auto& [id, same] : topics_) {
    channels += same == topic ? (channels.empty() ? "" : " and ") + std::to_string(id) : "";
  }
  if (channels.find(' ') != std::string::npos) {
    throw BadInput(name + ": the topic " + topic + " comes on several channels (" + channels +
                   "), which have messages of one time, " + seconds + " s; record each of them as a topic of its own");
  }
  throw BadInput(name + ": the topic " + topic + " has two messages of one time, " + seconds +
                 " s; give each the log time at which it was measured");
}

auto Table::csv(const std::string& name) -> std::string {
  std::stable_sort(rows_.begin(), rows_.end(), [](const Row& a, const Row& b) { return a.time_ns < b.time_ns; });
  // A clock since 1970 has no digits left for microseconds in a double; a board's own has.
  constexpr std::uint64_t kOwnClock = 100'000'000'000'000'000;  // ns, three years
  const std::uint64_t start = rows_.front().time_ns < kOwnClock ? 0 : rows_.front().time_ns;
  std::string text = "time_s," + joined(names_, ",") + "\n";
  std::vector<std::optional<double>> line(names_.size());
  for (std::size_t i = 0; i < rows_.size();) {
    const std::uint64_t time_ns = rows_[i].time_ns;
    std::fill(line.begin(), line.end(), std::nullopt);
    const auto fits = [&](const Row& row) {
      return row.time_ns == time_ns && std::none_of(row.cells.begin(), row.cells.end(),
                                                    [&](const auto& cell) { return line[cell.first].has_value(); });
    };
    do {
      for (const auto& [column, value] : rows_[i].cells) {
        line[column] = value;
      }
      ++i;
    } while (i < rows_.size() && fits(rows_[i]));
    if (i < rows_.size() && rows_[i].time_ns == time_ns) {
      refuse_two(name, seconds_text(time_ns - start), rows_[i]);
    }
    text += seconds_text(time_ns - start);
    for (const auto& value : line) {
      text += value ? "," + exact(*value) : ",";
    }
    text += '\n';
  }
  return text;
}

}  // namespace

auto is_mcap(std::string_view bytes) -> bool {
  return bytes.starts_with(mcap::kMagic);
}

auto csv_of_mcap(std::string_view bytes, const std::string& name, std::vector<std::string>& warnings) -> std::string {
  Table table;
  bool whole = false;
  try {
    whole = read_mcap(bytes, [&](const McapMessage& message) { table.take(message); });
  } catch (const McapDamaged& why) {
    throw BadInput(name + ": the MCAP file is damaged: " + why.what() + "; repair it with `mcap recover " + name +
                   " -o recovered.mcap`");
  } catch (const McapForeign& why) {
    throw BadInput(name + ": " + why.what());
  }
  if (table.empty()) {
    const std::vector<std::string> foreign(table.foreign().begin(), table.foreign().end());
    if (!whole && foreign.empty() && table.unreadable() == 0) {
      throw BadInput(name + ": the MCAP file ends before its first messages are whole, as of a recording that broke " +
                     "off; save what can be saved with `mcap recover " + name +
                     " -o recovered.mcap`, or record it again");
    }
    throw BadInput(name + ": the MCAP file has no numbers in JSON messages" +
                   (foreign.empty() ? std::string() : ", only " + joined(foreign)) +
                   "; record the topics as JSON, or open the file in PlotJuggler or Foxglove and export them as CSV");
  }
  if (!whole) {
    warnings.push_back(name + ": the MCAP file ends before its footer; what is there was read");
  }
  if (table.unreadable() > 0) {
    warnings.push_back(name + ": " + std::to_string(table.unreadable()) + " messages are no JSON and were left out");
  }
  if (!table.foreign().empty()) {
    warnings.push_back(name + ": topics in other encodings were left out: " +
                       joined({table.foreign().begin(), table.foreign().end()}));
  }
  if (table.too_many_columns()) {
    warnings.push_back(name + ": only the first " + std::to_string(kMostColumns) + " signals were read");
  }
  return table.csv(name);
}

}  // namespace capstan::tools
