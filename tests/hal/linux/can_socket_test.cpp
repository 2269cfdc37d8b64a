// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/linux/can_socket.hpp"

#include <gtest/gtest.h>
#include <linux/can.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <future>
#include <stdexcept>

#include "capstan/hal/linux/can_bus.hpp"
#include "capstan/hal/linux/can_link.hpp"

namespace capstan {
namespace {

using cia402::Anomaly;
using cia402::Frame;
using cia402::Received;

auto sentence(const std::function<void()>& action) -> std::string {
  try {
    action();
    return "";
  } catch (const std::runtime_error& problem) {
    return problem.what();
  }
}

auto socket_path() -> std::string {
  return testing::TempDir() + "capstan_can_" + std::to_string(getpid());
}

TEST(CanSocket, CarriesClassicalExtendedRemoteAndFdFramesUnchanged) {
  auto [near, far] = CanSocket::pair(monotonic_now);
  Frame fd{.id = 0x201, .size = 64, .fd = true};
  fd.data.fill(0x5A);
  for (const Frame& frame :
       {Frame{.id = 0x7FF, .size = 8, .data = {1, 2, 3, 4, 5, 6, 7, 8}}, Frame{.id = 0x080},
        Frame{.id = 0x1FFFFFFF, .size = 1, .extended = true}, Frame{.id = 0x181, .remote = true}, fd}) {
    EXPECT_FALSE(near.rt_send(frame));
    Received received;
    ASSERT_TRUE(far.rt_receive(received));
    EXPECT_EQ(received.kind, Received::Kind::kFrame);
    EXPECT_EQ(received.frame, frame);
  }
}

TEST(CanSocket, NothingHasArrivedIsNoEvent) {
  auto [near, far] = CanSocket::pair(monotonic_now);
  Received received;
  EXPECT_FALSE(near.rt_receive(received));
}

TEST(CanSocket, AFullQueueIsAnEventAndNeverWaits) {
  auto [near, far] = CanSocket::pair(monotonic_now);
  std::optional<Received> problem;
  for (int i = 0; i < 1'000'000 && !problem; ++i) {
    problem = near.rt_send({.id = 0x080});
  }
  ASSERT_TRUE(problem.has_value());
  EXPECT_EQ(problem->kind, Received::Kind::kEvent);
  EXPECT_EQ(problem->event, Anomaly::kSendQueueFull);
}

TEST(CanSocket, TheOtherEndGoneIsOneEvent) {
  auto ends = CanSocket::pair(monotonic_now);
  ends.second = CanSocket::pair(monotonic_now).first;
  Received received;
  ASSERT_TRUE(ends.first.rt_receive(received));
  EXPECT_EQ(received.event, Anomaly::kLinkDown);
  EXPECT_FALSE(ends.first.rt_receive(received));
  const auto problem = ends.first.rt_send({.id = 0x080});
  ASSERT_TRUE(problem.has_value());
  EXPECT_EQ(problem->event, Anomaly::kLinkDown);
}

TEST(CanSocket, WhatIsNoFrameIsAnEvent) {
  const std::string path = socket_path();
  auto listener = std::async([&] { return CanSocket::listen(path, std::chrono::seconds(10)); });
  const int raw = ::socket(AF_UNIX, SOCK_SEQPACKET, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, path.size());
  while (connect(raw, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    usleep(1000);
  }
  CanSocket far = listener.get();
  ASSERT_EQ(send(raw, "frame?", 6, 0), 6);
  Received received;
  ASSERT_TRUE(far.rt_receive(received));
  EXPECT_EQ(received.event, Anomaly::kReceiveFailed);
  EXPECT_EQ(received.detail, static_cast<std::uint32_t>(EBADMSG));
  can_frame error{};
  error.can_id = CAN_ERR_FLAG | 0x40;  // CAN_ERR_BUSOFF
  error.can_dlc = 8;
  ASSERT_EQ(send(raw, &error, sizeof error, 0), static_cast<ssize_t>(sizeof error));
  ASSERT_TRUE(far.rt_receive(received));
  EXPECT_EQ(received.kind, Received::Kind::kEvent);
  EXPECT_EQ(received.event, Anomaly::kBusOff);
  // CAN_ERR_CRTL, CAN_ERR_RESTARTED, CAN_ERR_ACK, CAN_ERR_PROT of linux/can/error.h.
  for (const auto& [id, controller, event] : {std::tuple{0x04U, 0x01, Anomaly::kControllerOverflow},
                                              {0x04U, 0x10, Anomaly::kErrorPassive},
                                              {0x04U, 0x20, Anomaly::kErrorPassive},
                                              {0x04U, 0x04, Anomaly::kErrorWarning},
                                              {0x100U, 0, Anomaly::kControllerRestarted},
                                              {0x20U, 0, Anomaly::kNoAcknowledge},
                                              {0x08U, 0, Anomaly::kBusError},
                                              {0x44U, 0x10, Anomaly::kBusOff}}) {
    error.can_id = CAN_ERR_FLAG | id;
    error.data[1] = static_cast<std::uint8_t>(controller);
    ASSERT_EQ(send(raw, &error, sizeof error, 0), static_cast<ssize_t>(sizeof error));
    ASSERT_TRUE(far.rt_receive(received));
    EXPECT_EQ(received.event, event) << std::hex << id << ' ' << controller;
  }
  close(raw);
}

TEST(CanSocket, WhatCanNotBeOpenedIsASentenceWithTheCure) {
  for (const std::string& name : {std::string("unix:/nowhere/at/all"), "unix:" + std::string(200, 'x'),
                                  std::string("unix:"), std::string("can77")}) {
    const std::string problem = sentence([&] { static_cast<void>(CanSocket::open(name, false, true)); });
    EXPECT_NE(problem.find("; "), std::string::npos) << name << ": " << problem;
  }
  const std::string nobody =
      sentence([] { static_cast<void>(CanSocket::listen(socket_path(), std::chrono::milliseconds(1))); });
  EXPECT_NE(nobody.find("Nothing connected"), std::string::npos) << nobody;
}

TEST(CanLink, AnInterfaceThatIsNotThereIsASentence) {
  EXPECT_NE(sentence([] { static_cast<void>(read_can_link("can77")); }).find("can77"), std::string::npos);
}

TEST(CanLink, TheLoopbackIsReadAsUpAndWithoutController) {
  const CanLink link = read_can_link("lo");
  EXPECT_TRUE(link.up);
  EXPECT_EQ(link.rates.nominal_bit_s, 0U);
}

TEST(CanLink, WhatTorqueMayNotDependOnIsRefusedWithTheCommandThatCuresIt) {
  const CanLink good{
      .name = "can0", .kind = "can", .up = true, .send_queue = 10, .restart_ms = 0, .rates = {1'000'000, 0}};
  EXPECT_EQ(objection_to(good, false), "");
  CanLink bad = good;
  bad.up = false;
  EXPECT_NE(objection_to(bad, false).find("; ip link set can0 up"), std::string::npos);
  bad = good;
  bad.restart_ms = 100;
  EXPECT_NE(objection_to(bad, false).find("; ip link set can0 type can restart-ms 0"), std::string::npos);
  bad = good;
  bad.send_queue = 1000;
  EXPECT_NE(objection_to(bad, false).find("; ip link set can0 txqueuelen 10"), std::string::npos);
  EXPECT_NE(objection_to(good, true).find("dbitrate"), std::string::npos);
}

TEST(CanBus, TheBudgetIsALineAndWhatDoesNotFitIsRefusedWithTheCures) {
  const cia402::BitRates rates{1'000'000, 0};
  const cia402::BitRates slow{250'000, 0};
  constexpr auto kSeparate = cia402::PdoLayout::kSeparate;
  EXPECT_EQ(
      budget_line("can0", 2, bus_budget(kSeparate, 2, rates), rates),
      "can0: 2 drives at 1000 kbit/s, 5 messages a cycle, at most 515 us, 681 us with one of them again: 69 % of a "
      "cycle, of 80 % that are allowed");
  const std::string refusal =
      sentence([&] { static_cast<void>(budget_line("can0", 4, bus_budget(kSeparate, 4, rates), rates)); });
  for (const char* part : {"1141 us", "115 %", "--can can1", "--pdo packed", "--fd", "bit rate"}) {
    EXPECT_NE(refusal.find(part), std::string::npos) << refusal;
  }
  EXPECT_NE(sentence([&] { static_cast<void>(budget_line("can0", 1, bus_budget(kSeparate, 1, slow), slow)); }), "")
      << "one drive at 250 kbit/s: 4 x 285 us";
}

}  // namespace
}  // namespace capstan
