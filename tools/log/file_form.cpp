// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/file_form.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <tuple>

#include "capstan/tools/log/compression.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

using std::string_view_literals::operator""sv;

struct ForeignForm {
  std::string_view magic;
  const char* what;
  const char* cure;  ///< FILE stands for the file's name
};

/// What else people have at hand, by its first bytes.
constexpr std::array kForeignForms = {
    ForeignForm{"PK\x03\x04"sv, "is a zip archive or a spreadsheet (.xlsx, .ods)",
                "unpack it with `unzip FILE`, or save the sheet as CSV: `soffice --headless --convert-to csv FILE`"},
    ForeignForm{"\xD0\xCF\x11\xE0"sv, "is a spreadsheet (.xls)",
                "save the sheet as CSV: `soffice --headless --convert-to csv FILE`"},
    ForeignForm{"BZh"sv, "is packed with bzip2", "unpack it with `bunzip2 -k FILE`"},
    ForeignForm{"\xFD"
                "7zXZ"sv,
                "is packed with xz", "unpack it with `xz -dk FILE`"},
    ForeignForm{"7z\xBC\xAF"sv, "is a 7z archive", "unpack it with `7z x FILE`"},
    ForeignForm{"\x89HDF"sv, "is HDF5 (or a MATLAB file of version 7.3)",
                "write its signals as CSV, for instance with Python: `pandas.read_hdf('FILE').to_csv('log.csv', "
                "index=False)`"},
    ForeignForm{"MATLAB"sv, "is a MATLAB file", "write its table as CSV in MATLAB: `writetable(T, 'log.csv')`"},
    ForeignForm{"\x93NUMPY"sv, "is a NumPy array",
                "write it as CSV: `python3 -c \"import numpy; a = numpy.load('FILE'); numpy.savetxt('log.csv', a, "
                "delimiter=',', header='time_s,...', comments='')\"`"},
    ForeignForm{"#ROSBAG"sv, "is a ROS 1 bag", "export its topics as CSV: `rostopic echo -b FILE -p /TOPIC > log.csv`"},
    ForeignForm{"SQLite format 3"sv, "is a database, as ROS 2 bags (.db3) are",
                "play it to PlotJuggler or Foxglove and export the topics as CSV"},
    ForeignForm{"PAR1"sv, "is Apache Parquet",
                "write it as CSV: `python3 -c \"import pandas; pandas.read_parquet('FILE').to_csv('log.csv', "
                "index=False)\"`"},
    ForeignForm{"%PDF"sv, "is a PDF document", "export the log itself as CSV"},
    ForeignForm{"\x7F"
                "ELF"sv,
                "is a program", "give the log's path"},
    ForeignForm{"TDSm"sv, "is a LabVIEW measurement (.tdms)", "export it as CSV or text from LabVIEW or DIAdem"},
    ForeignForm{"MDF     "sv, "is an ASAM measurement (.mf4, .mdf)", "export it as CSV from your measuring program"},
};

auto with_file(std::string cure, const std::string& name) -> std::string {
  constexpr std::string_view kFile = "FILE";
  for (auto at = cure.find(kFile); at != std::string::npos; at = cure.find(kFile, at + name.size())) {
    cure.replace(at, kFile.size(), name);
  }
  return cure;
}

void refuse_foreign(std::string_view bytes, const std::string& name) {
  constexpr std::size_t kTarMark = 257;  // byte of a header where "ustar" stands
  if (bytes.size() > kTarMark && bytes.substr(kTarMark).starts_with("ustar")) {
    throw BadInput(name + ": the file is a tar archive, not a log; unpack it with `tar -xf " + name + "`");
  }
  for (const auto& form : kForeignForms) {
    if (bytes.starts_with(form.magic)) {
      throw BadInput(name + ": the file " + form.what + ", not a log; " + with_file(form.cure, name));
    }
  }
}

auto unwrapped(std::string bytes, const std::string& name) -> std::string {
  constexpr std::array kCodecs = {std::tuple{"\x1F\x8B"sv, Codec::kGzip, "gzip -dc"},
                                  std::tuple{"\x28\xB5\x2F\xFD"sv, Codec::kZstd, "zstd -dc"},
                                  std::tuple{"\x04\x22\x4D\x18"sv, Codec::kLz4, "lz4 -dc"}};
  for (const auto& [magic, codec, command] : kCodecs) {
    if (std::string_view(bytes).starts_with(magic)) {
      try {
        return unpacked(codec, bytes);
      } catch (const Unpackable& why) {
        throw BadInput(name + ": the packed file can not be unpacked: " + why.what() +
                       "; copy it again, or save what is left of it with `" + command + " " + name + " > log.csv`");
      }
    }
  }
  return bytes;
}

void append_utf8(std::string& text, char32_t c) {
  const auto byte = [&](char32_t value) { text += static_cast<char>(static_cast<unsigned char>(value)); };
  if (c < 0x80) {
    byte(c);
  } else if (c < 0x800) {
    byte(0xC0 | c >> 6U);
    byte(0x80 | (c & 0x3F));
  } else if (c < 0x10000) {
    byte(0xE0 | c >> 12U);
    byte(0x80 | (c >> 6U & 0x3F));
    byte(0x80 | (c & 0x3F));
  } else {
    byte(0xF0 | c >> 18U);
    byte(0x80 | (c >> 12U & 0x3F));
    byte(0x80 | (c >> 6U & 0x3F));
    byte(0x80 | (c & 0x3F));
  }
}

/// A half of a pair without the other becomes the replacement character.
auto from_utf16(std::string_view bytes, bool big_endian) -> std::string {
  const auto unit = [&](std::size_t at) {
    const auto first = static_cast<unsigned char>(bytes[at]);
    const auto second = static_cast<unsigned char>(bytes[at + 1]);
    return static_cast<char32_t>(big_endian ? first << 8U | second : second << 8U | first);
  };
  constexpr char32_t kReplacement = 0xFFFD;
  std::string text;
  for (std::size_t at = 0; at + 1 < bytes.size(); at += 2) {
    char32_t c = unit(at);
    const bool high = c >= 0xD800 && c < 0xDC00;
    const char32_t low = high && at + 3 < bytes.size() ? unit(at + 2) : 0;
    if (low >= 0xDC00 && low < 0xE000) {
      c = 0x10000 + ((c - 0xD800) << 10U) + (low - 0xDC00);
      at += 2;
    } else if (c >= 0xD800 && c < 0xE000) {
      c = kReplacement;
    }
    append_utf8(text, c);
  }
  return text;
}

/// Of text in two-byte units without a mark every other byte is zero, as digits and commas are.
auto utf16_byte_order(std::string_view bytes) -> std::optional<bool> {
  constexpr std::size_t kLooked = 400;
  std::array<std::size_t, 2> zeros{};
  const std::size_t looked = std::min(bytes.size() & ~std::size_t{1}, kLooked);
  for (std::size_t i = 0; i < looked; ++i) {
    zeros[i % 2] += bytes[i] == '\0' ? 1 : 0;
  }
  if (looked >= 8 && zeros[0] * 10 >= looked * 4 && zeros[1] == 0) {
    return true;
  }
  if (looked >= 8 && zeros[1] * 10 >= looked * 4 && zeros[0] == 0) {
    return false;
  }
  return std::nullopt;
}

auto continuation_bytes(unsigned char lead) -> int {
  if (lead < 0x80) {
    return 0;
  }
  if (lead >= 0xC2 && lead < 0xE0) {
    return 1;
  }
  if (lead >= 0xE0 && lead < 0xF0) {
    return 2;
  }
  return lead >= 0xF0 && lead < 0xF5 ? 3 : -1;
}

auto is_utf8(std::string_view text) -> bool {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const int more = continuation_bytes(lead);
    if (more < 0 || i + static_cast<std::size_t>(more) >= text.size() + (more == 0 ? 1 : 0)) {
      return false;
    }
    for (int k = 0; k < more; ++k) {
      const auto next = static_cast<unsigned char>(text[++i]);
      const bool overlong_or_surrogate = k == 0 && ((lead == 0xE0 && next < 0xA0) || (lead == 0xED && next > 0x9F) ||
                                                    (lead == 0xF0 && next < 0x90) || (lead == 0xF4 && next > 0x8F));
      if ((next & 0xC0U) != 0x80U || overlong_or_surrogate) {
        return false;
      }
    }
  }
  return true;
}

auto from_latin1(std::string_view bytes) -> std::string {
  std::string text;
  for (const char c : bytes) {
    append_utf8(text, static_cast<unsigned char>(c));
  }
  return text;
}

/// JSON, XML and web pages. JSON lines have an object in each.
void refuse_trees(std::string_view text, const std::string& name) {
  constexpr std::string_view kBlank = " \t\r\n";
  const std::size_t first = std::min(text.find_first_not_of(kBlank), text.size());
  const std::string_view body = text.substr(first);
  const std::size_t inside = std::min(body.find_first_not_of(kBlank, 1), body.size());
  const bool list = body.starts_with('[') && inside < body.size() && (body[inside] == '{' || body[inside] == '[');
  const bool json = body.starts_with('{') || list;
  if (!json && !body.starts_with('<')) {
    return;
  }
  const bool lines = body.starts_with('{') && body.find("\n{") != std::string_view::npos;
  throw BadInput(name + ": the file is " + (json ? "JSON" : "XML or HTML") +
                 ", not CSV; write one row per sample, for instance with Python: `pandas.read_" +
                 (json ? "json" : "xml") + "('" + name + (lines ? "', lines=True" : "'") +
                 ").to_csv('log.csv', index=False)`");
}

}  // namespace

auto text_of_file(std::string bytes, const std::string& name, std::vector<std::string>& notes) -> std::string {
  refuse_foreign(bytes, name);
  std::string text = unwrapped(std::move(bytes), name);
  refuse_foreign(text, name);
  if (text.starts_with("\xFF\xFE"sv) || text.starts_with("\xFE\xFF"sv)) {
    text = from_utf16(std::string_view(text).substr(2), text[0] == '\xFE');
  } else if (const auto big_endian = utf16_byte_order(text)) {
    text = from_utf16(text, *big_endian);
  }
  if (text.starts_with("\xEF\xBB\xBF"sv)) {
    text.erase(0, 3);
  }
  constexpr std::size_t kFewestZeros = 4;  // a text in two-byte units ends in one
  const std::size_t end = text.find_last_not_of('\0') + 1;
  if (text.size() - end >= kFewestZeros && text.find('\0') == end && text.find('\n') < end) {
    notes.push_back(name + ": the file ends in " + std::to_string(text.size() - end) +
                    " zero bytes, as where the power went while it was written; they were dropped");
    text.erase(end);
  }
  if (text.find('\0') != std::string::npos) {
    throw BadInput(name + ": the file is binary, not text; export the log as CSV, and look at it with `head -c 300 " +
                   name + " | xxd`");
  }
  if (!is_utf8(text)) {
    text = from_latin1(text);
    notes.push_back(name + ": the text is not UTF-8 and was read as Latin-1");
  }
  if (text.find('\n') == std::string::npos) {
    std::replace(text.begin(), text.end(), '\r', '\n');
  }
  refuse_trees(text, name);
  return text;
}

}  // namespace capstan::tools
