// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402/drive_setup.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "capstan/tests/hal/cia402/support.hpp"

namespace capstan::cia402 {
namespace {

using Key = std::pair<unsigned, unsigned>;  // index, subindex

/// The least that stands in for a drive: remembers what is written and gives it back, as bytes on the bus.
struct Drive {
  explicit Drive(std::uint8_t node) : node(node) {
    memory = {{{0x1000, 0}, 0x00020192}, {{0x6502, 0}, 0x00000200}, {{0x6075, 0}, 3500},      {{0x6061, 0}, 10},
              {{0x6072, 0}, 1000},       {{0x605A, 0}, 2},          {{0x605E, 0}, 2},         {{0x1A00, 0}, 2},
              {{0x1800, 1}, 0x40000283}, {{0x1401, 1}, 0x303},      {{0x1803, 1}, 0x80000000}};
  }
  std::uint8_t node;
  std::map<Key, std::uint32_t> memory;
  std::map<Key, std::uint32_t> aborts;    // instead of an answer
  std::map<Key, std::uint32_t> stubborn;  // keeps this value whatever is written
  std::map<Key, std::uint32_t> never;     // bits that it never sets
  std::vector<std::pair<Key, std::uint32_t>> writes;
  std::vector<std::pair<int, int>> commands;  // network management: command, node
  bool silent = false;
  bool starts = true;

  auto answer(const Frame& request) -> std::vector<Frame> {
    if (request.id == 0x000) {
      commands.emplace_back(request.data[0], request.data[1]);
      const int state = request.data[0] == 1 ? 5 : 0;
      return silent || !starts ? std::vector<Frame>{} : std::vector<Frame>{frame(0x700U + node, {state})};
    }
    const Key key{request.data[1] + 256U * request.data[2], request.data[3]};
    Frame reply = request;
    reply.id = 0x580U + node;
    if (silent) {
      return {};
    }
    if (aborts.contains(key)) {
      reply.data[0] = 0x80;
      put_bytes(reply, 4, 4, aborts.at(key));
    } else if (request.data[0] == 0x40) {
      static constexpr std::array<int, 5> kReadAnswers = {0, 0x4F, 0x4B, 0, 0x43};
      reply.data[0] = static_cast<std::uint8_t>(kReadAnswers.at(size(key)));
      put_bytes(reply, 4, 4, stubborn.contains(key) ? stubborn.at(key) : memory[key] & ~never[key]);
    } else {
      const std::size_t bytes = 4 - (request.data[0] >> 2 & 3);
      EXPECT_EQ(bytes, size(key)) << std::hex << key.first;
      memory[key] = get_bytes(request, 4, bytes);
      writes.emplace_back(key, memory[key]);
      reply.data[0] = 0x60;
      put_bytes(reply, 4, 4, 0);
    }
    return {reply};
  }

  /// Bytes of an object, from CiA 301 and 402.
  static auto size(const Key& key) -> std::size_t {
    static const std::map<unsigned, std::size_t> kSizes = {
        {0x1000, 4}, {0x6502, 4}, {0x6075, 4}, {0x1016, 4}, {0x1017, 2}, {0x6007, 2}, {0x605A, 2},
        {0x605E, 2}, {0x6060, 1}, {0x6061, 1}, {0x60C2, 1}, {0x1018, 4}, {0x607E, 1}, {0x60B2, 2},
        {0x6072, 2}, {0x6073, 2}, {0x60E0, 2}, {0x60E1, 2}, {0x6040, 2}, {0x1029, 1}};
    if (const auto found = kSizes.find(key.first); found != kSizes.end()) {
      return found->second;
    }
    const bool communication = (key.first & 0xFF00U) == 0x1400U || (key.first & 0xFF00U) == 0x1800U;
    return communication ? (key.second == 1 ? 4 : 1) : (key.second == 0 ? 1 : 4);
  }
};

struct Rig {
  explicit Rig(PdoLayout layout = PdoLayout::kSeparate)
      : setup({.node = 3, .layout = layout, .place = 1, .drives = 2}, journal, 2) {}
  Journal journal;
  DriveSetup setup;
  Drive drive{3};

  void run(const std::function<void(DriveSetup&, const Frame&)>& disturb = {}) {
    Time now = ms(100);
    for (int i = 0; i < 20'000 && setup.phase() < DriveSetup::Phase::kDone; ++i, now += ms(1)) {
      if (setup.phase() == DriveSetup::Phase::kReady) {
        setup.start();
      }
      if (const std::optional<Frame> request = setup.next(now)) {
        if (disturb) {
          disturb(setup, *request);
        }
        for (const Frame& reply : drive.answer(*request)) {
          setup.receive(reply);
        }
      }
    }
  }
  [[nodiscard]] auto said(const std::string& part) const -> bool {
    return std::any_of(setup.notes().begin(), setup.notes().end(),
                       [&part](const std::string& note) { return note.find(part) != std::string::npos; });
  }
  void expect_refusal(const std::string& named) {
    run();
    EXPECT_EQ(setup.phase(), DriveSetup::Phase::kFailed);
    EXPECT_NE(setup.problem().find(named), std::string::npos) << setup.problem();
    EXPECT_NE(setup.problem().find("; "), std::string::npos) << setup.problem();
    EXPECT_EQ(setup.problem().find("Drive 3 "), 0U) << setup.problem();
    for (const auto& [command, node] : drive.commands) {
      EXPECT_NE(command, 1) << "a drive that is refused is never made operational";
    }
  }
};

TEST(DriveSetup, MakesSureOfEverySafetyObjectAndStartsTheDriveLast) {
  Rig rig;
  rig.run();
  ASSERT_EQ(rig.setup.phase(), DriveSetup::Phase::kDone) << rig.setup.problem();
  EXPECT_EQ(rig.drive.memory[Key(0x1016, 1)], 0x007F005AU) << "node 127 within 90 ms";
  EXPECT_EQ(rig.drive.memory[Key(0x1017, 0)], 40U);
  EXPECT_EQ(rig.drive.memory[Key(0x6007, 0)], 1U);
  EXPECT_EQ(rig.drive.memory[Key(0x605A, 0)], 0U);
  EXPECT_EQ(rig.drive.memory[Key(0x605E, 0)], 0U);
  EXPECT_EQ(rig.drive.memory[Key(0x6060, 0)], 10U);
  EXPECT_EQ(rig.drive.memory[Key(0x60C2, 2)], 0xFDU) << "10^-3 s";
  EXPECT_EQ(rig.drive.commands, (std::vector<std::pair<int, int>>{{130, 3}, {1, 3}}));
  EXPECT_EQ(rig.setup.setting().rated_current_ma, 3500);
  EXPECT_EQ(rig.setup.setting().node, 3);
}

TEST(DriveSetup, MapsInTheOrderThatTheStandardAsksFor) {
  Rig rig;
  rig.run();
  std::vector<std::pair<Key, std::uint32_t>> status;
  for (const auto& write : rig.drive.writes) {
    if (write.first.first == 0x1800 || write.first.first == 0x1A00) {
      status.push_back(write);
    }
  }
  const std::vector<std::pair<Key, std::uint32_t>> expected = {
      {{0x1800, 1}, 0xC0000283}, {{0x1A00, 0}, 0}, {{0x1A00, 1}, 0x60410010}, {{0x1A00, 2}, 0x60640020},
      {{0x1A00, 3}, 0x60770010}, {{0x1A00, 0}, 3}, {{0x1800, 2}, 1},          {{0x1800, 1}, 0x40000183}};
  EXPECT_EQ(status, expected);
  for (const unsigned other : {0x1401U, 0x1402U, 0x1403U, 0x1801U, 0x1802U, 0x1803U}) {
    EXPECT_EQ(rig.drive.memory[Key(other, 1)] >> 31U, 1U) << "what else the drive sends or takes is switched off";
  }
  EXPECT_EQ(rig.drive.memory[Key(0x1401, 1)], 0x80000303U) << "and nothing but bit 31 changes by that";
}

TEST(DriveSetup, PackedLayoutHasAnRpdoForTheControlword) {
  Rig rig(PdoLayout::kPacked);
  rig.run();
  ASSERT_EQ(rig.setup.phase(), DriveSetup::Phase::kDone) << rig.setup.problem();
  EXPECT_EQ(rig.drive.memory[Key(0x1400, 1)], 0x200U);
  EXPECT_EQ(rig.drive.memory[Key(0x1600, 1)], 0x00030010U);
  EXPECT_EQ(rig.drive.memory[Key(0x1600, 2)], 0x60710010U);
  EXPECT_EQ(rig.drive.memory[Key(0x1401, 1)], 0x303U);
  EXPECT_EQ(rig.drive.memory[Key(0x1401, 2)], 255U);
  EXPECT_EQ(rig.drive.memory[Key(0x1601, 1)], 0x60400010U);
}

TEST(DriveSetup, ADriveThatKeepsAnotherValueOfAnObjectThatSafetyNeedsIsRefusedByName) {
  const std::vector<std::pair<Key, std::string>> cases = {
      {{0x607E, 0}, "607E:00, polarity"},          {{0x60B2, 0}, "60B2:00, torque offset"},
      {{0x6060, 0}, "6060:00, mode of operation"}, {{0x1A00, 2}, "1A00:02, mapped object"},
      {{0x1800, 1}, "1800:01, PDO identifier"},    {{0x1600, 0}, "1600:00, number of mapped objects"}};
  for (const auto& [key, named] : cases) {
    Rig rig;
    rig.drive.stubborn[key] = 0x77;
    rig.expect_refusal(named);
  }
}

TEST(DriveSetup, ADriveThatWasLeftEnabledLosesItsVoltageBeforeAnythingElseIsWritten) {
  Rig rig;
  rig.drive.memory[Key(0x6040, 0)] = 0x0F;
  rig.run();
  ASSERT_FALSE(rig.drive.writes.empty());
  EXPECT_EQ(rig.drive.writes[0], std::pair(Key(0x6040, 0), 0U));
}

TEST(DriveSetup, AnObjectThatHasTheWantedValueIsNotWritten) {
  Rig rig;
  rig.drive.memory[Key(0x605E, 0)] = 0;
  rig.run();
  for (const auto& write : rig.drive.writes) {
    EXPECT_NE(write.first, Key(0x605E, 0));
    EXPECT_NE(write.first, Key(0x607E, 0));
  }
}

TEST(DriveSetup, WhetherADriveAllowsRemoteRequestsForAMessageDoesNotMatter) {
  Rig rig;
  rig.drive.never[Key(0x1800, 1)] = 0x40000000;
  rig.run();
  EXPECT_EQ(rig.setup.phase(), DriveSetup::Phase::kDone) << rig.setup.problem();
}

TEST(DriveSetup, WhatIsNoTorqueDriveIsRefused) {
  for (const auto& [key, value, named] :
       std::vector<std::tuple<Key, std::uint32_t, std::string>>{{{0x1000, 0}, 0x00020191, "device type"},
                                                                {{0x6502, 0}, 0x1FF, "supported modes"},
                                                                {{0x6075, 0}, 0, "motor rated current"},
                                                                {{0x6075, 0}, 200'000, "motor rated current"},
                                                                {{0x6060, 0}, 8, "mode of operation"}}) {
    Rig rig;
    rig.drive.stubborn[key] = value;
    rig.expect_refusal(named);
  }
}

TEST(DriveSetup, AnAbortIsExplainedAndAnAbsentSparePdoIsNot) {
  Rig refused;
  refused.drive.aborts[Key(0x607E, 0)] = 0x06010001;
  refused.expect_refusal("the object can only be written");
  Rig absent;
  absent.drive.aborts = {{{0x1403, 1}, 0x06020000}, {{0x1803, 1}, 0x06090011}};
  absent.run();
  EXPECT_EQ(absent.setup.phase(), DriveSetup::Phase::kDone) << absent.setup.problem();
}

TEST(DriveSetup, ASparePdoThatCanNotBeSwitchedOffIsSaidAndNotRefused) {
  Rig rig;
  rig.drive.stubborn[Key(0x1802, 1)] = 0x383;
  rig.run();
  EXPECT_EQ(rig.setup.phase(), DriveSetup::Phase::kDone) << rig.setup.problem();
  EXPECT_TRUE(rig.said("1802:01, PDO identifier")) << "a message that is not needed stays on the bus";
}

TEST(DriveSetup, TheSmallestStoredLimitOfTorqueIsKept) {
  Rig rig;
  rig.drive.memory[Key(0x6073, 0)] = 800;
  rig.drive.memory[Key(0x60E1, 0)] = 70;
  rig.run();
  EXPECT_EQ(rig.setup.setting().max_torque_permille, 70);
  EXPECT_TRUE(rig.said("never asked for more than 245 mA")) << "70 thousandths of 3500 mA";
}

TEST(DriveSetup, SilenceAtAnyPointIsASentence) {
  Rig dead;
  dead.drive.silent = true;
  dead.expect_refusal("did not start");
  Rig cut;
  int requests = 0;
  cut.run([&](DriveSetup&, const Frame&) { cut.drive.silent = ++requests > 20; });
  EXPECT_EQ(cut.setup.phase(), DriveSetup::Phase::kFailed);
  EXPECT_NE(cut.setup.problem().find("did not answer a request"), std::string::npos) << cut.setup.problem();
  Rig lame;
  lame.run(
      [&](DriveSetup&, const Frame& request) { lame.drive.starts = !(request.id == 0x000 && request.data[0] == 1); });
  EXPECT_NE(lame.setup.problem().find("did not become operational"), std::string::npos) << lame.setup.problem();
}

TEST(DriveSetup, ARestartInBetweenIsAFailure) {
  Rig rig;
  int requests = 0;
  rig.run([&](DriveSetup& setup, const Frame&) {
    if (++requests == 15) {
      setup.receive(frame(0x703, {0}));
    }
  });
  EXPECT_NE(rig.setup.problem().find("restarted while it was set up"), std::string::npos) << rig.setup.problem();
}

TEST(DriveSetup, ADriveThatIsJustBeingSwitchedOnBootsTwice) {
  Rig rig;
  rig.run([](DriveSetup& setup, const Frame& request) {
    if (request.id == 0x000 && request.data[0] == 130) {
      setup.receive(frame(0x703, {0}));
    }
  });
  EXPECT_EQ(rig.setup.phase(), DriveSetup::Phase::kDone) << rig.setup.problem();
}

TEST(DriveSetup, OthersMessagesDoNotDisturb) {
  Rig rig;
  rig.run([](DriveSetup& setup, const Frame&) {
    setup.receive(frame(0x584, {0x80, 0, 0, 0, 0, 0, 0, 0}));
    setup.receive(frame(0x704, {0}));
    Frame extended = frame(0x583, {0x80, 0, 0, 0, 0, 0, 0, 0});
    extended.extended = true;
    setup.receive(extended);
    setup.receive(frame(0x703, {}));
  });
  EXPECT_EQ(rig.setup.phase(), DriveSetup::Phase::kDone) << rig.setup.problem();
}

}  // namespace
}  // namespace capstan::cia402
