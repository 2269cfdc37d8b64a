// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/telemetry/log_sink.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "capstan/tools/log/mcap_writer.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

class CsvSink final : public LogSink {
 public:
  explicit CsvSink(std::ostream& out) : out_(out) {}

  void begin(const std::vector<std::string>& columns) override {
    out_ << "time_s";
    for (const auto& column : columns) {
      out_ << ',' << column;
    }
    out_ << '\n';
  }
  void row(std::int64_t time_ms, const std::vector<std::string>& values) override {
    constexpr std::int64_t kFlushEveryMs = 1000;
    char time[32];
    std::snprintf(time, sizeof(time), "%lld.%03lld", static_cast<long long>(time_ms / 1000),
                  static_cast<long long>(time_ms % 1000));
    out_ << time;
    for (const auto& value : values) {
      out_ << ',' << value;
    }
    out_ << '\n';
    if (!flushed_ms_ || time_ms - *flushed_ms_ >= kFlushEveryMs) {  // whoever is killed loses no more
      out_.flush();
      flushed_ms_ = time_ms;
    }
  }
  void end() override { out_.flush(); }

 private:
  std::ostream& out_;
  std::optional<std::int64_t> flushed_ms_;
};

class McapSink final : public LogSink {
 public:
  explicit McapSink(std::ostream& out) : writer_(out) {}

  void begin(const std::vector<std::string>& columns) override {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const auto slash = columns[i].find('/');
      const bool alone = slash == std::string::npos;
      const std::string name = alone ? "log" : columns[i].substr(0, slash);
      auto topic = std::find_if(topics_.begin(), topics_.end(), [&](const Topic& t) { return t.name == name; });
      if (topic == topics_.end()) {
        topic = topics_.insert(topics_.end(), Topic{name, 0, {}});
      }
      topic->fields.emplace_back(alone ? columns[i] : columns[i].substr(slash + 1), i);
    }
    for (Topic& topic : topics_) {
      nlohmann::json schema = {{"type", "object"}, {"properties", nlohmann::json::object()}};
      for (const auto& [field, column] : topic.fields) {
        schema["properties"][field] = {{"type", "number"}};
      }
      topic.channel = writer_.add_channel(topic.name, "capstan." + topic.name, schema.dump());
    }
  }
  void row(std::int64_t time_ms, const std::vector<std::string>& values) override {
    constexpr std::uint64_t kMillisecond = 1'000'000;
    for (const Topic& topic : topics_) {
      std::string message;
      for (const auto& [field, column] : topic.fields) {
        message += message.empty() ? "{" : ",";
        message += nlohmann::json(field).dump() + ":" + values[column];
      }
      writer_.add_message(topic.channel, static_cast<std::uint64_t>(time_ms) * kMillisecond, message + "}");
    }
  }
  void end() override { writer_.finish(); }

 private:
  struct Topic {
    std::string name;
    std::uint16_t channel = 0;
    std::vector<std::pair<std::string, std::size_t>> fields;  // name in the message, column
  };
  McapWriter writer_;
  std::vector<Topic> topics_;
};

class FileSink final : public LogSink {
 public:
  explicit FileSink(std::string path) : path_(std::move(path)) {
    expect_writable(path_);
    std::error_code none;
    if (std::filesystem::exists(path_, none) && !std::filesystem::is_regular_file(path_, none)) {
      open();  // nothing is lost in it, and whoever waits at the other end of a pipe is to see its end
    }
  }

  void begin(const std::vector<std::string>& columns) override {
    columns_ = columns;
    if (log_ != nullptr) {
      log_->begin(columns_);
    }
  }
  void row(std::int64_t time_ms, const std::vector<std::string>& values) override {
    if (log_ == nullptr) {
      open();
      log_->begin(columns_);
    }
    log_->row(time_ms, values);
    if (!file_) {
      finish_writing(file_, path_);  // throws: nobody records for hours what the disk does not take
    }
  }
  void end() override {
    if (log_ != nullptr) {
      log_->end();
      finish_writing(file_, path_);
    }
  }

 private:
  void open() {
    file_ = open_to_write(path_);
    log_ = path_.ends_with(".mcap") ? mcap_sink(file_) : csv_sink(file_);
  }

  std::string path_;
  std::vector<std::string> columns_;
  std::ofstream file_;
  std::unique_ptr<LogSink> log_;
};

}  // namespace

auto csv_sink(std::ostream& out) -> std::unique_ptr<LogSink> {
  return std::make_unique<CsvSink>(out);
}

auto mcap_sink(std::ostream& out) -> std::unique_ptr<LogSink> {
  return std::make_unique<McapSink>(out);
}

auto file_sink(const std::string& path) -> std::unique_ptr<LogSink> {
  return std::make_unique<FileSink>(path);
}

}  // namespace capstan::tools
