// SPDX-License-Identifier: Apache-2.0
// The table of files as people have them: each is read, or refused with its true cause and the command that cures it.
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

#include "capstan/tools/log/compression.hpp"
#include "capstan/tools/log/csv_log.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

using std::string_literals::operator""s;

struct FileCase {
  const char* name;
  std::string bytes;
  const char* expected;  ///< a refusal's words, or those of the note; empty: read without a note
};

void PrintTo(const FileCase& file, std::ostream* out) {
  *out << file.name;
}

auto utf16(const std::string& ascii, bool big_endian, bool mark) -> std::string {
  std::string bytes = mark ? (big_endian ? "\xFE\xFF" : "\xFF\xFE") : "";
  for (const char c : ascii) {
    bytes += big_endian ? "\0"s + c : c + "\0"s;
  }
  return bytes;
}

const std::string kPlain = "time_s,axis0/q1_rad\n0,1.5\n0.01,-2\n0.02,3\n";

/// As many lines as `dump` answers with, and more than the reader looks at to find the separator.
auto dumped(int lines) -> std::string {
  std::string text;
  for (int i = 0; i < lines; ++i) {
    text += "joint0.parameter" + std::to_string(i) + " = 0.5 Nm/rad\n";
  }
  return text;
}

const std::string kGzip =
    "\x1F\x8B\x08\x00\x00\x00\x00\x00\x02\x03\x2B\xC9\xCC\x4D\x8D\x2F\xD6\x49\xE4\x32\xD0\x31\xE4\x32\xD4\x31\xE2\x02"
    "\x00\x60\x55\xA7\xAA\x11\x00\x00\x00"s;  // "time_s,a\n0,1\n1,2\n"

class ReadableLog : public testing::TestWithParam<FileCase> {};

TEST_P(ReadableLog, HasTheSameNumbersAndSaysWhatWasDone) {
  const CsvLog log = CsvLog::parse(GetParam().bytes, "x.csv");
  EXPECT_EQ(log.time(), Eigen::Vector3d(0.0, 0.01, 0.02));
  EXPECT_EQ(log.column("axis0/q1_rad"), Eigen::Vector3d(1.5, -2.0, 3.0));
  std::string notes;
  for (const auto& note : log.warnings()) {
    notes += note + "\n";
  }
  const std::string expected = GetParam().expected;
  EXPECT_NE(notes.find(expected), std::string::npos) << notes;
  EXPECT_EQ(notes.empty(), expected.empty()) << notes;
}

INSTANTIATE_TEST_SUITE_P(
    Logs, ReadableLog,
    testing::Values(
        FileCase{"by the contract", kPlain, ""},
        FileCase{"semicolons", "time_s;axis0/q1_rad\n0;1.5\n0.01;-2\n0.02;3\n", "semicolons"},
        FileCase{"semicolons and decimal commas", "time_s;axis0/q1_rad\n0;1,5\n0,01;-2\n0,02;3,0\n", "decimal commas"},
        FileCase{"tabs", "time_s\taxis0/q1_rad\n0\t1.5\n0.01\t-2\n0.02\t3\n", "tabs"},
        FileCase{"blanks", "time_s   axis0/q1_rad\n0  1.5\n0.01 -2\n  0.02   3\n", "blanks"},
        FileCase{"names with blanks between wide blanks", "Time [s]   axis0/q1 [rad]\n0  1.5\n0.01  -2\n0.02   3\n",
                 "blanks"},
        FileCase{"quotes", "\"time_s\",\"axis0/q1_rad\"\n\"0\",\"1.5\"\n\"0.01\",\"-2\"\n\"0.02\",\"3\"\n", ""},
        FileCase{"quotes with decimal commas",
                 "time_s,axis0/q1_rad\n\"0\",\"1,5\"\n\"0,01\",\"-2\"\n\"0,02\",\"3,0\"\n", "decimal commas"},
        FileCase{"a doubled quote in an unused cell",
                 "time_s,axis0/q1_rad,remark\n0,1.5,\"a \"\"b\"\", c\"\n0.01,-2,\n0.02,3,\n", ""},
        FileCase{"a row of units", "time_s,axis0/q1_rad\ns,rad\n0,1.5\n0.01,-2\n0.02,3\n", "units in line 2"},
        FileCase{"a preamble", "Device: motor 7\nDate;2026\n\ntime_s;axis0/q1_rad\n0;1.5\n0.01;-2\n0.02;3\n",
                 "column names in line 4"},
        FileCase{"names in a remark, as numpy.savetxt has them", "# time_s axis0/q1_rad\n0 1.5\n0.01 -2\n0.02 3\n",
                 "blanks"},
        FileCase{"a separator at each line's end", "time_s,axis0/q1_rad,\n0,1.5,\n0.01,-2,\n0.02,3,\n", ""},
        FileCase{"units in brackets", "Time [s],axis0/q1 [rad]\n0,1.5\n0.01,-2\n0.02,3\n",
                 "Time [s] is read as time_s"},
        FileCase{"milliseconds", "Time (ms),axis0/q1_rad\n0,1.5\n10,-2\n20,3\n",
                 "Time (ms) is read as time_s (times 0.001)"},
        FileCase{"times with dates",
                 "time_s,axis0/q1_rad\n2026-11-22T23:59:59.990Z,1.5\n2026-11-23T00:00:00.000Z,-2\n2026-11-23 "
                 "00:00:00.010,3\n",
                 ""},
        FileCase{"times of day past midnight", "time_s,axis0/q1_rad\n23:59:59.99,1.5\n00:00:00.00,-2\n00:00:00.01,3\n",
                 ""},
        FileCase{"times with dots and offsets",
                 "time_s;axis0/q1_rad\n22.11.2026 05:00:00,00+02:00;1.5\n22.11.2026 03:00:00,01;-2\n22.11.2026 "
                 "03:00:00,02;3\n",
                 "semicolons"},
        FileCase{"what a prompt answered",
                 "ok\n12 parameters\nok\n" + kPlain + "ok\ncapstan 0.1.0 board sim joints 1\nok\n", ""},
        FileCase{"a board's parameters before its rows, as the page keeps them", dumped(400) + kPlain, ""},
        FileCase{"a prompt's log with an error after it", kPlain + "error unknown_command: no such command\nok\n",
                 "x.csv:5: the board answered 'error unknown_command"},
        FileCase{"bars", "time_s|axis0/q1_rad\n0|1.5\n0.01|-2\n0.02|3\n", "bars"},
        FileCase{"a blank line after each row", "time_s,axis0/q1_rad\n\n0,1.5\n\n0.01,-2\n\n0.02,3\n\n", ""},
        FileCase{"names in a remark of MATLAB's", "% time_s,axis0/q1_rad\n0,1.5\n0.01,-2\n0.02,3\n", ""},
        FileCase{"a row of types", "time_s,axis0/q1_rad\ndouble,double\n0,1.5\n0.01,-2\n0.02,3\n", ""},
        FileCase{"rows of types and of units", "time,axis0/q1\ndouble,double\ns,rad\n0,1.5\n0.01,-2\n0.02,3\n",
                 "units in line 3"},
        FileCase{"zero bytes at the end", kPlain + std::string(64, '\0'), "64 zero bytes"},
        FileCase{"dates with slashes, the year first",
                 "time_s,axis0/q1_rad\n2026/11/22 05:00:00,1.5\n2026/11/22 05:00:00.01,-2\n2026/11/22 05:00:00.02,3\n",
                 ""},
        FileCase{"twice twelve hours", "time_s,axis0/q1_rad\n11:59:59.99 AM,1.5\n12:00:00.00 PM,-2\n12:00:00.01 PM,3\n",
                 ""},
        FileCase{"midnight of twice twelve hours",
                 "time_s,axis0/q1_rad\n11:59:59.99 PM,1.5\n12:00:00.00 AM,-2\n12:00:00.01 AM,3\n", ""},
        FileCase{"minutes and seconds", "time_s,axis0/q1_rad\n01:59.99,1.5\n02:00.00,-2\n02:00.01,3\n", ""},
        FileCase{"UTF-16 with a mark", utf16(kPlain, false, true), ""},
        FileCase{"UTF-16 big endian", utf16(kPlain, true, true), ""},
        FileCase{"UTF-16 without a mark", utf16(kPlain, false, false), ""},
        FileCase{"Latin-1", "time_s,axis0/q1_rad,\xE4\n0,1.5,0\n0.01,-2,0\n0.02,3,0\n", "Latin-1"},
        FileCase{"carriage returns alone", "time_s,axis0/q1_rad\r0,1.5\r0.01,-2\r0.02,3\r", ""},
        FileCase{"Zstandard", packed(Codec::kZstd, kPlain), ""}, FileCase{"LZ4", packed(Codec::kLz4, kPlain), ""},
        FileCase{"two packed pieces",
                 packed(Codec::kZstd, kPlain.substr(0, 25)) + packed(Codec::kZstd, kPlain.substr(25)), ""}));

TEST(Logs, GzipIsUnpacked) {
  EXPECT_EQ(CsvLog::parse(kGzip, "x.csv.gz").column("a"), Eigen::Vector2d(1.0, 2.0));
}

TEST(Logs, DegreesInAHeaderAreReadAsRadians) {
  const CsvLog log = CsvLog::parse("time_s,axis0/q1 [deg]\n0,180\n1,-90\n", "x.csv");
  EXPECT_NEAR(log.column("axis0/q1_rad")[0], 3.14159265358979, 1e-12);
  ASSERT_EQ(log.warnings().size(), 1U);
  EXPECT_NE(log.warnings()[0].find("axis0/q1 [deg] is read as axis0/q1_rad (times 0.0174533)"), std::string::npos);
}

TEST(Logs, WhatTwoColumnsCouldBeIsNotGuessed) {
  const CsvLog log = CsvLog::parse("time_s,axis0/q1 [deg],axis0/q1 [mrad]\n0,180,1\n1,-90,2\n", "x.csv");
  EXPECT_THROW(static_cast<void>(log.column("axis0/q1_rad")), BadInput);
}

class RefusedLog : public testing::TestWithParam<FileCase> {};

TEST_P(RefusedLog, NamesTheCauseAndTheCure) {
  try {
    const CsvLog log = CsvLog::parse(GetParam().bytes, "x.csv");
    static_cast<void>(log.time());
    static_cast<void>(log.column("axis0/q1_rad"));
    FAIL() << "was read";
  } catch (const BadInput& refusal) {
    const std::string message = refusal.what();
    EXPECT_NE(message.find(GetParam().expected), std::string::npos) << message;
    EXPECT_TRUE(message.starts_with("x.csv:")) << message;
    EXPECT_NE(message.find("; "), std::string::npos) << "no cure: " << message;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Logs, RefusedLog,
    testing::Values(
        FileCase{"empty", "", "no data rows"},
        FileCase{"decimal commas between commas", "time_s,axis0/q1_rad\n0,00,1,5\n0,01,2,5\n0,02,3,5\n",
                 "`sed -E 2',$ s/"},
        FileCase{"thousands", "time_s;axis0/q1_rad\n0;1.234,5\n1;2.234,5\n", "`tr -d . < x.csv > log.csv`"},
        FileCase{"thousands by commas", "time_s;axis0/q1_rad\n0.0;1,234.5\n1.0;2,234.5\n",
                 "`tr -d , < x.csv > log.csv` if the points"},
        FileCase{"both points and commas", "time_s;axis0/q1_rad\n0.00;1,5\n0.01;2,5\n0.02;3,5\n",
                 "`tr , . < x.csv > log.csv`"},
        FileCase{"two logs of one prompt", kPlain + "ok\n" + kPlain + "ok\n", "x.csv:6: a second log begins here"},
        FileCase{"an open quote", "time_s,axis0/q1_rad\n0,\"1\n1,2\n", "x.csv:2: a quote is opened"},
        FileCase{"no names", "0;1\n1;2\n", "put the column names there"},
        FileCase{"dates with slashes", "time_s,axis0/q1_rad\n11/22/2026 05:00:00,1\n11/22/2026 05:00:01,2\n",
                 "'11/22/2026 05:00:00'"},
        FileCase{"dates with slashes, the year last",
                 "time_s,axis0/q1_rad\n11/12/2026 05:00:00,1\n11/12/2026 05:00:01,2\n",
                 "which number is the day and which the month; write it as 2026-11-22"},
        FileCase{"times of whole seconds", "time_s,axis0/q1_rad\n05:00:03,1\n05:00:03,2\n05:00:04,2\n",
                 "x.csv:3: time_s repeats 0, as the times have no fractions of a second; export"},
        FileCase{"Fortran's exponents", "time_s,axis0/q1_rad\n0,1.5D+00\n1,-2.0D-01\n", "Fortran's exponents"},
        FileCase{"a broken time of day", "time_s,axis0/q1_rad\n05:00:00.0,1\n05:00:00.1,2\nlater,2\n5:0,2\n",
                 "x.csv:4: column time_s holds 'later'"},
        FileCase{"a zip archive", "PK\x03\x04 and so on", "`unzip x.csv`"},
        FileCase{"bzip2", "BZh91AY", "`bunzip2 -k x.csv`"},
        FileCase{"xz",
                 "\xFD"
                 "7zXZ\0"s,
                 "`xz -dk x.csv`"},
        FileCase{"HDF5", "\x89HDF\r\n", "pandas.read_hdf('x.csv')"},
        FileCase{"MATLAB", "MATLAB 5.0 MAT-file", "`writetable(T, 'log.csv')`"},
        FileCase{"a ROS 1 bag", "#ROSBAG V2.0\n", "`rostopic echo -b x.csv"},
        FileCase{"a ROS 2 bag", "SQLite format 3\0"s, "is a database, as ROS 2 bags"},
        FileCase{"binary", "time_s,a\n\x01\0\x02"s, "the file is binary"},
        FileCase{"JSON", "  {\"time_s\": [0, 1]}\n", "the file is JSON"},
        FileCase{"a list of JSON in one line", "[{\"time_s\": 0}, {\"time_s\": 1}]",
                 "pandas.read_json('x.csv').to_csv"},
        FileCase{"lines of JSON", "{\"time_s\": 0}\n{\"time_s\": 1}\n", "pandas.read_json('x.csv', lines=True)"},
        FileCase{"a tar archive", std::string(257, 'x') + "ustar  and so on", "`tar -xf x.csv`"},
        FileCase{"zero bytes in the middle", kPlain + "\0\0\0\0\0"s + kPlain, "the file is binary"},
        FileCase{"a web page", "<html><body>404</body></html>\n", "XML or HTML"},
        FileCase{"gzip that ends early", kGzip.substr(0, 24), "`gzip -dc x.csv > log.csv`"},
        FileCase{"gzip that is damaged", kGzip.substr(0, 20) + "\xFF\xFF\xFF" + kGzip.substr(23), "it is damaged"},
        FileCase{"Zstandard that ends early", packed(Codec::kZstd, kPlain).substr(0, 20), "it ends in the middle"},
        FileCase{"LZ4 that ends early", packed(Codec::kLz4, kPlain).substr(0, 20), "it ends in the middle"}));

auto refusal_of(const std::string& text) -> std::string {
  try {
    static_cast<void>(CsvLog::parse(text, "x.csv").column_with_gaps("axis0/q1_rad"));
  } catch (const BadInput& refusal) {
    return refusal.what();
  }
  return "";
}

/// What the sed command of a refusal makes of a line. @param mark  around pattern and replacement
auto cured(const std::string& line, const std::string& refusal, char mark) -> std::string {
  const auto from = refusal.find(std::string("s") + mark) + 2;
  const auto middle = refusal.find(mark, from);
  std::string replacement = refusal.substr(middle + 1, refusal.find(mark, middle + 1) - middle - 1);
  std::replace(replacement.begin(), replacement.end(), '\\', '$');
  return std::regex_replace(line, std::regex(refusal.substr(from, middle - from)), replacement);
}

TEST(Logs, DecimalCommasBetweenCommasAreCuredWhereEachNumberHasOneAndElseNotGuessed) {
  const std::string each = refusal_of("time_s,axis0/q1_rad\n0,00,1,5e-3\n0,01,-2,5\n0,02,3,5\n");
  EXPECT_EQ(cured("0,00,1,5e-3", each, '/'), "0.00,1.5e-3");
  EXPECT_EQ(cured("0,01,-2,5", each, '/'), "0.01,-2.5");
  for (const char* text : {"time_s,axis0/q1_rad\n0,1,5\n0,01,2,5\n0,02,3,5\n",      // a time of zero
                           "time_s,axis0/q1_rad\n0,00,1,5\n0,01,2,5\n0,02,3\n"}) {  // an angle of three
    const std::string some = refusal_of(text);
    EXPECT_EQ(some.find("sed"), std::string::npos) << some;
    EXPECT_NE(some.find("export with semicolons"), std::string::npos) << some;
  }
}

TEST(Logs, CellsThatSayThatNothingWasMeasuredAreCuredByEmptyOnes) {
  for (const char* word : {"nan", "NaN", "NA", "N/A", "null", "None"}) {
    const std::string row = std::string("1,") + word;
    const std::string refusal = refusal_of("time_s,axis0/q1_rad\n0,1\n" + row + "\n2,3\n");
    EXPECT_EQ(cured(row, refusal, '#'), "1,") << refusal;
  }
}

TEST(Logs, RowsThatBeginWithoutMeasuredValuesAreNoNames) {
  const CsvLog log = CsvLog::parse("time_s,a,b,c\n0,NA,null,NA\n1,2,3,4\n", "x.csv");
  EXPECT_EQ(log.rows(), 2U);
  EXPECT_EQ(log.column_names(), (std::vector<std::string>{"time_s", "a", "b", "c"}));
}

TEST(Logs, AMappedColumnsUnitIsRead) {
  const std::string text = "t_ms,Torque [mNm],Motor (deg),speed_mm\n0,500,180,1\n10,-250,-90,2\n";
  const CsvLog log = CsvLog::parse(text, "x.csv",
                                   parse_mappings({"time_s=t_ms", "axis0/tau_Nm=Torque [mNm]",
                                                   "axis0/q1_rad=Motor (deg)", "axis0/q2_rad=speed_mm"}));
  EXPECT_EQ(log.time()[1], 0.01);
  EXPECT_EQ(log.column("axis0/tau_Nm"), Eigen::Vector2d(0.5, -0.25));
  EXPECT_NEAR(log.column("axis0/q1_rad")[0], 3.14159265358979, 1e-12);
  EXPECT_EQ(log.column("axis0/q2_rad")[1], 2.0);  // a length is no angle
  ASSERT_EQ(log.warnings().size(), 3U);
  EXPECT_NE(log.warnings()[1].find("Torque [mNm] is read as axis0/tau_Nm (times 0.001)"), std::string::npos);
  for (const char* factor : {"1", "0.002"}) {
    const CsvLog given =
        CsvLog::parse(text, "x.csv", parse_mappings({std::string("axis0/tau_Nm=Torque [mNm]*") + factor}));
    EXPECT_EQ(given.column("axis0/tau_Nm")[0], 500.0 * *parse_number(factor));
    ASSERT_EQ(given.warnings().size(), 1U);
    EXPECT_NE(given.warnings()[0].find("t_ms is read as time_s"), std::string::npos);
  }
}

/// Between two texts, each time they occur.
auto all_between(const std::string& text, const std::string& open, const std::string& close)
    -> std::vector<std::string> {
  std::vector<std::string> found;
  for (auto at = text.find(open); at != std::string::npos; at = text.find(open, at)) {
    at += open.size();
    found.push_back(text.substr(at, text.find(close, at) - at));
  }
  return found;
}

TEST(Logs, TheExamplesOfTheManualWork) {
  const std::string page = read_text_file(std::string(CAPSTAN_SOURCE_DIR) + "/docs/logs.md");
  const std::string log =
      "stamp;motor;camera;current;left;right;i_a;i_b;Elbow angle "
      "[deg];Zeit\n0;1;2;3;4;5;6;7;8;9\n1;1;2;3;4;5;6;7;8;9\n";
  const auto examples = all_between(page, "--map \"", "\"");
  EXPECT_GE(examples.size(), 5U);
  for (const auto& example : examples) {
    const auto mapping = parse_mapping(example);
    const CsvLog csv = CsvLog::parse(log, "x.csv", {mapping});
    EXPECT_TRUE(csv.column(mapping.wanted).allFinite()) << example;
  }
  for (const auto& time : all_between(page, "times such as `", "`")) {
    const CsvLog csv = CsvLog::parse("time_s;a\n" + time + ";1\n", "x.csv");
    EXPECT_EQ(csv.time()[0], 0.0) << time;
  }
}

TEST(Compression, WhatUnpacksToMoreThanIsAllowedIsRefusedNotStored) {
  const std::string zeros(1000000, '0');
  for (const Codec codec : {Codec::kZstd, Codec::kLz4}) {
    const std::string small = packed(codec, zeros);
    EXPECT_LT(small.size(), 10000U);
    EXPECT_EQ(unpacked(codec, small), zeros);
    EXPECT_THROW(unpacked(codec, small, 999999), Unpackable);
  }
}

}  // namespace
}  // namespace capstan::tools
