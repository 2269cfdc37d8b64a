# SPDX-License-Identifier: Apache-2.0
# Programs for this machine in builds whose compiler makes code for another: the plant that an emulated board runs against, and the
# recorded run that every machine has to repeat bit for bit.
find_program(CAPSTAN_HOST_CXX NAMES g++ c++ NO_CMAKE_FIND_ROOT_PATH REQUIRED)
set(plant_sources)
foreach(name drivetrain faults fields plant sensors tendon)
  list(APPEND plant_sources ${PROJECT_SOURCE_DIR}/hal/sim/${name}.cpp)
endforeach()
set(cycle_sources)
foreach(name loop/axis control/controller control/force_control control/modes control/trajectory estimate/effort_stage estimate/estimator estimate/law_monitor
    estimate/motor_sensing estimate/tendon_health parameters/parameters safety/gate safety/limit_cycle safety/monitors safety/motor_observer
    safety/motor_observer_scales safety/supervisor)
  list(APPEND cycle_sources ${PROJECT_SOURCE_DIR}/firmware/${name}.cpp)
endforeach()

set(replay_sources ${PROJECT_SOURCE_DIR}/tests/boards/stm32f405/replay_fixture.cpp ${plant_sources} ${cycle_sources})
if(NOT CAPSTAN_AXES)
  set(CAPSTAN_AXES 4)  # the motor board's; its build has it as an option
endif()
set(image_definitions CAPSTAN_AXES=${CAPSTAN_AXES} CAPSTAN_CAN_NODE=1 CAPSTAN_INDEX_COUNTS=0 CAPSTAN_THERMOMETER_UV_PER_K=0
  CAPSTAN_THERMOMETER_UV_AT_0C=0 CAPSTAN_PREISACH_LEVELS=${CAPSTAN_PREISACH_LEVELS})

# Each source is an object of its own, through the compiler's cache where there is one: three builds make the same.
function(capstan_host_program name)
  list(TRANSFORM image_definitions PREPEND -D OUTPUT_VARIABLE definitions)
  set(objects)
  foreach(source ${ARGN})
    cmake_path(RELATIVE_PATH source BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE object)
    string(REPLACE / _ object ${name}.${object}.o)
    add_custom_command(OUTPUT ${object}
      COMMAND $CACHE{CMAKE_CXX_COMPILER_LAUNCHER} ${CAPSTAN_HOST_CXX} -std=c++20 -O2 -ffp-contract=off ${definitions} -I${CAPSTAN_ALL_ROOTS} -MD -MF ${object}.d
        -c ${source} -o ${object}
      DEPENDS ${source} DEPFILE ${CMAKE_CURRENT_BINARY_DIR}/${object}.d COMMENT "Building ${object} for this machine" VERBATIM)
    list(APPEND objects ${object})
  endforeach()
  add_custom_command(OUTPUT ${name} COMMAND ${CAPSTAN_HOST_CXX} ${objects} -o ${name} DEPENDS ${objects}
    COMMENT "Linking ${name} for this machine" VERBATIM)
  add_custom_target(${name}_host ALL DEPENDS ${name})
endfunction()
