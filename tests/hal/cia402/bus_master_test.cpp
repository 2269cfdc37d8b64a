// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402/bus_master.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "capstan/tests/hal/cia402/support.hpp"

namespace capstan::cia402 {
namespace {

auto settings(PdoLayout layout) -> std::vector<DriveSetting> {
  return {setting(1, 0, 2, layout), setting(9, 1, 2, layout)};
}

/// A bus with nodes 1 and 9.
struct Rig {
  explicit Rig(BusMaster::Options options = {}) : Rig(options, settings(options.layout)) {}
  Rig(BusMaster::Options options, std::vector<DriveSetting> these)
      : drives(std::move(these)), bus(drives, options, journal) {}
  std::vector<DriveSetting> drives;
  Journal journal;
  BusMaster bus;
  Time now = ms(5000);
  std::array<AxisSensed, 2> axes;
  std::array<AxisDrive, 2> wanted{};

  void arrives(const Frame& message) { bus.rt_receive({.kind = Received::Kind::kFrame, .frame = message, .at = now}); }
  void happens(Anomaly event) { bus.rt_receive({.kind = Received::Kind::kEvent, .event = event, .at = now}); }
  void sent(const Frame& message) { bus.rt_receive({.kind = Received::Kind::kSent, .frame = message, .at = now}); }
  auto command() -> std::vector<Frame> {
    bus.rt_decide(wanted);
    const BusMaster::Outbox out = bus.rt_messages(bus.rt_sound(), now);
    return {out.frames.begin(), out.frames.begin() + static_cast<std::ptrdiff_t>(out.count)};
  }
  /// Both drives answer with these states, and live.
  auto cycle(int first, int second) -> std::vector<Frame> {
    now += ms(1);
    arrives(status(first, 1));
    arrives(status(second, 9));
    arrives(frame(0x701, {5}));
    arrives(frame(0x709, {5}));
    bus.rt_sense(now, axes);
    const std::vector<Frame> out = command();
    bus.rt_sync_sent(now);
    return out;
  }
  [[nodiscard]] auto count(Anomaly anomaly) const -> std::uint32_t { return journal.count(anomaly); }
};

TEST(BusMaster, SendsSetValuesThenHeartbeatThenSync) {
  Rig rig;
  EXPECT_EQ(rig.cycle(kSwitchOnDisabled, kSwitchOnDisabled),
            (std::vector<Frame>{frame(0x201, {0, 0, 0, 0}), frame(0x209, {0, 0, 0, 0}), frame(0x77F, {5}),
                                frame(0x080, {})}));
  EXPECT_EQ(rig.cycle(kSwitchOnDisabled, kSwitchOnDisabled).size(), 3U) << "the heartbeat is not due again";
}

TEST(BusMaster, ItsHeartbeatComesEvery40ms) {
  Rig rig;
  int heartbeats = 0;
  for (int i = 0; i < 400; ++i) {
    for (const Frame& message : rig.cycle(kSwitchOnDisabled, kSwitchOnDisabled)) {
      heartbeats += message.id == 0x77F ? 1 : 0;
    }
  }
  EXPECT_EQ(heartbeats, 10);
}

TEST(BusMaster, AHeartbeatThatThePortDidNotTakeGoesAgainInTheNextCall) {
  Rig rig;
  for (int i = 0; i < 2; ++i) {
    const std::vector<Frame> messages = rig.command();
    EXPECT_EQ(std::count(messages.begin(), messages.end(), frame(0x77F, {5})), 1) << i;
  }
  rig.bus.rt_sync_sent(rig.now);
  const std::vector<Frame> messages = rig.command();
  EXPECT_EQ(std::count(messages.begin(), messages.end(), frame(0x77F, {5})), 0);
}

TEST(BusMaster, EachDriveGetsItsOwnTorque) {
  Rig rig;
  rig.wanted = {amperes(0.5), amperes(-1)};
  for (const int state : {kSwitchOnDisabled, kReady, kSwitchedOn}) {
    static_cast<void>(rig.cycle(state, state));
  }
  const std::vector<Frame> out = rig.cycle(kEnabled, kEnabled);
  EXPECT_EQ(out[0], frame(0x201, {0x0F, 0x00, 0xFA, 0x00}));  // 250 permille
  EXPECT_EQ(out[1], frame(0x209, {0x0F, 0x00, 0x0C, 0xFE}));  // -500
}

TEST(BusMaster, PackedTorquesShareAMessageAndControlwordsGoWhenTheyChange) {
  Rig rig({.layout = PdoLayout::kPacked});
  EXPECT_EQ(rig.cycle(kSwitchOnDisabled, kSwitchOnDisabled),
            (std::vector<Frame>{frame(0x301, {0, 0}), frame(0x309, {0, 0}), frame(0x200, {0, 0, 0, 0}),
                                frame(0x77F, {5}), frame(0x080, {})}));
  EXPECT_EQ(rig.cycle(kSwitchOnDisabled, kSwitchOnDisabled),
            (std::vector<Frame>{frame(0x200, {0, 0, 0, 0}), frame(0x080, {})}));
  rig.wanted = {amperes(0.5), amperes(-1)};
  EXPECT_EQ(rig.cycle(kSwitchOnDisabled, kSwitchOnDisabled)[0], frame(0x301, {0x06, 0}));
  EXPECT_EQ(rig.cycle(kSwitchOnDisabled, kSwitchOnDisabled)[0], frame(0x309, {0x06, 0})) << "one a cycle";
  for (int i = 0; i < 2; ++i) {
    static_cast<void>(rig.cycle(kReady, kReady));
    static_cast<void>(rig.cycle(kSwitchedOn, kSwitchedOn));
  }
  static_cast<void>(rig.cycle(kEnabled, kEnabled));
  const std::vector<Frame> on = rig.cycle(kEnabled, kEnabled);
  EXPECT_EQ(on[on.size() - 2], frame(0x200, {0xFA, 0x00, 0x0C, 0xFE}));
  rig.wanted = {};
  const std::vector<Frame> off = rig.cycle(kEnabled, kEnabled);
  EXPECT_EQ(off[0], frame(0x301, {0, 0})) << "torque is taken from all at once";
  EXPECT_EQ(off[1], frame(0x309, {0, 0}));
  EXPECT_EQ(off[2], frame(0x200, {0, 0, 0, 0}));
}

TEST(BusMaster, ControlwordsThatThePortDidNotTakeGoAgainInTheNextCall) {
  Rig rig({.layout = PdoLayout::kPacked});
  rig.wanted = {amperes(0.5), amperes(-1)};
  for (const int state : {kSwitchOnDisabled, kReady, kSwitchedOn, kEnabled}) {
    for (int i = 0; i < 2; ++i) {
      static_cast<void>(rig.cycle(state, state));
    }
  }
  rig.wanted = {};
  for (int refused = 0; refused < 3; ++refused) {  // SYNC is never handed over
    const std::vector<Frame> out = rig.command();
    EXPECT_EQ(out[0], frame(0x301, {0, 0})) << refused;
    EXPECT_EQ(out[1], frame(0x309, {0, 0})) << refused;
  }
  const std::vector<Frame> taken = rig.cycle(kEnabled, kEnabled);
  EXPECT_EQ(taken[0], frame(0x301, {0, 0}));
  EXPECT_EQ(taken[1], frame(0x309, {0, 0}));
  EXPECT_EQ(rig.cycle(kEnabled, kEnabled)[0].id, 0x200U) << "and once they are taken no more";
}

TEST(BusMaster, PackedControlwordsAreRepeatedOneAtATime) {
  Rig rig({.layout = PdoLayout::kPacked});
  static_cast<void>(rig.cycle(kSwitchOnDisabled, kSwitchOnDisabled));
  std::array<int, 2> repeats{};
  for (int i = 0; i < 100; ++i) {
    int here = 0;
    for (const Frame& message : rig.cycle(kSwitchOnDisabled, kSwitchOnDisabled)) {
      repeats[0] += message.id == 0x301 ? 1 : 0;
      repeats[1] += message.id == 0x309 ? 1 : 0;
      here += message.id == 0x301 || message.id == 0x309 ? 1 : 0;
    }
    EXPECT_LE(here, 1);
  }
  EXPECT_EQ(repeats[0], 1);
  EXPECT_EQ(repeats[1], 1);
}

TEST(BusMaster, MessagesOfNobodyAndOfNoUseAreCountedAndChangeNothing) {
  Rig rig;
  static_cast<void>(rig.cycle(kSwitchOnDisabled, kSwitchOnDisabled));
  rig.arrives(frame(0x182, {1, 2, 3, 4, 5, 6, 7, 8}));  // node 2
  rig.arrives(frame(0x281, {1, 2, 3, 4, 5, 6, 7, 8}));  // a second TPDO of node 1
  rig.arrives(frame(0x000, {0x80, 0x00}));              // somebody's network command
  EXPECT_EQ(rig.count(Anomaly::kUnknownId), 3U);
  rig.arrives(frame(0x581, {0x60, 0x40, 0x60, 0, 0, 0, 0, 0}));
  EXPECT_EQ(rig.count(Anomaly::kSdoUnexpected), 1U);
  Frame remote = frame(0x181, {});
  remote.remote = true;
  rig.arrives(remote);
  EXPECT_EQ(rig.count(Anomaly::kRemoteFrame), 1U);
  Frame extended = status(kEnabled);
  extended.extended = true;
  rig.arrives(extended);
  EXPECT_EQ(rig.count(Anomaly::kExtendedFrame), 1U);
  EXPECT_EQ(rig.count(Anomaly::kStatusRepeated) + rig.count(Anomaly::kStatusContradicts), 0U);
  EXPECT_TRUE(rig.bus.rt_sound());
}

TEST(BusMaster, AnotherMastersSyncTakesTheTorqueAwayUntilItHasBeenCalmFor100Cycles) {
  Rig rig;
  static_cast<void>(rig.cycle(kSwitchOnDisabled, kSwitchOnDisabled));
  rig.arrives(frame(0x080, {}));
  EXPECT_EQ(rig.count(Anomaly::kForeignSync), 1U);
  for (int i = 0; i < 99; ++i) {
    static_cast<void>(rig.cycle(kSwitchOnDisabled, kSwitchOnDisabled));
    EXPECT_FALSE(rig.bus.rt_sound());
  }
  static_cast<void>(rig.cycle(kSwitchOnDisabled, kSwitchOnDisabled));
  EXPECT_TRUE(rig.bus.rt_sound());
}

TEST(BusMaster, AnUnsoundDriveMakesTheBusUnsound) {
  Rig rig;
  static_cast<void>(rig.cycle(kSwitchOnDisabled, kSwitchOnDisabled));
  EXPECT_TRUE(rig.bus.rt_sound());
  static_cast<void>(rig.cycle(kSwitchOnDisabled, kFaulted));
  EXPECT_FALSE(rig.bus.rt_sound());
  EXPECT_EQ(rig.journal.count(Anomaly::kDriveFault, 2), 1U) << "the second drive's";
}

TEST(BusMaster, OneUnsoundDriveTakesTheTorqueFromAllInTheSameCycle) {
  Rig rig;
  rig.wanted = {amperes(0.5), amperes(-1)};
  for (const int state : {kSwitchOnDisabled, kReady, kSwitchedOn, kEnabled}) {
    static_cast<void>(rig.cycle(state, state));
  }
  const std::vector<Frame> out = rig.cycle(kEnabled, kFaulted);
  EXPECT_EQ(out[0], frame(0x201, {0, 0, 0, 0}));
  EXPECT_EQ(out[1], frame(0x209, {0, 0, 0, 0}));
}

TEST(BusMaster, AFaultIsResetAlthoughTheBusIsNotSound) {
  Rig rig;
  bool reset = false;
  for (int i = 0; i < 600; ++i) {
    reset |= rig.cycle(kSwitchOnDisabled, kFaulted)[1] == frame(0x209, {0x80, 0, 0, 0});
  }
  EXPECT_TRUE(reset);
}

TEST(BusMaster, WhileSyncHasNotLeftNothingMoreIsSent) {
  Rig rig({.confirms = true});
  static_cast<void>(rig.cycle(kSwitchOnDisabled, kSwitchOnDisabled));
  EXPECT_TRUE(rig.command().empty()) << "set values would pile up behind it";
  EXPECT_FALSE(rig.bus.rt_sound());
  EXPECT_EQ(rig.count(Anomaly::kSyncStuck), 1U);
  rig.sent(frame(0x201, {0, 0, 0, 0}));
  EXPECT_TRUE(rig.command().empty()) << "another message's leaving is not SYNC's";
  rig.sent(frame(0x080, {}));
  EXPECT_FALSE(rig.command().empty());
  EXPECT_TRUE(rig.bus.rt_sound());
}

TEST(BusMaster, OffTheBusItStaysOff) {
  for (const Anomaly event : {Anomaly::kBusOff, Anomaly::kLinkDown}) {
    Rig rig;
    static_cast<void>(rig.cycle(kSwitchOnDisabled, kSwitchOnDisabled));
    rig.happens(event);
    EXPECT_FALSE(rig.bus.rt_sound());
    EXPECT_TRUE(rig.command().empty());
    rig.happens(Anomaly::kControllerRestarted);
    EXPECT_FALSE(rig.bus.rt_sound()) << "a controller that restarts by itself starts no motion";
    EXPECT_EQ(rig.count(event), 1U);
  }
}

TEST(BusMaster, TroublesThatPassAreCountedOnly) {
  Rig rig;
  for (const Anomaly event : {Anomaly::kErrorPassive, Anomaly::kErrorWarning, Anomaly::kControllerOverflow,
                              Anomaly::kNoAcknowledge, Anomaly::kBusError, Anomaly::kReceiveLost, Anomaly::kFlood,
                              Anomaly::kSendQueueFull, Anomaly::kSendFailed, Anomaly::kReceiveFailed}) {
    rig.happens(event);
    EXPECT_EQ(rig.count(event), 1U);
  }
  EXPECT_TRUE(rig.bus.rt_sound());
}

TEST(BusMaster, NoMessagesWhateverTheySayBringTorqueThatIsNotWanted) {
  std::mt19937 random(7);  // any seed
  const auto below = [&random](std::uint32_t end) { return static_cast<int>(random() % end); };
  for (const PdoLayout layout : {PdoLayout::kSeparate, PdoLayout::kPacked}) {
    Rig rig({.layout = layout});
    static constexpr std::array<std::uint32_t, 9> kIds = {0x181, 0x189, 0x701, 0x709, 0x081,
                                                          0x089, 0x581, 0x080, 0x000};
    for (int cycle = 0; cycle < 20'000; ++cycle) {
      rig.now += ms(1);
      for (int i = below(4); i > 0; --i) {
        Frame any{
            .id = below(10) == 0 ? static_cast<std::uint32_t>(below(0x20000000)) : kIds.at(random() % kIds.size()),
            .size = static_cast<std::uint8_t>(below(4) == 0 ? below(65) : 8)};
        any.extended = below(50) == 0;
        any.remote = below(50) == 0;
        any.fd = any.size > 8;
        std::generate(any.data.begin(), any.data.end(), [&] { return static_cast<std::uint8_t>(random()); });
        rig.arrives(any);
      }
      if (below(1000) == 0) {
        rig.happens(static_cast<Anomaly>(below(static_cast<std::uint32_t>(Anomaly::kFlood))));
      }
      rig.bus.rt_sense(rig.now, rig.axes);
      for (const Frame& message : rig.command()) {
        const std::size_t controlword = message.id == 0x200 ? 2 : 0;  // the shared message has torques alone
        for (std::size_t at = 0; at < message.size; ++at) {
          const bool reset = at == controlword && message.data[at] == 0x80 && message.id != 0x200;
          EXPECT_TRUE(message.data[at] == 0 || reset || message.id == 0x77F) << std::hex << message.id;
        }
      }
      rig.bus.rt_sync_sent(rig.now);
    }
  }
}

TEST(BusMaster, ADriveThatShowsItsModeWhenEnabledIsAskedOnceBetweenSetValuesAndSync) {
  std::vector<DriveSetting> drives = {setting(1, 0, 2), setting(9, 1, 2)};
  drives[1].asks_mode = true;
  Rig rig({}, drives);
  rig.wanted = {amperes(0.5), amperes(-1)};
  for (const int state : {kSwitchOnDisabled, kReady, kSwitchedOn}) {
    static_cast<void>(rig.cycle(state, state));
  }
  EXPECT_EQ(rig.cycle(kEnabled, kEnabled),
            (std::vector<Frame>{frame(0x201, {0x0F, 0x00, 0xFA, 0x00}), frame(0x209, {0x0F, 0x00, 0x00, 0x00}),
                                frame(0x609, {0x40, 0x61, 0x60, 0x00, 0, 0, 0, 0}), frame(0x080, {})}));
  EXPECT_EQ(rig.cycle(kEnabled, kEnabled).size(), 3U) << "one question";
  rig.arrives(frame(0x589, {0x4F, 0x61, 0x60, 0x00, 0x0A, 0, 0, 0}));
  EXPECT_EQ(rig.cycle(kEnabled, kEnabled)[1], frame(0x209, {0x0F, 0x00, 0x0C, 0xFE}));
}

TEST(BusMaster, TheSecondHalfOfAStatusReachesItsDrive) {
  std::vector<DriveSetting> drives = {setting(1, 0, 2), setting(9, 1, 2)};
  drives[1].maps = drive_maps(PdoLayout::kSeparate, 9, 1, 2, 2);
  Rig rig({}, drives);
  rig.arrives(status(kReady, 1));
  rig.arrives(frame(0x189, {kReady, 0x02, 0x03, 0x02, 0x01, 0x00}));
  rig.arrives(frame(0x289, {0x9C, 0xFF}));
  rig.bus.rt_sense(rig.now, rig.axes);
  EXPECT_EQ(rig.axes[1].encoder_counts, 0x00010203);
  EXPECT_NEAR(rig.axes[1].current_a.to_double(), -0.2, 1e-6);
  std::array<std::uint32_t, kMostWantedIds> ids{};
  const std::size_t count = wanted_ids(drives, ids);
  EXPECT_NE(std::find(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(count), 0x289U),
            ids.begin() + static_cast<std::ptrdiff_t>(count));
}

TEST(BusMaster, AsksForItsOwnMessagesOnly) {
  std::array<std::uint32_t, kMostWantedIds> ids{};
  const std::size_t count = wanted_ids(settings(PdoLayout::kSeparate), ids);
  EXPECT_EQ(std::vector<std::uint32_t>(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(count)),
            (std::vector<std::uint32_t>{0x080, 0x181, 0x701, 0x081, 0x189, 0x709, 0x089}));
}

}  // namespace
}  // namespace capstan::cia402
