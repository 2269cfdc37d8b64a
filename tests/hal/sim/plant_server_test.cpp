// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/plant_server.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <future>
#include <sstream>
#include <stdexcept>
#include <string>

#include "capstan/hal/plant_link/frames.hpp"
#include "capstan/hal/sim/multi_plant.hpp"

namespace capstan::sim {
namespace {

using plant_link::DriveFrame;
using plant_link::DriveKind;
using plant_link::SensedFrame;

/// The board's end of a line.
template <std::size_t Axes>
class Board {
 public:
  explicit Board(int file) : file_(file) {}

  void send(const DriveFrame<Axes>& frame) {
    const auto wire = plant_link::encode(frame);
    ASSERT_EQ(::write(file_, wire.view().data(), wire.size), static_cast<ssize_t>(wire.size));
  }

  /// False: the line was closed first.
  bool receive(SensedFrame<Axes>& frame) {
    std::uint8_t byte = 0;
    while (::read(file_, &byte, 1) == 1) {
      if (reader_.take(byte))
        return plant_link::decode(reader_.packet(), frame);
    }
    return false;
  }

 private:
  int file_;
  plant_link::FrameReader<plant_link::kSensedSize<Axes>> reader_;
};

class Line {
 public:
  Line() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
    board = FileDescriptor(ends[0]);
    plant = FileDescriptor(ends[1]);
  }
  FileDescriptor board, plant;
};

TEST(PlantServer, TheBoardSeesTheSameBitsAsWithThePlantInItsOwnProcess) {
  Scenario scenario;
  scenario.seed = 9;
  Line line;
  auto serving = std::async(std::launch::async, [&] { return serve(line.plant.get(), scenario, 1); });
  Board<1> board(line.board.get());
  Plant here(scenario.plant, scenario.seed);
  for (std::uint32_t i = 1; i <= 500; ++i) {
    DriveFrame<1> drive{.sequence = i};
    drive.drive.axis[0] = {Q24::from_double(0.8), i > 20};
    board.send(drive);
    SensedFrame<1> sensed;
    ASSERT_TRUE(board.receive(sensed));
    here.step(drive.drive.axis[0].current_a.to_double(), i > 20);
    ASSERT_EQ(sensed.sequence, i);
    ASSERT_EQ(sensed.axis[0].encoder_counts, here.readings().encoder_counts);
    ASSERT_EQ(sensed.axis[0].current_a.raw(), Q24::from_double(here.readings().current_a).raw());
  }
  line.board.close();
  const ServeReport report = serving.get();
  EXPECT_EQ(report.cycles, 500U);
  EXPECT_EQ(report.first_joint_rad, here.truth().q2_rad);
  EXPECT_NE(report.first_joint_rad, 0.0);
}

TEST(PlantServer, ServesACoupledInstrumentToABoardWithMoreAxes) {
  const Scenario scenario = parse_scenario("instrument = \"da_vinci_wrist\"\n", "x.toml");
  Line line;
  std::ostringstream record;
  auto serving = std::async(std::launch::async, [&] { return serve(line.plant.get(), scenario, 4, {200, &record}); });
  Board<4> board(line.board.get());
  SensedFrame<4> sensed;
  for (std::uint32_t i = 1; i < 200; ++i) {
    DriveFrame<4> drive{.sequence = i};
    drive.drive.axis[1] = {Q24::from_double(1.5), true};
    board.send(drive);
    ASSERT_TRUE(board.receive(sensed)) << i;
  }
  EXPECT_EQ(sensed.axis[0].encoder, Quality::kOk);
  EXPECT_GT(sensed.axis[1].encoder_counts, 100);
  EXPECT_EQ(sensed.axis[3].encoder, Quality::kMissing);
  board.send({.sequence = 200});
  EXPECT_EQ(serving.get().cycles, 200U);
  // The record: one line before the first cycle, one for each; the last but one answered the last frame that was read.
  std::istringstream lines(record.str());
  std::vector<std::string> recorded;
  for (std::string one; std::getline(lines, one);) {
    recorded.push_back(one);
  }
  ASSERT_EQ(recorded.size(), 201U);
  std::string expected = "199";
  for (std::size_t i = 0; i < 4; ++i) {
    const AxisSensed& axis = sensed.axis[i];
    expected += "," + std::to_string(axis.encoder_counts) + "," + std::to_string(axis.current_a.raw()) +
                (i < 3 ? ",2,2," : ",0,0,") + (i == 1 ? std::to_string(3 << 23) + ",1" : "0,0");
  }
  EXPECT_EQ(recorded[199], expected);
}

TEST(PlantServer, AQueryMovesNothingAndADamagedFrameHasNoAnswer) {
  Line line;
  auto serving = std::async(std::launch::async, [&] { return serve(line.plant.get(), Scenario{}, 1); });
  Board<1> board(line.board.get());
  auto wire = plant_link::encode(DriveFrame<1>{.sequence = 6});
  wire.bytes[3] ^= 0x40U;
  ASSERT_EQ(::write(line.board.get(), wire.view().data(), wire.size), static_cast<ssize_t>(wire.size));
  board.send({.sequence = 7, .kind = DriveKind::kQuery});
  SensedFrame<1> sensed;
  ASSERT_TRUE(board.receive(sensed));
  EXPECT_EQ(sensed.sequence, 7U);
  line.board.close();
  EXPECT_EQ(serving.get().cycles, 0U);
}

TEST(PlantServer, APlantThatDivergesSaysSoAndClosesTheService) {
  Scenario scenario;
  scenario.plant.current_limit_a = 1000.0;
  scenario.plant.torque_constant_nm_per_a = 100.0;
  Line line;
  auto serving = std::async(std::launch::async, [&] {
    const ServeReport report = serve(line.plant.get(), scenario, 1);
    line.plant.close();
    return report;
  });
  Board<1> board(line.board.get());
  SensedFrame<1> sensed;
  bool answered = true;
  for (std::uint32_t i = 1; i <= 60000 && answered; ++i) {
    DriveFrame<1> drive{.sequence = i};
    drive.drive.axis[0] = {Q24::from_double(127.0), true};
    board.send(drive);
    answered = board.receive(sensed);
  }
  EXPECT_FALSE(answered);
  EXPECT_NE(serving.get().failure.find("diverged"), std::string::npos);
}

TEST(PlantServer, LinesAreOpenedAsNamedOrRefusedWithACure) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("capstan_line_" + std::to_string(::getpid()))).string();
  auto waiting = std::async(std::launch::async, [&] { return open_line("listen:" + path); });
  const FileDescriptor line = open_line("connect:" + path);
  const FileDescriptor other = waiting.get();
  ASSERT_EQ(::write(line.get(), "x", 1), 1);
  char got = 0;
  ASSERT_EQ(::read(other.get(), &got, 1), 1);
  EXPECT_EQ(got, 'x');
  for (const char* bad : {"", "serial", "tcp:", "tcp:70000", "tcp:5x", "listen:", "connect:"}) {
    try {
      static_cast<void>(open_line(bad));
      ADD_FAILURE() << bad << " was accepted";
    } catch (const std::runtime_error& refusal) {
      EXPECT_NE(std::string(refusal.what()).find("; "), std::string::npos) << bad;
    }
  }
}

}  // namespace
}  // namespace capstan::sim
