// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/safety/supervisor.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <vector>

namespace capstan {
namespace {

constexpr std::array kStates = {State::kBoot,   State::kDisarmed, State::kArmed,      State::kHolding,
                                State::kMoving, State::kStopping, State::kExperiment, State::kFaulted};

/// A supervisor brought into the wanted state by the shortest way.
auto supervisor_in(State state) -> Supervisor {
  Supervisor supervisor;
  if (state != State::kBoot) {
    supervisor.rt_step({});
  }
  if (state != State::kBoot && state != State::kDisarmed) {
    supervisor.rt_step({.arm = true});
  }
  if (state == State::kHolding || state == State::kExperiment) {
    supervisor.rt_step({});
  }
  if (state == State::kMoving || state == State::kStopping) {
    supervisor.rt_step({.in_motion = true});
  }
  if (state == State::kStopping) {
    supervisor.rt_step({.in_motion = true, .braking = true});
  }
  if (state == State::kExperiment) {
    supervisor.rt_step({.experiment = true});
  }
  if (state == State::kFaulted) {
    supervisor.rt_step({.faults = bit(Fault::kOverCurrent)});
  }
  EXPECT_EQ(supervisor.state(), state);
  return supervisor;
}

struct Row {
  State from;
  SupervisorInput input;
  State to;
};

constexpr FaultSet kSome = bit(Fault::kEncoderJump);

// Written from the contract: boot, disarmed, armed, moving, holding, experiment, stopping, faulted, and what leads from
// one to the other.
const std::vector<Row> kRows = {
    {State::kBoot, {}, State::kDisarmed},
    {State::kBoot, {.arm = true}, State::kDisarmed},
    {State::kBoot, {.faults = kSome, .arm = true, .in_motion = true}, State::kDisarmed},
    {State::kDisarmed, {}, State::kDisarmed},
    {State::kDisarmed, {.arm = true}, State::kArmed},
    {State::kDisarmed, {.faults = kSome}, State::kDisarmed},
    {State::kDisarmed, {.faults = kSome, .arm = true}, State::kDisarmed},
    {State::kDisarmed, {.arm = true, .disarm = true}, State::kDisarmed},
    {State::kDisarmed, {.in_motion = true}, State::kDisarmed},
    {State::kDisarmed, {.experiment = true}, State::kDisarmed},
    {State::kDisarmed, {.arm = true, .experiment = true}, State::kArmed},
    {State::kArmed, {}, State::kHolding},
    {State::kArmed, {.arm = true}, State::kArmed},
    {State::kArmed, {.in_motion = true}, State::kMoving},
    {State::kArmed, {.disarm = true}, State::kDisarmed},
    {State::kArmed, {.faults = kSome}, State::kFaulted},
    {State::kArmed, {.experiment = true}, State::kArmed},
    {State::kArmed, {.waits = true}, State::kArmed},
    {State::kArmed, {.waits = true, .experiment = true, .in_motion = true}, State::kArmed},
    {State::kArmed, {.waits = true, .disarm = true}, State::kDisarmed},
    {State::kArmed, {.faults = kSome, .waits = true}, State::kFaulted},
    {State::kHolding, {.waits = true}, State::kHolding},
    {State::kMoving, {.waits = true, .in_motion = true}, State::kMoving},
    {State::kDisarmed, {.waits = true}, State::kDisarmed},
    {State::kHolding, {}, State::kHolding},
    {State::kHolding, {.in_motion = true}, State::kMoving},
    {State::kHolding, {.in_motion = true, .braking = true}, State::kHolding},
    {State::kHolding, {.disarm = true}, State::kDisarmed},
    {State::kHolding, {.faults = kSome}, State::kFaulted},
    {State::kHolding, {.faults = kSome, .arm = true, .in_motion = true}, State::kFaulted},
    {State::kHolding, {.experiment = true}, State::kExperiment},
    {State::kHolding, {.experiment = true, .in_motion = true}, State::kExperiment},
    {State::kMoving, {.in_motion = true}, State::kMoving},
    {State::kMoving, {.in_motion = true, .braking = true}, State::kStopping},
    {State::kMoving, {}, State::kHolding},
    {State::kMoving, {.disarm = true, .in_motion = true}, State::kDisarmed},
    {State::kMoving, {.faults = kSome, .in_motion = true}, State::kFaulted},
    {State::kMoving, {.experiment = true, .in_motion = true}, State::kMoving},
    {State::kStopping, {.in_motion = true, .braking = true}, State::kStopping},
    {State::kStopping, {.in_motion = true}, State::kMoving},
    {State::kStopping, {}, State::kHolding},
    {State::kStopping, {.disarm = true, .in_motion = true, .braking = true}, State::kDisarmed},
    {State::kStopping, {.faults = kSome, .in_motion = true, .braking = true}, State::kFaulted},
    {State::kExperiment, {.experiment = true}, State::kExperiment},
    {State::kExperiment, {.experiment = true, .in_motion = true}, State::kExperiment},
    {State::kExperiment, {.in_motion = true}, State::kMoving},
    {State::kExperiment, {.in_motion = true, .braking = true}, State::kStopping},
    {State::kExperiment, {}, State::kHolding},
    {State::kExperiment, {.arm = true}, State::kExperiment},
    {State::kExperiment, {.disarm = true, .experiment = true}, State::kDisarmed},
    {State::kExperiment, {.faults = kSome, .experiment = true}, State::kFaulted},
    {State::kFaulted, {}, State::kFaulted},
    {State::kFaulted, {.arm = true}, State::kFaulted},
    {State::kFaulted, {.faults = kSome, .arm = true}, State::kFaulted},
    {State::kFaulted, {.disarm = true}, State::kDisarmed},
    {State::kFaulted, {.faults = kSome, .disarm = true}, State::kDisarmed},
    {State::kFaulted, {.experiment = true}, State::kFaulted},
};

TEST(Supervisor, EveryRowOfTheContractHolds) {
  for (std::size_t i = 0; i < kRows.size(); ++i) {
    Supervisor supervisor = supervisor_in(kRows[i].from);
    EXPECT_EQ(supervisor.rt_step(kRows[i].input), kRows[i].to) << "row " << i << " from " << name(kRows[i].from);
  }
}

TEST(Supervisor, EveryTransitionOfTheTableIsReachedByTheRows) {
  for (const Transition& transition : kTransitions) {
    EXPECT_TRUE(std::any_of(kRows.begin(), kRows.end(),
                            [&](const Row& row) { return row.from == transition.from && row.to == transition.to; }))
        << name(transition.from) << " to " << name(transition.to);
  }
}

TEST(Supervisor, NoStateHasTwoRowsForOneTrigger) {
  for (std::size_t i = 0; i < kTransitions.size(); ++i) {
    for (std::size_t j = i + 1; j < kTransitions.size(); ++j) {
      EXPECT_FALSE(kTransitions[i].from == kTransitions[j].from && kTransitions[i].trigger == kTransitions[j].trigger);
    }
  }
}

/// Calls check(state before, input, state after, fault after) for every state and every combination of inputs.
template <typename Check>
void for_all_inputs(Check&& check) {
  const std::array<FaultSet, 4> fault_sets = {0, bit(Fault::kOverrun), bit(Fault::kDriveFailed),
                                              bit(Fault::kSensorMissing) | bit(Fault::kEmergencyStop)};
  for (const State before : kStates) {
    for (const FaultSet faults : fault_sets) {
      for (int bits = 0; bits < 128; ++bits) {
        const SupervisorInput input{faults,          (bits & 1) != 0,  (bits & 2) != 0,  (bits & 8) != 0,
                                    (bits & 4) != 0, (bits & 16) != 0, (bits & 32) != 0, (bits & 64) != 0};
        Supervisor supervisor = supervisor_in(before);
        const State after = supervisor.rt_step(input);
        EXPECT_EQ(after, supervisor.state());
        check(before, input, after, supervisor.first_fault());
      }
    }
  }
}

TEST(Supervisor, NoStateHasTorqueWhileAFaultIsPresent) {
  for_all_inputs([](State before, const SupervisorInput& input, State after, Fault) {
    EXPECT_FALSE(input.faults != 0 && energised(after)) << "from " << name(before);
  });
}

TEST(Supervisor, NoStateHasTorqueAfterADisarm) {
  for_all_inputs([](State before, const SupervisorInput& input, State after, Fault) {
    if (input.disarm) {
      EXPECT_EQ(after, State::kDisarmed) << "from " << name(before);
    }
  });
}

TEST(Supervisor, OnlyDisarmLeavesTheFaultedState) {
  for_all_inputs([](State before, const SupervisorInput& input, State after, Fault) {
    if (before == State::kFaulted && !input.disarm) {
      EXPECT_EQ(after, State::kFaulted);
    }
  });
}

TEST(Supervisor, OnlyArmGivesTorque) {
  for_all_inputs([](State before, const SupervisorInput& input, State after, Fault) {
    if (!energised(before) && energised(after)) {
      EXPECT_TRUE(input.arm && !input.disarm && input.faults == 0) << "from " << name(before);
      EXPECT_EQ(before, State::kDisarmed);
    }
  });
}

TEST(Supervisor, AFaultIsNamedExactlyWhileFaulted) {
  for_all_inputs([](State, const SupervisorInput&, State after, Fault fault) {
    EXPECT_EQ(after == State::kFaulted, fault != Fault::kNone);
  });
}

TEST(Supervisor, TheFirstFaultIsKeptWhenOthersFollow) {
  Supervisor supervisor = supervisor_in(State::kMoving);
  supervisor.rt_step({.faults = bit(Fault::kFollowingError)});
  supervisor.rt_step({.faults = bit(Fault::kOverrun) | bit(Fault::kEmergencyStop)});
  supervisor.rt_step({});
  EXPECT_EQ(supervisor.first_fault(), Fault::kFollowingError);
}

TEST(Supervisor, DisarmAcknowledgesAndTheMachineArmsAgain) {
  Supervisor supervisor = supervisor_in(State::kFaulted);
  supervisor.rt_step({.disarm = true});
  EXPECT_EQ(supervisor.first_fault(), Fault::kNone);
  EXPECT_EQ(supervisor.rt_step({.arm = true}), State::kArmed);
  EXPECT_EQ(supervisor.rt_step({}), State::kHolding);
}

RC_GTEST_PROP(Supervisor, NoSequenceOfInputsGivesTorqueWithAFaultOrWithoutArming, ()) {
  Supervisor supervisor;
  bool armed_since_rest = false;
  const auto length = *rc::gen::inRange(1, 200);
  for (int i = 0; i < length; ++i) {
    const auto fault = static_cast<Fault>(*rc::gen::inRange<int>(0, static_cast<int>(kFaultTable.size())));
    const SupervisorInput input{*rc::gen::inRange(0, 4) == 0 ? bit(fault) : 0,
                                *rc::gen::arbitrary<bool>(),
                                *rc::gen::inRange(0, 5) == 0,
                                *rc::gen::arbitrary<bool>(),
                                *rc::gen::arbitrary<bool>(),
                                *rc::gen::arbitrary<bool>()};
    const bool had_torque = energised(supervisor.state());
    const bool was_disarmed = supervisor.state() == State::kDisarmed;
    const bool has_torque = energised(supervisor.rt_step(input));
    armed_since_rest = has_torque && (had_torque ? armed_since_rest : (was_disarmed && input.arm));
    RC_ASSERT(!has_torque || (armed_since_rest && input.faults == 0 && !input.disarm));
  }
}

}  // namespace
}  // namespace capstan
