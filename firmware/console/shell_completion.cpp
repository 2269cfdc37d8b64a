// SPDX-License-Identifier: Apache-2.0
// What Tab offers: commands, joints, parameters, signals and recipes, up to the next dot.
#include <algorithm>

#include "capstan/firmware/console/shell.hpp"
#include "capstan/firmware/console/shell_commands.hpp"

namespace capstan {
namespace {

/// A name put together from parts.
class Words {
 public:
  Words() = default;
  explicit Words(std::string_view text) { add(text); }
  auto add(std::string_view text) -> Words& {
    const std::size_t count = std::min(text.size(), text_.size() - length_);
    std::copy_n(text.begin(), count, text_.begin() + static_cast<std::ptrdiff_t>(length_));
    length_ += count;
    return *this;
  }
  [[nodiscard]] auto view() const -> std::string_view { return {text_.data(), length_}; }

 private:
  std::array<char, 64> text_{};
  std::size_t length_ = 0;
};

auto joint_name(std::size_t axis) -> Words {
  const char digit = static_cast<char>('0' + axis);
  return Words("joint").add({&digit, 1});
}

/// Collects the candidates that begin as the word does, cut behind the dot that follows.
class Completion {
 public:
  Completion(std::string_view word, Print* list) : word_(word), list_(list) {}

  void offer(std::string_view candidate) {
    if (candidate.size() < word_.size() || std::string_view(candidate.data(), word_.size()) != word_) {
      return;
    }
    const std::size_t dot = candidate.find('.', word_.size());
    candidate =
        std::string_view(candidate.data(), std::min(dot == std::string_view::npos ? dot : dot + 1, candidate.size()));
    if (count_ > 0 && candidate == last_.view()) {
      return;  // another one behind the same dot
    }
    last_ = Words(candidate);
    if (list_ != nullptr) {
      *list_ << "  " << candidate;
    }
    if (count_++ == 0) {
      common_ = last_;
      common_length_ = candidate.size();
      return;
    }
    const auto shared = std::mismatch(candidate.begin(), candidate.end(), common_.view().begin(), common_.view().end());
    common_length_ = std::min(common_length_, static_cast<std::size_t>(shared.first - candidate.begin()));
  }
  [[nodiscard]] auto count() const -> std::size_t { return count_; }
  /// What all candidates go on with.
  [[nodiscard]] auto rest() const -> std::string_view {
    return count_ == 0 ? std::string_view{}
                       : std::string_view(common_.view().data() + word_.size(), common_length_ - word_.size());
  }
  /// There is one, and it is whole.
  [[nodiscard]] auto whole() const -> bool {
    return count_ == 1 && common_.view().back() != '.' && common_.view().back() != '=';
  }

 private:
  std::string_view word_;
  Print* list_;
  std::size_t count_ = 0;
  std::size_t common_length_ = 0;
  Words common_;
  Words last_;
};

void offer_commands(Completion& completion, bool to_run) {
  for (const ShellCommand& command : shell_commands()) {
    if (!(to_run && command.acts)) {
      completion.offer(command.name);
    }
  }
}

void offer_joints(Completion& completion, std::size_t axes) {
  for (std::size_t axis = 0; axis < axes; ++axis) {
    completion.offer(joint_name(axis).view());
  }
}

void offer_parameters(Completion& completion, std::size_t axes) {
  for (std::size_t axis = 0; axis < axes; ++axis) {
    for (const ParameterInfo& parameter : parameters()) {
      completion.offer(joint_name(axis).add(".").add(parameter.group).add(".").add(parameter.name).view());
    }
  }
}

void offer_signals(Completion& completion, std::size_t axes) {
  for (std::size_t axis = 0; axis < axes; ++axis) {
    for (const SignalInfo& signal : joint_signals()) {
      completion.offer(joint_name(axis).add(".").add(signal.name).view());
    }
  }
  for (const SignalInfo& signal : machine_signals()) {
    completion.offer(Words("machine.").add(signal.name).view());
  }
}

template <std::size_t N>
void offer_words(Completion& completion, const std::array<const char*, N>& words) {
  for (const char* word : words) {
    completion.offer(word);
  }
}

/// What may stand at this place of a line. @param before  the words before it
void offer_all(Completion& completion, std::string_view before, std::size_t axes) {
  static constexpr std::array kScopeWords = {"signals", "channels", "trigger", "start", "stop", "dump"};
  static constexpr std::array kTriggerWords = {"now", "fault", "rising", "falling", "above", "below"};
  static constexpr std::array kFaultWords = {"second", "release"};
  static constexpr std::array kMoveWords = {"motor=", "force=", "rate="};
  const std::string_view command = next_word(before);
  const std::string_view second = next_word(before);
  if (command.empty()) {
    offer_commands(completion, true);
  } else if (command == "get" || command == "set" || command == "list") {
    offer_parameters(completion, second.empty() ? axes : 0);
  } else if (command == "help") {
    offer_commands(completion, false);
    offer_parameters(completion, axes);
  } else if (command == "watch" || command == "frames") {
    offer_signals(completion, axes);
  } else if (command == "scope") {
    if (second.empty()) {
      offer_words(completion, kScopeWords);
    } else if (second == "trigger") {
      offer_words(completion, kTriggerWords);
    }
    offer_signals(completion, second == "channels" || second == "trigger" ? axes : 0);
  } else if (command == "faults") {
    offer_words(completion, kFaultWords);
  } else if (second.empty()) {
    offer_joints(completion, axes);
  } else if (command == "move") {
    offer_words(completion, kMoveWords);
  } else if (command == "experiment" && next_word(before).empty()) {
    for (const char* recipe : recipe_names()) {
      completion.offer(recipe);
    }
  }
}

}  // namespace

void Shell::complete() {
  const std::string_view typed = editor_.before_cursor();
  std::size_t begin = typed.size();
  while (begin > 0 && typed[begin - 1] != ' ') {
    --begin;
  }
  const std::string_view before(typed.data(), begin);
  const std::string_view word(typed.data() + begin, typed.size() - begin);
  Completion completion(word, nullptr);
  offer_all(completion, before, machine_.axes());
  if (completion.count() == 0) {
    return;
  }
  const Words rest(completion.rest());  // of its own: inserting changes the line that `word` looks at
  const bool whole = completion.whole();
  if (rest.view().empty() && !whole) {
    out_ << "\r\n";
    Completion listed(word, &out_);
    offer_all(listed, before, machine_.axes());
    out_ << "\r\n";
    editor_.redraw();
    return;
  }
  editor_.insert(rest.view());
  if (whole) {
    editor_.insert(std::string_view(" "));
  }
}

}  // namespace capstan
