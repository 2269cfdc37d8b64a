// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/console_server/foxglove.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace capstan::tools {
namespace {

using nlohmann::json;

template <class Unsigned>
void append_little_endian(std::string& bytes, Unsigned value) {
  for (std::size_t i = 0; i < sizeof value; ++i) {
    bytes += static_cast<char>((value >> (8U * i)) & 0xFFU);
  }
}

auto status(const std::string& sentence) -> std::string {
  constexpr int kWarning = 1;
  return json{{"op", "status"}, {"level", kWarning}, {"message", sentence}}.dump();
}

}  // namespace

FoxgloveFeed::FoxgloveFeed(Hub& hub)
    : hub_(hub), recorder_(std::make_unique<FrameRecorder>(static_cast<LogSink&>(*this))) {
  hub_.overhear = [this](std::string_view bytes) { hear(bytes); };
}

void FoxgloveFeed::hear(std::string_view bytes) {
  static_cast<void>(recorder_->feed(bytes));
  if (recorder_->foreign() > 0) {  // the board sends other signals now, or has started anew
    forget();
    recorder_ = std::make_unique<FrameRecorder>(static_cast<LogSink&>(*this));
  }
}

void FoxgloveFeed::forget() {
  json ids = json::array();
  for (const Topic& topic : topics_) {
    ids.push_back(topic.id);
  }
  topics_.clear();
  for (auto& [guest, subscriptions] : listeners_) {
    subscriptions.clear();
    guest->say(json{{"op", "unadvertise"}, {"channelIds", ids}}.dump());
  }
}

void FoxgloveFeed::begin(const std::vector<std::string>& columns) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::size_t slash = columns[i].find('/');
    const bool alone = slash == std::string::npos;
    const std::string name = alone ? "log" : columns[i].substr(0, slash);
    auto topic = std::find_if(topics_.begin(), topics_.end(), [&](const Topic& one) { return one.name == name; });
    if (topic == topics_.end()) {
      topic = topics_.insert(topics_.end(), Topic{next_id_++, name, {}});
    }
    topic->fields.emplace_back(alone ? columns[i] : columns[i].substr(slash + 1), i);
  }
  epoch_ns_ = 0;
  for (const auto& [guest, subscriptions] : listeners_) {
    guest->say(advertisement());
  }
}

auto FoxgloveFeed::advertisement() const -> std::string {
  json channels = json::array();
  for (const Topic& topic : topics_) {
    json schema = {{"type", "object"}, {"properties", json::object()}};
    for (const auto& [field, column] : topic.fields) {
      schema["properties"][field] = {{"type", "number"}};
    }
    channels.push_back({{"id", topic.id},
                        {"topic", topic.name},
                        {"encoding", "json"},
                        {"schemaName", "capstan." + topic.name},
                        {"schemaEncoding", "jsonschema"},
                        {"schema", schema.dump()}});
  }
  return json{{"op", "advertise"}, {"channels", channels}}.dump();
}

void FoxgloveFeed::row(std::int64_t time_ms, const std::vector<std::string>& values) {
  constexpr std::int64_t kMillisecond = 1'000'000;
  heard_ = Hub::Clock::now();
  if (epoch_ns_ == 0) {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    epoch_ns_ = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count() - time_ms * kMillisecond;
  }
  for (const Topic& topic : topics_) {
    std::string message;
    for (const auto& [field, column] : topic.fields) {
      message += message.empty() ? "{" : ",";
      message += json(field).dump() + ":" + values[column];
    }
    message += "}";
    for (const auto& [guest, subscriptions] : listeners_) {
      for (const auto& [subscription, id] : subscriptions) {
        if (id == topic.id) {
          std::string frame("\x01", 1);  // message data
          append_little_endian(frame, subscription);
          append_little_endian(frame, static_cast<std::uint64_t>(epoch_ns_ + time_ms * kMillisecond));
          guest->bytes(frame + message);
        }
      }
    }
  }
}

void FoxgloveFeed::join(Guest& guest, Hub::Clock::time_point /*now*/) {
  listeners_[&guest];
  guest.say(json{{"op", "serverInfo"}, {"name", "capstan console"}, {"capabilities", json::array()}}.dump());
  guest.say(advertisement());
}

void FoxgloveFeed::leave(Guest& guest) {
  listeners_.erase(&guest);
}

void FoxgloveFeed::word(Guest& guest, std::string_view text, Hub::Clock::time_point /*now*/) {
  const json wish = json::parse(text, nullptr, false);
  const auto listener = listeners_.find(&guest);
  if (!wish.is_object() || listener == listeners_.end()) {
    guest.say(status("this is not a message of Foxglove's protocol; connect with foxglove.websocket.v1"));
    return;
  }
  try {
    const std::string kind = wish.value("op", "");
    if (kind == "subscribe") {
      for (const json& one : wish.at("subscriptions")) {
        listener->second[one.at("id").get<std::uint32_t>()] = one.at("channelId").get<std::uint32_t>();
      }
    } else if (kind == "unsubscribe") {
      for (const json& id : wish.at("subscriptionIds")) {
        listener->second.erase(id.get<std::uint32_t>());
      }
    } else {
      guest.say(
          status("'" + kind + "' is not served here: this line only shows signals; command from the console page"));
    }
  } catch (const json::exception&) {
    guest.say(status("a message of Foxglove's protocol is incomplete; send ids as numbers"));
  }
}

void FoxgloveFeed::bytes(Guest& guest, std::string_view /*bytes*/) {
  guest.say(status("this line only shows signals; command from the console page"));
}

void FoxgloveFeed::look(Hub::Clock::time_point now) {
  constexpr std::chrono::seconds kQuiet{1};
  if (!listeners_.empty() && now - heard_ > kQuiet) {
    heard_ = now;
    hub_.send_unattended("frames 10 joint0.reference joint0.q2 joint0.q1 joint0.torque\n");
  }
}

}  // namespace capstan::tools
