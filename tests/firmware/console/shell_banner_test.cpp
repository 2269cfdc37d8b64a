// SPDX-License-Identifier: Apache-2.0
// What the shell says to who comes, and about stored parameters of other versions.
#include <gtest/gtest.h>

#include "capstan/tests/firmware/parameters/bank_image.hpp"

namespace capstan {
namespace {

using test::has_line;
using test::verdict;

/// A board of one joint that starts on what is stored.
struct Started {
  explicit Started(const test::FlashBanks& stored = {}) : banks(stored) { application.rt_tick(); }
  auto say(std::string_view line) -> std::string {
    for (const char c : line) {
      shell.receive(c);
    }
    shell.receive('\n');
    for (int i = 0; i < 100 && shell.busy(); ++i) {
      application.rt_tick();
      shell.poll();
    }
    return sink.take();
  }
  auto banner() -> std::string {
    shell.print_banner();
    return sink.take();
  }
  test::FlashBanks banks;
  test::FakeIo<1> io;
  Application<test::FakeIo<1>> application{io, banks};
  test::StringSink sink;
  test::FakeBoard board;
  Shell shell{application, sink, board, true};
};

auto with(const test::BankImage& image) -> test::FlashBanks {
  test::FlashBanks banks;
  image.write(banks, 0);
  return banks;
}

TEST(ShellBanner, SaysVersionBoardJointsStateAndWhatToTypeAndEndsInThePrompt) {
  Started started;
  const std::string text = started.banner();
  EXPECT_TRUE(has_line(text, "# capstan ")) << text;
  EXPECT_NE(text.find(" on board bench, joints 1, state disarmed\r\n"), std::string::npos) << text;
  EXPECT_TRUE(has_line(text, "# no parameters were ever saved")) << text;
  EXPECT_NE(text.find("'help'"), std::string::npos);
  const auto lines = test::lines_of(text);
  for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
    EXPECT_EQ(lines[i].rfind("# ", 0), 0U) << "a host skips it: " << lines[i];
  }
  EXPECT_EQ(lines.back(), "capstan> ");
  EXPECT_FALSE(energised(started.application.telemetry().state));
}

TEST(ShellBanner, NamesALatchedFaultAndWhatBlocksArming) {
  Started started;
  started.say("arm");
  started.io.estop = true;
  started.application.rt_tick();
  EXPECT_NE(started.banner().find("state faulted by emergency_stop: 'faults' says what to do"), std::string::npos);
  started.say("disarm");
  EXPECT_NE(started.banner().find("state disarmed, something blocks arming: 'faults' says what"), std::string::npos);
}

TEST(ShellBanner, AnOlderSetIsSaidAtTheStartInStatusAndByLoadUntilItIsSaved) {
  test::BankImage older(1);
  older.add(0, "control.kp", Q24::from_double(3.5).raw());
  older.add(0, "control.ki", Q24::from_double(1000.0 / 8.0).raw());  // today up to 100 1/s
  older.add(0, "control.gone", 1);
  Started started(with(older));
  const std::string said = "stored parameters are another version's: " + std::to_string(parameters().size() - 2) +
                           " of today's were not in it and have their defaults, 1 are outside today's range and have "
                           "their defaults, 1 have names that are unknown today and were left out";
  EXPECT_TRUE(has_line(started.banner(), "# " + said));
  EXPECT_TRUE(has_line(started.say("status"), said));
  EXPECT_TRUE(has_line(started.say("get joint0.control.kp"), "joint0.control.kp 3.5"));
  const std::string loaded = started.say("load");
  EXPECT_TRUE(has_line(loaded, said));
  EXPECT_NE(loaded.find("ok\r\n"), std::string::npos);
  started.say("save");
  EXPECT_EQ(started.banner().find("stored parameters"), std::string::npos);
  EXPECT_EQ(started.say("status").find("stored parameters"), std::string::npos);
  EXPECT_EQ(started.say("load").find("stored parameters"), std::string::npos);
}

TEST(ShellBanner, ANewestSetThatIsNotWholeIsSaidAtTheStartInStatusAndByLoadUntilOneIsSaved) {
  Started before;
  before.say("save");
  before.say("set control.kp 3");
  before.say("save");
  test::FlashBanks aged = before.banks;
  aged.memory[1][100] ^= 1;
  Started started(aged);
  const std::string said = "the parameters saved last are not whole";
  EXPECT_TRUE(has_line(started.banner(), "# " + said));
  EXPECT_TRUE(has_line(started.say("status"), said));
  EXPECT_TRUE(has_line(started.say("load"), said));
  EXPECT_TRUE(has_line(started.say("save"), "ok"));
  EXPECT_FALSE(has_line(started.say("status"), said));
  EXPECT_FALSE(has_line(started.say("load"), said));
  EXPECT_FALSE(has_line(Started(started.banks).banner(), "# " + said));
}

TEST(ShellBanner, ASetOfAnotherFormatIsRefusedWithASentenceAndBlocksArmingUntilOneIsSaved) {
  test::BankImage newer(1, 9);
  newer.add(0, "control.kp", Q24::from_double(3.5).raw());
  Started started(with(newer));
  EXPECT_TRUE(has_line(started.banner(), "# stored parameters have format 9, which this version does not read"));
  EXPECT_TRUE(has_line(started.say("status"), "stored parameters have format 9"));
  const std::string refused = started.say("load");
  EXPECT_NE(refused.find("error storage_foreign: "), std::string::npos) << refused;
  EXPECT_TRUE(has_line(started.say("arm"), "blocked by model_invalid: "));
  EXPECT_TRUE(test::same(started.application.config()[0], AxisConfig{}));
  started.say("save");
  EXPECT_NE(started.say("arm").find("ok\r\n"), std::string::npos);
}

}  // namespace
}  // namespace capstan
