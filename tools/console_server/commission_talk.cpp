// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/console_server/commission_talk.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <nlohmann/json.hpp>

#include "capstan/boards/common/terminal_mode.hpp"
#include "capstan/hal/linux/file_descriptor.hpp"
#include "capstan/tools/console_server/program_line.hpp"
#include "capstan/tools/console_server/self_process.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

using nlohmann::json;
constexpr std::string_view kCommission = "commission ";
constexpr std::string_view kStart = "start ";
constexpr std::string_view kReport = "commission_report";
constexpr std::string_view kResponse = "response/index.html";
constexpr std::string_view kQuestionEnd = " [y/N] ";
constexpr std::chrono::milliseconds kQuiet{200};  // after the torque was taken away: then no answer is under way
constexpr std::chrono::seconds kPatience{2};  // with a board that goes on talking; the program then says why it can not
constexpr std::chrono::seconds kKilledAfter{20};  // it puts parameters back meanwhile

/// What a page asks for, as the program's words. Throws std::exception where it is none.
auto words_of(const json& asked, const std::string& port, const TemporaryFolder& folder) -> std::vector<std::string> {
  std::vector<std::string> words = {"capstan",
                                    "commission",
                                    port,
                                    "--axis=" + std::to_string(asked.at("axis").get<int>()),
                                    "--corridor=" + json(asked.at("corridor").get<double>()).dump(),
                                    "--state=" + folder.file("commission.txt"),
                                    "--machine=" + folder.file("machine.toml"),
                                    "--report=" + folder.file("report")};
  if (asked.contains("inertia")) {
    words.push_back("--inertia=" + json(asked.at("inertia").get<double>()).dump());
  }
  if (const std::string key = asked.value("key", ""); !key.empty()) {
    words.push_back("--key=" + key);
  }
  if (asked.value("again", false)) {
    words.emplace_back("--again");
  }
  return words;
}

struct Pipe {
  FileDescriptor out, in;
  Pipe() {
    std::array<int, 2> ends{-1, -1};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
      throw Refusal("no pipe can be opened; end other programs and try again");
    }
    out = FileDescriptor(ends[0]);
    in = FileDescriptor(ends[1]);
  }
};

}  // namespace

/// The program, while there is one; to the hub it is one more guest.
class CommissionTalk::Job final : public Guest {
 public:
  Job(boost::asio::io_context& io, Hub& hub) : io_(io), hub_(hub), process_(io) {}
  ~Job() override { close(); }

  /// Takes the command; the program begins when the board is quiet. Throws std::exception with a sentence.
  void begin(Guest& page, std::string_view asked, Clock::time_point now) {
    const json wanted = json::parse(asked);
    master_ = FileDescriptor(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
    std::array<char, 64> name{};
    if (!master_ || ::grantpt(master_.get()) != 0 || ::unlockpt(master_.get()) != 0 ||
        ::ptsname_r(master_.get(), name.data(), name.size()) != 0) {
      throw Refusal("no pseudo-terminal can be opened; end other programs and try again");
    }
    slave_ = FileDescriptor(::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));  // stays, so that its end is no error
    make_raw(slave_.get());
    words_ = words_of(wanted, name.data(), folder_);
    page_ = &page;
    alive_ = began_ = heard_ = now;
    stopped_.reset();
    hub_.join(*this, now);
    hub_.word(*this, "take", now);
  }
  [[nodiscard]] auto under_way() const -> bool { return page_ != nullptr || process_.running(); }
  [[nodiscard]] auto belongs_to(const Guest& page) const -> bool { return page_ == &page; }
  void page_is_there(Clock::time_point now) { alive_ = now; }
  void page_left() { page_ = nullptr; }

  void answer(bool yes) {
    if (asks_ && input_) {
      asks_ = false;
      input_->send(yes ? "y\n" : "n\n");
    }
  }
  /// Takes the torque away and lets the program put back what it changed.
  void stop(Clock::time_point now) {
    if (!under_way() || stopped_) {
      return;
    }
    stopped_ = now;
    hub_.word(*this, "disarm", now);
    process_.signal(SIGINT);
    if (!process_.running()) {
      words_.clear();
      finish(kExitRefused);
    }
  }
  void look(Clock::time_point now) {
    if (!under_way()) {
      return;
    }
    hub_.word(*this, "alive", now);
    if (page_ == nullptr || now - alive_ > Hub::kAliveWithin) {
      stop(now);
    }
    if (stopped_ && now - *stopped_ > kKilledAfter) {
      process_.signal(SIGKILL);
    }
    if (!words_.empty() && (now - heard_ > kQuiet || now - began_ > kPatience)) {
      run();
    }
  }
  [[nodiscard]] auto report(std::string_view name) const -> std::optional<std::string> {
    const std::filesystem::path folder = "report";
    return name == kReport     ? folder_.text(folder / "index.html")
           : name == kResponse ? folder_.text(folder / kResponse)
                               : std::nullopt;
  }

  // The board, to the program.
  void bytes(std::string_view bytes) override {
    heard_ = Clock::now();
    if (board_) {
      board_->send(bytes);
    }
  }
  [[nodiscard]] auto behind() const -> bool override { return board_ && board_->behind(); }
  void say(std::string_view words) override {
    if (words.starts_with("lost ")) {
      stop(Clock::now());
    }
  }

 private:
  void run() {
    Pipe to;
    Pipe from;
    const bool begun =
        process_.start(std::exchange(words_, {}), {.in = to.out.get(), .out = from.in.get(), .err = from.in.get()},
                       [this](int status) {
                         status_ = status;
                         end_if_over();
                       });
    if (!begun) {
      finish(kExitRefused);
      return;
    }
    const auto line = [this](const FileDescriptor& end, std::function<void(std::string_view)> heard) {
      return std::make_shared<ProgramLine>(io_, ::fcntl(end.get(), F_DUPFD_CLOEXEC, 0), std::move(heard));
    };
    input_ = line(to.in, [](std::string_view) {});
    output_ = line(from.out, [this](std::string_view said) { take(said); });
    board_ = line(master_, [this](std::string_view said) { hub_.bytes(*this, said); });
    output_->read();
    board_->read();
  }

  void take(std::string_view said) {
    if (said.empty()) {
      output_.reset();
      end_if_over();
      return;
    }
    said_ += said;
    for (std::size_t end = 0; (end = said_.find('\n')) != std::string::npos; said_.erase(0, end + 1)) {
      tell("said " + folder_.without_path(said_.substr(0, end)));
    }
    if (said_.ends_with(kQuestionEnd)) {
      asks_ = true;
      const std::string question = said_.substr(0, said_.size() - kQuestionEnd.size());
      said_.clear();
      tell("asks " + question.substr(std::min(question.find_first_not_of(' '), question.size())));
    }
  }
  void tell(const std::string& words) {
    if (page_ != nullptr) {
      page_->say(std::string(kCommission) + words);
    }
  }

  /// Both have to be over: what it said last may come behind its end.
  void end_if_over() {
    if (status_ && !output_) {
      finish(*std::exchange(status_, {}));
    }
  }
  void finish(int status) {
    close();
    const json found = {{"status", status},
                        {"machine", folder_.text("machine.toml").value_or("")},
                        {"response", report(kResponse).has_value()}};
    tell("ended " + found.dump());
    Guest* const page = std::exchange(page_, nullptr);
    stopped_.reset();
    hub_.leave(*this);
    if (page != nullptr) {
      hub_.word(*page, "take", Clock::now());  // the command goes back to where it came from
    }
  }
  void close() {
    for (std::shared_ptr<ProgramLine>* line : {&input_, &output_, &board_}) {
      if (*line) {
        (*line)->close();
        line->reset();
      }
    }
    said_.clear();
    asks_ = false;
  }

  boost::asio::io_context& io_;
  Hub& hub_;
  TemporaryFolder folder_;
  SelfProcess process_;
  Guest* page_ = nullptr;
  FileDescriptor master_, slave_;
  std::vector<std::string> words_;  // of the program that is to begin
  std::shared_ptr<ProgramLine> input_, output_, board_;
  std::string said_;
  bool asks_ = false;
  std::optional<int> status_;
  Clock::time_point alive_, began_, heard_;
  std::optional<Clock::time_point> stopped_;
};

CommissionTalk::CommissionTalk(boost::asio::io_context& io, Hub& hub)
    : job_(std::make_unique<Job>(io, hub)), hub_(hub) {}
CommissionTalk::~CommissionTalk() = default;

void CommissionTalk::join(Guest& guest, Clock::time_point now) {
  hub_.join(guest, now);
}

void CommissionTalk::leave(Guest& guest) {
  if (job_->belongs_to(guest)) {
    job_->stop(Clock::now());
    job_->page_left();
  }
  hub_.leave(guest);
}

void CommissionTalk::bytes(Guest& guest, std::string_view bytes) {
  hub_.bytes(guest, bytes);
}

void CommissionTalk::word(Guest& guest, std::string_view word, Clock::time_point now) {
  const bool own = job_->belongs_to(guest);
  if (word.starts_with(kCommission)) {
    const std::string_view what = word.substr(kCommission.size());
    if (what.starts_with(kStart)) {
      try {
        if (job_->under_way() || !hub_.commands(guest)) {
          throw Refusal("another commissioning is under way, or another page commands");
        }
        job_->begin(guest, what.substr(kStart.size()), now);
      } catch (const std::exception& problem) {
        guest.say(std::string(kCommission) + "said capstan: " + problem.what());
        guest.say(std::string(kCommission) + "ended " + json{{"status", kExitRefused}, {"machine", ""}}.dump());
      }
    } else if (own && what == "stop") {
      job_->stop(now);
    } else if (own) {
      job_->answer(what == "answer yes");
    }
    return;
  }
  if (job_->under_way() && (word == "disarm" || (own && word == "leave"))) {
    job_->stop(now);
  } else if (job_->under_way() && word == "take") {
    guest.say("remark # capstan commission commands the board; DISARM ends it");
    return;
  } else if (own && word == "alive") {
    job_->page_is_there(now);
  }
  hub_.word(guest, word, now);
}

void CommissionTalk::look(Clock::time_point now) {
  job_->look(now);
}

auto CommissionTalk::report(std::string_view name) const -> std::optional<std::string> {
  return job_->report(name);
}

}  // namespace capstan::tools
