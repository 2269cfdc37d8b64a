// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/telemetry/log_sink.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <thread>

#include "capstan/tests/tools/own_folder.hpp"
#include "capstan/tools/log/csv_log.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

const std::vector<std::string> kColumns = {"axis0/q2_est_rad", "axis1/q2_est_rad"};

using FileSink = test::OwnFolder;

TEST_F(FileSink, AnOlderLogIsThereUntilTheFirstRow) {
  for (const char* name : {"log.csv", "log.mcap"}) {
    write_text_file(path(name), "older");
    {
      const auto log = file_sink(path(name));
      log->begin(kColumns);
      log->end();
    }
    EXPECT_EQ(read_text_file(path(name)), "older") << name;
    const auto log = file_sink(path(name));
    log->begin(kColumns);
    EXPECT_EQ(read_text_file(path(name)), "older") << name;
    log->row(0, {"1", "2"});
    log->row(10, {"3", "4"});
    log->end();
    const CsvLog read = CsvLog::read(path(name), {});
    EXPECT_EQ(read.rows(), 2U) << name;
    EXPECT_EQ(read.column("axis1/q2_est_rad")[1], 4.0) << name;
  }
  file_sink(path("new.csv"))->end();
  EXPECT_FALSE(std::filesystem::exists(path("new.csv")));
}

TEST_F(FileSink, WhereNoFileCanBeWrittenIsSaidBeforeAnythingIsRecorded) {
  EXPECT_THROW(file_sink(path("no_such_folder/log.csv")), BadInput);
  EXPECT_THROW(file_sink(folder_.string()), BadInput);
  EXPECT_THROW(file_sink(""), BadInput);
}

TEST_F(FileSink, WhatIsOlderThanASecondIsInTheFileBeforeItsEnd) {
  for (const char* name : {"log.csv", "log.mcap"}) {
    for (const std::int64_t every_ms : {10, 100, 1000}) {
      const auto log = file_sink(path(name));
      log->begin(kColumns);
      constexpr std::int64_t kLastMs = 20'000;
      for (std::int64_t ms = 0; ms <= kLastMs; ms += every_ms) {
        log->row(ms, {"1", "2"});
      }
      const CsvLog read = CsvLog::read(path(name), {});
      EXPECT_GE(read.time()[read.time().size() - 1], 1e-3 * static_cast<double>(kLastMs - 1000 - every_ms))
          << name << " every " << every_ms << " ms";
      EXPECT_EQ(read.column("axis1/q2_est_rad").size(), read.time().size());
    }
  }
}

TEST_F(FileSink, WhoWaitsAtAPipeSeesItsEndThoughNothingWasRecorded) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  std::string seen = "nothing yet";
  std::thread reader([&] { seen = read_text_file(path("pipe")); });
  {
    const auto log = file_sink(path("pipe"));
    log->end();
  }
  reader.join();
  EXPECT_EQ(seen, "");
}

}  // namespace
}  // namespace capstan::tools
