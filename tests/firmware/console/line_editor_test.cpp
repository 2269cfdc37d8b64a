// SPDX-License-Identifier: Apache-2.0
// Editing, history and completion, seen through a small terminal of the test's own.
#include "capstan/firmware/console/line_editor.hpp"

#include <gtest/gtest.h>

#include <random>

#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

using Bench = test::Bench<2>;
using test::lines_of;
using test::verdict;

const std::string kUp = "\x1B[A";
const std::string kDown = "\x1B[B";
const std::string kRight = "\x1B[C";
const std::string kLeft = "\x1B[D";
const std::string kHome = "\x1B[H";
const std::string kEnd = "\x1B[F";
const std::string kDelete = "\x1B[3~";

/// One line of a screen as a terminal would show it.
struct Screen {
  std::string line;
  std::size_t column = 0;

  void show(const std::string& text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
      const char c = text[i];
      if (c == '\r') {
        column = 0;
      } else if (c == '\n') {
        line.clear();
      } else if (c == '\b') {
        column -= column > 0 ? 1 : 0;
      } else if (text.compare(i, 3, "\x1B[K") == 0) {
        line.resize(std::min(line.size(), column));
        i += 2;
      } else {
        line.resize(std::max(line.size(), column + 1), ' ');
        line[column++] = c;
      }
    }
  }
  [[nodiscard]] auto typed() const -> std::string {
    std::string shown = line.rfind("capstan> ", 0) == 0 ? line.substr(9) : line;
    shown.erase(shown.find_last_not_of(' ') + 1);
    return shown;
  }
};

struct Terminal {
  void type(const std::string& keys) {
    for (const char c : keys) {
      bench.shell.receive(c);
    }
    for (int i = 0; i < 100 && bench.shell.busy(); ++i) {
      bench.ticks(1);
      bench.shell.poll();
    }
    last = bench.sink.take();
    screen.show(last);
  }
  Bench bench{true};
  Screen screen;
  std::string last;
};

TEST(LineEditor, KeysInTheMiddleOfALineChangeItThere) {
  for (const auto& [keys, wanted] : {std::pair{"vrsion" + kHome + kRight + "e", "version"},
                                     {"ersion" + kHome + "v" + kEnd, "version"},
                                     {"verxsion" + kLeft + kLeft + kLeft + kLeft + "\b", "version"},
                                     {"vxersion" + kHome + kRight + kDelete, "version"},
                                     {"version now" + std::string("\x17"), "version"},
                                     {"version\x01\x0B", ""},
                                     {"vsion\x02\x02\x02\x02"
                                      "er",
                                      "version"},
                                     {"versionX\x02\x04", "version"},
                                     {"one\x15version", "version"},
                                     {"version" + kRight + kDelete + kEnd, "version"},
                                     {kLeft + kDelete + kHome + "version", "version"},
                                     {"version\x1B[5~\x1B[1;5C", "version"}}) {
    Terminal terminal;
    terminal.type("\r" + keys);
    EXPECT_EQ(terminal.screen.typed(), wanted);
    terminal.type("\r");
    EXPECT_EQ(terminal.last.find("board bench") != std::string::npos, std::string(wanted) == "version") << wanted;
  }
}

TEST(LineEditor, TheScreenAlwaysShowsTheLineWithTheCursorInItsPlace) {
  static const std::vector<std::string> kKeys = {
      kUp, kDown, kLeft,  kRight, kHome,  kEnd,   kDelete, "\b",   "\x7F", "a", "b",          "c",
      " ", "x",   "\x01", "\x05", "\x0B", "\x17", "\x04",  "\x02", "\x06", "q", "# remark\r", "status\r"};
  std::mt19937 random(5);
  Terminal terminal;
  terminal.type("\r");
  test::StringSink sink;
  Print out(sink);
  LineEditor editor(out, true);  // the same keys, so that the test knows the line
  for (int i = 0; i < 20'000; ++i) {
    const std::string& key = kKeys[random() % kKeys.size()];
    terminal.type(key);
    for (const char c : key) {
      if (editor.take(c) == LineEditor::Key::kLine) {
        std::string_view rest = editor.text();
        if (next_word(rest) == "status") {
          editor.remember();
        }
        editor.begin();
      }
    }
    sink.take();
    std::string wanted = "capstan> " + std::string(editor.text());
    std::string shown = terminal.screen.line;
    shown.resize(std::max(shown.size(), wanted.size()), ' ');
    wanted.resize(shown.size(), ' ');
    ASSERT_EQ(shown, wanted) << "after key " << i;
    ASSERT_EQ(terminal.screen.column, 9 + editor.before_cursor().size());
  }
}

TEST(LineEditor, UpAndDownWalkThroughTheCommandsThatWereGiven) {
  Terminal terminal;
  terminal.type("version\rstatus\rstatus\r   \rnonsense\rfaults\r");
  for (const auto& [key, wanted] : {std::pair{kUp, "faults"},
                                    {kUp, "status"},
                                    {kUp, "version"},
                                    {kUp, "version"},
                                    {kDown, "status"},
                                    {kDown, "faults"},
                                    {kDown, ""},
                                    {kDown, ""},
                                    {std::string("\x10"), "faults"},
                                    {std::string("\x0E"), ""}}) {
    terminal.type(key);
    EXPECT_EQ(terminal.screen.typed(), wanted);
  }
  terminal.type(kUp + kUp + kUp + "\r");
  EXPECT_NE(terminal.last.find("board bench"), std::string::npos);
}

TEST(LineEditor, TheHistoryIsBoundedAndForgetsTheOldestWholeLines) {
  Terminal terminal;
  for (int i = 0; i < 100; ++i) {
    terminal.type("get joint0.control.kp # " + std::to_string(i) + "\r");
  }
  std::string oldest;
  for (int i = 0; i < 100; ++i) {
    terminal.type(kUp);
    EXPECT_EQ(terminal.screen.typed().rfind("get joint0.control.kp # ", 0), 0U);
    oldest = terminal.screen.typed();
  }
  const int number = std::stoi(oldest.substr(24));
  EXPECT_GT(number, 85);
  EXPECT_LT(number, 95) << "256 bytes of 27 each: 9 lines";
}

TEST(LineEditor, AKeyIsStarsWhateverIsDoneToItsLineAndIsNotRemembered) {
  Terminal terminal;
  std::string all;
  const auto type = [&](const std::string& keys) {
    terminal.type(keys);
    all += terminal.last;
  };
  type("\rmaintenance open secret-key");
  EXPECT_EQ(terminal.screen.typed(), "maintenance ***************");
  type(kHome + kDelete + kDelete + "\x06\x06X");
  EXPECT_EQ(terminal.screen.typed().find_first_not_of('*'), std::string::npos);
  type("\x05\t\t" + kUp + kDown + "\r");
  type("maintenance open secret-key\r");
  type("maintenence open another-one\r");  // a slip: echoed as it was typed, and not remembered
  type(kUp);
  EXPECT_EQ(terminal.screen.typed(), "") << "neither of them";
  EXPECT_EQ(all.find("secret"), std::string::npos);
}

TEST(LineEditor, TabCompletesCommandsJointsParametersSignalsAndRecipes) {
  for (const auto& [keys, wanted] : {std::pair{"ver\t", "version"},
                                     {"sta\t", "status"},
                                     {"get j\t0\t", "get joint0."},
                                     {"get joint0.limits.foll\t", "get joint0.limits.following_"},
                                     {"set joint1.mot\t", "set joint1.motor"},
                                     {"set joint1.motor.enc\ts\t", "set joint1.motor.encoder_sign"},
                                     {"get joint1.control.sti\t", "get joint1.control.stiffness"},
                                     {"watch joint0.q2\t", "watch joint0.q2"},
                                     {"watch mach\tst\t", "watch machine.state"},
                                     {"scope trig\tf\t", "scope trigger fa"},
                                     {"scope channels joint1.dr\t", "scope channels joint1.drive"},
                                     {"experiment joint0 sine\t", "experiment joint0 sine_ladder"},
                                     {"move jo\t1\t", "move joint1"},
                                     {"help jo\t0\tlim\tthe\t", "help joint0.limits.thermal_time"},
                                     {"zzz\t", "zzz"},
                                     {"get zzz\t", "get zzz"},
                                     {"set joint0.control.kp 0\t", "set joint0.control.kp 0"}}) {
    Terminal terminal;
    terminal.type(std::string("\r") + keys);
    EXPECT_EQ(terminal.screen.typed(), wanted) << keys;
  }
}

TEST(LineEditor, TabListsWhatIsPossibleAndShowsTheLineAgain) {
  Terminal terminal;
  terminal.type("\rget joint0.limits.following_\t");
  EXPECT_NE(terminal.last.find("joint0.limits.following_error  joint0.limits.following_time"), std::string::npos);
  EXPECT_EQ(terminal.screen.typed(), "get joint0.limits.following_");
}

TEST(LineEditor, AWholeNameIsFollowedByABlankAndAGroupByNothing) {
  Terminal terminal;
  terminal.type("\rget joint0.control.k\t");
  EXPECT_EQ(terminal.screen.column, std::string("capstan> get joint0.control.k").size()) << "kp, ki, kd";
  terminal.type("p\t");
  EXPECT_EQ(terminal.screen.column, std::string("capstan> get joint0.control.kp ").size());
  terminal.type("\r");
  EXPECT_NE(terminal.last.find("joint0.control.kp 0.2"), std::string::npos);
}

TEST(Help, OfAParameterShowsMeaningRangeUnitDefaultAndWhenItChanges) {
  Bench bench;
  bench.say("set joint0.control.stiffness 4");
  for (const char* name : {"control.stiffness", "joint1.control.stiffness"}) {
    const auto lines = lines_of(bench.say(std::string("help ") + name));
    ASSERT_EQ(lines.size(), 3U);
    EXPECT_EQ(lines[0], "  control.stiffness: motor servo, proportional");
    EXPECT_EQ(lines[1], "      0 to 100 Nm/rad, default 1 Nm/rad, changes at any time");
  }
  const std::string group = bench.say("help limits");
  EXPECT_NE(group.find("limits.current: peak current\r\n      0.001 to 100 A, default 3 A, changes while disarmed and "
                       "in maintenance"),
            std::string::npos)
      << group;
  EXPECT_EQ(lines_of(bench.say("help move")).size(), 3U);
  EXPECT_EQ(verdict(bench.say("help nonsense")).rfind("error unknown_topic: ", 0), 0U);
  EXPECT_EQ(verdict(bench.say("help joint0")).rfind("error unknown_topic: ", 0), 0U);
}

}  // namespace
}  // namespace capstan
