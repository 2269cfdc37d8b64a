// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/linux_rt/options.hpp"

#include <getopt.h>

#include <array>
#include <charconv>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "capstan/boards/linux_rt/hardware_options.hpp"

namespace capstan {
namespace {

enum Code : int {
  kConsole = 1000,
  kStorage,
  kCpu,
  kPriority,
  kInsist,
  kFor,
  kCan,
  kPdo,
  kProfile,
  kFd,
  kGpio,
  kSimulatedDrives,
  kSelftest,
  kHelp,
  kVersion
};

constexpr std::array<option, 16> kOptions{{{"console", required_argument, nullptr, kConsole},
                                           {"storage", required_argument, nullptr, kStorage},
                                           {"cpu", required_argument, nullptr, kCpu},
                                           {"priority", required_argument, nullptr, kPriority},
                                           {"insist", no_argument, nullptr, kInsist},
                                           {"for", required_argument, nullptr, kFor},
                                           {"can", required_argument, nullptr, kCan},
                                           {"pdo", required_argument, nullptr, kPdo},
                                           {"profile", required_argument, nullptr, kProfile},
                                           {"fd", no_argument, nullptr, kFd},
                                           {"gpio", required_argument, nullptr, kGpio},
                                           {"simulated-drives", no_argument, nullptr, kSimulatedDrives},
                                           {"selftest", no_argument, nullptr, kSelftest},
                                           {"help", no_argument, nullptr, kHelp},
                                           {"version", no_argument, nullptr, kVersion},
                                           {nullptr, 0, nullptr, 0}}};

auto quoted(std::string_view text) -> std::string {
  return std::string(1, '\'').append(text).append(1, '\'');
}

template <typename T>
auto number(const char* name, std::string_view text, T lowest, T highest) -> T {
  T value{};
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc{} || end != text.data() + text.size() || !(value >= lowest && value <= highest)) {
    throw std::runtime_error(quoted(text) + " is no value for --" + name + "; give a number from " +
                             std::to_string(lowest) + " to " + std::to_string(highest));
  }
  return value;
}

void apply(int code, BoardOptions& options) {
  constexpr int kMostCpus = 1023;
  constexpr double kShortestS = 0.1;
  constexpr double kLongestS = 1e7;
  switch (code) {
    case kConsole:
      options.console = optarg;
      break;
    case kStorage:
      options.storage = optarg;
      break;
    case kCpu:
      options.rt.cpu = number("cpu", optarg, 0, kMostCpus);
      break;
    case kPriority:
      options.rt.priority = number("priority", optarg, 1, 99);
      break;
    case kInsist:
      options.rt.insist = true;
      break;
    case kFor:
      options.seconds = number("for", optarg, kShortestS, kLongestS);
      break;
    case kCan:
      options.can.buses.push_back(parse_can_bus(optarg));
      break;
    case kPdo:
      options.can.layout = parse_pdo_layout(optarg);
      break;
    case kProfile:
      options.can.profiles.push_back(read_drive_profile(optarg));
      break;
    case kFd:
      options.can.fd = true;
      break;
    case kGpio:
      if (!options.gpio.chip.empty()) {
        throw std::runtime_error("--gpio is given twice; name all lines in one, they have to be of one chip");
      }
      options.gpio = parse_gpio(optarg);
      break;
    case kSimulatedDrives:
      options.simulated_drives = true;
      break;
    case kSelftest:
      options.action = BoardOptions::Action::kSelftest;
      break;
    case kHelp:
      options.action = BoardOptions::Action::kHelp;
      break;
    case kVersion:
      options.action = BoardOptions::Action::kVersion;
      break;
    default:
      break;
  }
}

}  // namespace

auto parse_options(std::span<char* const> arguments) -> BoardOptions {
  BoardOptions options;
  // A copy, because getopt_long sorts its arguments; its own messages are off, ours name the cure.
  std::vector<char*> words(arguments.begin(), arguments.end());
  words.push_back(nullptr);
  opterr = 0;
  optind = 0;
  const int count = static_cast<int>(arguments.size());
  for (;;) {
    const int at = optind == 0 ? 1 : optind;
    const int code = getopt_long(count, words.data(), ":", kOptions.data(), nullptr);
    if (code == -1) {
      break;
    }
    if (code == ':') {
      throw std::runtime_error(std::string(words[static_cast<std::size_t>(at)]) + " needs a value; --help shows which");
    }
    if (code == '?') {
      throw std::runtime_error("There is no option " + std::string(words[static_cast<std::size_t>(at)]) +
                               ", or it takes no value; --help lists all of them");
    }
    apply(code, options);
  }
  if (optind < count) {
    throw std::runtime_error(quoted(words[static_cast<std::size_t>(optind)]) +
                             " is not an option; --help lists all of them");
  }
  options.can.watchdog = options.gpio.watchdog.has_value();
  check(options.can);
  if (options.action == BoardOptions::Action::kSelftest && !options.can.buses.empty()) {
    throw std::runtime_error("--selftest moves a joint by itself, so only the simulated one; leave out --can");
  }
  if (options.can.buses.empty() && (options.gpio.brake || options.gpio.enable || options.gpio.watchdog)) {
    throw std::runtime_error(
        "Without --can the joint is simulated, and brake, enable or watchdog of --gpio would release a real one that "
        "nobody drives; leave them out, or name the drives with --can");
  }
  if (options.action == BoardOptions::Action::kSelftest && options.gpio.estop) {
    throw std::runtime_error("--selftest arms once, before an emergency stop counts as closed; leave out --gpio");
  }
  return options;
}

auto help_text() -> const char* {
  return R"(capstan_linux_rt: the Capstan firmware on Linux, 1 kHz in a real-time thread

Without --can the joint is the simulated plant inside this program, in lock-step with the cycle.

  --can BUS:N[,N...]
                    CiA 402 drives with these node numbers on this interface (can0), or on unix:PATH where
                    capstan_drives listens; up to four on up to two buses (repeat it), joint0 is the first
  --pdo separate|packed
                    a message with set values for each drive (separate), or one for all drives of a bus
  --profile FILE    where drives on these buses differ from the standard (repeatable; profiles of some makers' drives
                    are built in, see hal/cia402/profiles)
  --fd              set values in CAN FD frames
  --gpio CHIP:DUTY=LINE[,...]
                    lines of a GPIO chip (/dev/gpiochip0); duties: estop (input, high: closed), enable, brake (high:
                    open), watchdog (square wave while the cycle runs); ! before a number inverts it; all
                    but estop only with --can
  --simulated-drives
                    the drives on the buses are simulated by capstan_drives: torque without commissioned motor observers

  --console stdio|pty|tcp:PORT|serial:PATH
                    where the shell is served (stdio); tcp listens on this machine only, serial is 115200 8N1
  --storage FILE    keeps parameters over restarts, made if it does not exist, and in FILE.faults beside it the fault
                    log; without it both last until the end
  --for SECONDS     ends after this time; without it at the end of standard input, by Ctrl-C or SIGTERM
  --cpu N           keeps the real-time thread on this processor
  --priority N      priority in SCHED_FIFO, 1 to 99 (80)
  --insist          refuses to run without real-time priority and locked memory
  --selftest        runs the cycle with a moving joint (10 s, or as --for says) and prints latency histograms,
                    page faults, missed cycles, kernel and a verdict
  --version
  --help

Exit status: 0 done, 1 the self-test failed, 2 bad option or the board could not start.
)";
}

}  // namespace capstan
