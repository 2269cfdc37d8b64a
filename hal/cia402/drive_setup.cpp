// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/cia402/drive_setup.hpp"

#include <algorithm>

namespace capstan::cia402 {
namespace {

using Action = SetupStep::Action;
using Need = SetupStep::Need;
using Meaning = SetupStep::Meaning;

constexpr std::uint32_t kMostRatedMa = 127'000;  // what the firmware's numbers hold
constexpr std::size_t kFewestObjects = 2;        // that a drive's message has to carry

auto is_absent(std::uint32_t abort_code) -> bool {
  constexpr std::uint32_t kNoObject = 0x06020000;
  constexpr std::uint32_t kNoSubindex = 0x06090011;
  return abort_code == kNoObject || abort_code == kNoSubindex;
}

}  // namespace

DriveSetup::DriveSetup(const SetupTask& task, Journal& journal, std::size_t source)
    : task_(task), steps_(identity_steps()), sdo_(task.node, journal, source) {
  setting_.node = task.node;
  first_own_step_ = steps_.size();
}

void DriveSetup::enter(Phase phase) {
  phase_ = phase;
  since_.reset();
  operational_ = false;
}

void DriveSetup::note(const std::string& what) {
  notes_.push_back("Drive " + std::to_string(task_.node) + ' ' + what);
}

void DriveSetup::fail(const std::string& problem) {
  problem_ = "Drive " + std::to_string(task_.node) + ' ' + problem;
  phase_ = Phase::kFailed;
}

void DriveSetup::start() {
  enter(Phase::kStarting);
}

auto DriveSetup::next(Time now) -> std::optional<Frame> {
  switch (phase_) {
    case Phase::kRestarting:
      return next_restarting(now);
    case Phase::kConfiguring:
      return next_request(now);
    case Phase::kTrying:
      return next_trial(now);
    case Phase::kStarting:
      return next_starting(now);
    default:
      return sdo_.follow_up(now);
  }
}

auto DriveSetup::next_restarting(Time now) -> std::optional<Frame> {
  if (!since_) {
    since_ = now;
    return nmt_frame(NmtCommand::kResetCommunication, task_.node);
  }
  if (booted_) {
    booted_ = false;
    ready_ = now + kSettling;
  }
  if (ready_ && now >= *ready_) {
    enter(Phase::kConfiguring);
    return begin(now);
  }
  if (now - *since_ > kBootPatience) {
    fail("did not start; check its supply, node number, bit rate and cable");
  }
  return std::nullopt;
}

auto DriveSetup::next_request(Time now) -> std::optional<Frame> {
  if (const auto segment = sdo_.follow_up(now)) {
    return segment;
  }
  switch (sdo_.poll(now)) {
    case SdoClient::State::kWaiting:
      return std::nullopt;
    case SdoClient::State::kTimedOut:
      fail("did not answer a request about " + object_text(step().object) + "; check its supply and cable");
      return std::nullopt;
    default:
      break;
  }
  finish_request();
  return phase_ == Phase::kConfiguring ? std::optional(begin(now)) : std::nullopt;
}

auto DriveSetup::begin(Time now) -> Frame {
  return stage_ == Stage::kWriting ? sdo_.write(step().object, candidates_[candidate_], now)
                                   : sdo_.read(step().object, now);
}

void DriveSetup::finish_request() {
  const bool aborted = sdo_.state() == SdoClient::State::kAborted;
  refusal_ = aborted ? sdo_.abort_code() : refusal_;
  switch (stage_) {
    case Stage::kReading:
      finish_reading(aborted);
      break;
    case Stage::kWriting:
      candidate_ += aborted ? 1 : 0;
      stage_ = aborted ? Stage::kWriting : Stage::kReadingBack;
      if (aborted) {
        try_value();
      }
      break;
    case Stage::kReadingBack:
      present_ = aborted ? present_ : sdo_.value();
      if (!aborted && (present_ & step().mask) == (candidates_[candidate_] & step().mask)) {
        settle(candidate_);
      } else {
        ++candidate_;
        try_value();
      }
      break;
  }
}

void DriveSetup::finish_reading(bool aborted) {
  const bool may_lack = step().need == Need::kIfThere || step().need == Need::kOnLossIfThere;
  if (aborted && is_absent(refusal_) && may_lack) {
    finish_step();
    return;
  }
  if (aborted) {
    lack(is_absent(refusal_) ? "lacks" : std::string("refuses (") + abort_text(refusal_) + ") to show");
    return;
  }
  found_ = present_ = sdo_.value();
  candidates_ = step().values;
  candidate_ = 0;
  if (step().action == Action::kDisable) {
    candidates_ = {present_ | kPdoNotValid};
  }
  const std::vector<std::uint32_t>& values = step().action == Action::kDisable ? candidates_ : step().values;
  const bool right = !values.empty() && (present_ & step().mask) == (values[0] & step().mask);
  if (step().action == Action::kRead && !step().values.empty() && step().rank(present_) == step().values.size()) {
    lack("has " + step().text(present_) + " in");
  } else if (right || step().action == Action::kRead) {
    settle(0);
  } else {
    try_value();
  }
}

// The next value that the drive might take; when there is none left, what it has may do.
void DriveSetup::try_value() {
  stage_ = Stage::kWriting;
  if (candidate_ < candidates_.size()) {
    return;
  }
  if (const std::size_t rank = step().rank(present_); rank < step().values.size()) {
    settle(rank);
    return;
  }
  const std::string why = refusal_ == 0 ? "" : std::string(" (") + abort_text(refusal_) + ')';
  lack("keeps " + step().text(present_) + why + " in");
}

// The object has a value that will do.
void DriveSetup::settle(std::size_t rank) {
  const bool said = *step().lost != '\0' && rank < step().values.size();
  if (step().action == Action::kWrite && rank > 0 && said) {
    note("has " + step().text(present_) + ", not " + step().text(step().values[0]) + ", in " +
         object_text(step().object) + "; " + step().lost);
  } else if (step().need == Need::kIfThere && step().action == Action::kWrite && found_ != present_) {
    note("had " + step().text(found_) + " stored in " + object_text(step().object) + ", and has " +
         step().text(present_) + " now");
  }
  learn();
  if (phase_ == Phase::kConfiguring) {
    finish_step();
  }
}

void DriveSetup::learn() {
  switch (step().meaning) {
    case Meaning::kVendor:
      vendor_ = present_;
      break;
    case Meaning::kProduct:
      product_ = present_;
      break;
    case Meaning::kRatedCurrent:
      if (present_ == 0 || present_ > kMostRatedMa) {
        fail("has " + std::to_string(present_) + " mA in " + object_text(step().object) +
             "; set the motor's data in the drive first");
      }
      setting_.rated_current_ma = static_cast<std::int32_t>(std::min(present_, kMostRatedMa));
      break;
    case Meaning::kTorqueLimit:
      learn_limit();
      break;
    case Meaning::kMode:
      setting_.asks_mode = present_ != kTorqueMode;
      if (setting_.asks_mode) {
        note("shows mode " + std::to_string(static_cast<std::int8_t>(present_)) + " in " + object_text(step().object) +
             "; it is asked again whenever it is enabled, and gets no torque before it shows 10");
      }
      break;
    default:
      break;
  }
}

void DriveSetup::learn_limit() {
  const bool general = step().object.index == 0x6072;
  if (present_ == 0 && general) {
    fail("may give no torque at all, with 0 in " + object_text(step().object) +
         "; set it with the maker's tool, in thousandths of the rated torque");
  } else if (present_ == 0) {
    note("has 0 in " + object_text(step().object) + "; it may give no torque before that is set");
  } else if (present_ < static_cast<std::uint32_t>(setting_.max_torque_permille)) {
    setting_.max_torque_permille = static_cast<std::int16_t>(present_);
  }
}

// The drive has no such object, or none of the values in it.
void DriveSetup::lack(const std::string& what) {
  const bool too_many = step().meaning == Meaning::kStatusMapping && profile_.objects_per_message > kFewestObjects;
  const std::string sentence = what + ' ' + object_text(step().object);
  if (too_many) {
    replan();
    return;
  }
  const bool spare = step().action == Action::kDisable && step().need == Need::kIfThere;
  switch (spare ? Need::kOptional : step().need) {
    case Need::kRequired:
    case Need::kIfThere:
      fail(sentence + "; " + step().cure);
      return;
    case Need::kOptional:
      note(sentence + "; " + (spare ? "a message that is not needed stays on the bus" : step().lost));
      break;
    case Need::kOnLoss:
    case Need::kOnLossIfThere:
      doubt_ = doubt_.empty() ? sentence : doubt_;
      break;
  }
  finish_step();
}

// Two messages for what does not fit into one.
void DriveSetup::replan() {
  note("takes " + std::to_string(kFewestObjects) +
       " objects in a message, so its status comes in two; the bus has less room for others");
  profile_.objects_per_message = kFewestObjects;
  setting_.maps = drive_maps(task_.layout, task_.node, task_.place, task_.drives, profile_.objects_per_message);
  steps_.resize(first_own_step_);
  const std::vector<SetupStep> own = setup_steps(setting_.maps, profile_);
  steps_.insert(steps_.end(), own.begin(), own.end());
  const auto again =
      std::find_if(steps_.begin(), steps_.end(), [](const SetupStep& step) { return step.object.index == 0x1800; });
  step_ = static_cast<std::size_t>(again - steps_.begin());
  stage_ = Stage::kReading;
  refusal_ = 0;
}

void DriveSetup::finish_step() {
  stage_ = Stage::kReading;
  refusal_ = 0;
  ++step_;
  if (step_ == first_own_step_ && steps_.size() == first_own_step_) {
    use_profile();
  }
  if (step_ == steps_.size()) {
    end_configuring();
  }
}

void DriveSetup::use_profile() {
  const DriveProfile* found = find_profile(task_.profiles, task_.node, vendor_, product_);
  found = found != nullptr ? found : find_profile(known_profiles(), task_.node, vendor_, product_);
  if (found != nullptr) {
    profile_ = *found;
    note("is treated as " + profile_.name + (profile_.note.empty() ? "" : "; " + profile_.note));
  }
  sdo_.set_timeout(profile_.sdo_timeout);
  setting_.most_cycles_to_answer = profile_.answer_ms;
  setting_.rated_current_ma = static_cast<std::int32_t>(profile_.rated_current_ma.value_or(0));
  setting_.maps = drive_maps(task_.layout, task_.node, task_.place, task_.drives, profile_.objects_per_message);
  const std::vector<SetupStep> own = setup_steps(setting_.maps, profile_);
  steps_.insert(steps_.end(), own.begin(), own.end());
}

void DriveSetup::end_configuring() {
  const std::int64_t most_ma = std::int64_t{setting_.rated_current_ma} * setting_.max_torque_permille / 1000;
  note("has a rated current of " + std::to_string(setting_.rated_current_ma) + " mA and " +
       (setting_.max_torque_permille == INT16_MAX
            ? std::string("no limit of torque stored")
            : "is never asked for more than " + std::to_string(most_ma) + " mA, the limit of torque stored in it"));
  enter(Phase::kReady);
  if (doubt_.empty()) {
    return;
  }
  if (task_.watchdog) {
    note(doubt_ + "; when this firmware stops, the watchdog line alone takes its torque away");
  } else if (profile_.stops_without_master) {
    note(doubt_ + "; that its torque goes when this firmware stops is known from its profile alone");
  } else {
    enter(Phase::kTrying);
  }
}

auto DriveSetup::next_trial(Time now) -> std::optional<Frame> {
  if (!since_) {
    since_ = now;
    return nmt_frame(NmtCommand::kStart, task_.node);
  }
  if (!trial_ && operational_) {
    trial_.emplace(sdo_);
  }
  if (!trial_ && now - *since_ > kStartPatience) {
    fail("did not become operational; check its manual for what prevents this");
  }
  if (!trial_) {
    return std::nullopt;
  }
  const std::optional<Frame> frame = trial_->next(now);
  switch (trial_->verdict()) {
    case LossTrial::Verdict::kRunning:
      return frame;
    case LossTrial::Verdict::kStops:
      note(doubt_ + "; tried at this start: switched on, without torque, it gave up when heartbeats stayed out");
      enter(Phase::kReady);
      break;
    case LossTrial::Verdict::kGoesOn:
      fail(doubt_ +
           ", and tried at this start it stayed on when heartbeats stayed out; wire a watchdog line to its safe "
           "torque off (--gpio CHIP:watchdog=LINE), or use another drive");
      break;
    case LossTrial::Verdict::kNotTried:
      fail(doubt_ +
           ", and could not be switched on to try whether it gives up without heartbeats; check its supply and "
           "enable input, or wire a watchdog line to its safe torque off (--gpio CHIP:watchdog=LINE)");
      break;
  }
  return nmt_frame(NmtCommand::kPreOperational, task_.node);
}

auto DriveSetup::next_starting(Time now) -> std::optional<Frame> {
  if (!since_) {
    since_ = now;
    return nmt_frame(NmtCommand::kStart, task_.node);
  }
  if (operational_) {
    phase_ = Phase::kDone;
  } else if (now - *since_ > kStartPatience) {
    fail("did not become operational; check its manual for what prevents this");
  }
  return std::nullopt;
}

void DriveSetup::receive(const Frame& frame) {
  if (frame.extended || frame.remote) {
    return;
  }
  if (frame.id == cob::kSdoAnswer + task_.node) {
    sdo_.receive(frame);
  } else if (frame.id == cob::kHeartbeat + task_.node && frame.size == 1) {
    const auto state = static_cast<NmtState>(frame.data[0]);
    if (state == NmtState::kBootUp && phase_ == Phase::kRestarting) {
      booted_ = since_.has_value();
    } else if (state == NmtState::kBootUp && phase_ != Phase::kFailed) {
      fail("restarted while it was set up; check its supply");
    }
    operational_ = state == NmtState::kOperational && since_.has_value();
  }
}

}  // namespace capstan::cia402
