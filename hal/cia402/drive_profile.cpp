// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402/drive_profile.hpp"

#include <algorithm>
#include <charconv>
#include <stdexcept>

namespace capstan::cia402 {
namespace {

constexpr std::string_view kBlanks = " \t\r";

auto trimmed(std::string_view text) -> std::string_view {
  const std::size_t first = text.find_first_not_of(kBlanks);
  return first == std::string_view::npos ? "" : text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

auto words_of(std::string_view text) -> std::vector<std::string_view> {
  std::vector<std::string_view> words;
  for (text = trimmed(text); !text.empty();) {
    const std::size_t end = std::min(text.find_first_of(kBlanks), text.size());
    words.push_back(text.substr(0, end));
    text = trimmed(text.substr(end));
  }
  return words;
}

auto whole(std::string_view text, int base, std::uint32_t& value) -> bool {
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  return problem == std::errc{} && end == text.data() + text.size();
}

/// One line of a profile, and how to complain about it.
class Line {
 public:
  Line(std::string_view text, std::string place) : place_(std::move(place)) {
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos) {
      refuse("has no '='", "write KEY = VALUE");
    }
    key_ = words_of(text.substr(0, equals));
    value_ = trimmed(text.substr(equals + 1));
    if (key_.empty() || value_.empty()) {
      refuse("lacks its key or its value", "write KEY = VALUE");
    }
  }

  [[noreturn]] void refuse(const std::string& what, const std::string& cure) const {
    throw std::runtime_error(place_ + ' ' + what + "; " + cure);
  }
  [[nodiscard]] auto key() const -> std::string_view { return key_[0]; }
  [[nodiscard]] auto text() const -> std::string { return std::string(value_); }

  [[nodiscard]] auto number(std::string_view text, std::uint32_t lowest, std::uint32_t highest) const -> std::uint32_t {
    std::uint32_t value = 0;
    const bool hex = text.starts_with("0x");
    if (!whole(hex ? text.substr(2) : text, hex ? 16 : 10, value) || value < lowest || value > highest) {
      refuse("has '" + std::string(text) + "' where a number is expected",
             "give one from " + std::to_string(lowest) + " to " + std::to_string(highest) + ", in hexadecimal with 0x");
    }
    return value;
  }
  [[nodiscard]] auto number(std::uint32_t lowest, std::uint32_t highest) const -> std::uint32_t {
    return number(value_, lowest, highest);
  }
  /// "6007:00", and its length in bytes if there is another word.
  [[nodiscard]] auto object(std::span<const std::string_view> words) const -> Object {
    constexpr std::size_t kIndexDigits = 4;
    constexpr std::size_t kDigits = 7;
    std::uint32_t index = 0;
    std::uint32_t subindex = 0;
    if (words.empty() || words[0].size() != kDigits || words[0][kIndexDigits] != ':' ||
        !whole(words[0].substr(0, kIndexDigits), 16, index) ||
        !whole(words[0].substr(kIndexDigits + 1), 16, subindex)) {
      refuse("names no object", "write index and subindex in hexadecimal, as in 6007:00");
    }
    const std::uint32_t bytes = words.size() > 1 ? number(words[1], 1, 4) : 0;
    return {static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(subindex), static_cast<std::uint8_t>(bytes),
            "object named in the drive's profile"};
  }
  [[nodiscard]] auto values(bool with_length) const -> DriveProfile::Values {
    DriveProfile::Values entry{object(std::span(key_).subspan(1)), {}};
    if (with_length == (entry.object.bytes == 0)) {
      refuse(with_length ? "does not say how long the object is" : "says how long a known object is",
             with_length ? "write require OBJECT BYTES = VALUE" : "write values OBJECT = VALUE...");
    }
    for (const std::string_view word : words_of(value_)) {
      entry.values.push_back(number(word, 0, UINT32_MAX));
    }
    return entry;
  }
  [[nodiscard]] auto words() const -> std::vector<std::string_view> { return words_of(value_); }

 private:
  std::string place_;
  std::vector<std::string_view> key_;
  std::string_view value_;
};

auto apply_identity(const Line& line, DriveProfile& profile) -> bool {
  if (line.key() == "name") {
    profile.name = line.text();
  } else if (line.key() == "note") {
    profile.note += (profile.note.empty() ? "" : " ") + line.text();
  } else if (line.key() == "vendor") {
    profile.vendor = line.number(1, UINT32_MAX);
  } else if (line.key() == "product") {
    profile.product = line.number(0, UINT32_MAX);
  } else if (line.key() == "node") {
    profile.node = static_cast<std::uint8_t>(line.number(1, kLastNode));
  } else {
    return false;
  }
  return true;
}

void apply(const Line& line, DriveProfile& profile) {
  constexpr std::uint32_t kMostMs = 60'000;
  constexpr std::uint32_t kMostRatedMa = 127'000;
  if (line.key() == "rated_current") {
    profile.rated_current = line.object(line.words());
    profile.rated_current->name = "motor rated current";
    if (profile.rated_current->bytes == 0) {
      line.refuse("does not say how long the object is", "write OBJECT BYTES, as in 3001:01 4");
    }
  } else if (line.key() == "rated_current_ma") {
    profile.rated_current_ma = line.number(1, kMostRatedMa);
  } else if (line.key() == "objects_per_message") {
    profile.objects_per_message = line.number(2, PdoMap::kMostObjects);
  } else if (line.key() == "answer_ms") {
    profile.answer_ms = line.number(1, kMostMs);
  } else if (line.key() == "sdo_timeout_ms") {
    profile.sdo_timeout = std::chrono::milliseconds(line.number(1, kMostMs));
  } else if (line.key() == "stops_without_master" && (line.text() == "yes" || line.text() == "no")) {
    profile.stops_without_master = line.text() == "yes";
  } else if (line.key() == "values") {
    profile.values.push_back(line.values(false));
  } else if (line.key() == "require") {
    profile.required.push_back(line.values(true));
  } else if (!apply_identity(line, profile)) {
    line.refuse("has the key '" + std::string(line.key()) + "' or a value that are not known",
                "docs/cia402_drives.md lists them");
  }
}

}  // namespace

auto parse_profile(std::string_view text, const std::string& origin) -> DriveProfile {
  DriveProfile profile;
  int number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trimmed(text.substr(0, std::min(text.find('#'), end)));
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    if (!line.empty()) {
      apply(Line(line, origin + ", line " + std::to_string(number)), profile);
    }
  }
  if (profile.name.empty() || (!profile.vendor && !profile.product && !profile.node)) {
    throw std::runtime_error(origin +
                             " does not say which drives it is for; give it a name and vendor, product or node");
  }
  return profile;
}

auto find_profile(std::span<const DriveProfile> profiles, std::uint8_t node, std::optional<std::uint32_t> vendor,
                  std::optional<std::uint32_t> product) -> const DriveProfile* {
  const auto found = std::find_if(profiles.begin(), profiles.end(), [&](const DriveProfile& profile) {
    return (!profile.vendor || profile.vendor == vendor) && (!profile.product || profile.product == product) &&
           (!profile.node || profile.node == node);
  });
  return found == profiles.end() ? nullptr : &*found;
}

}  // namespace capstan::cia402
