# SPDX-License-Identifier: Apache-2.0
# Runs the board's program as a user does and looks at its answers. What a loaded machine does to timing is not judged here.
list(REMOVE_ITEM BOARD "")
set(folder ${CMAKE_CURRENT_BINARY_DIR}/linux_rt_session)
file(REMOVE_RECURSE ${folder})
file(MAKE_DIRECTORY ${folder})

function(expect what text pattern)
  if(NOT text MATCHES "${pattern}")
    message(FATAL_ERROR "${what}: no '${pattern}' in\n${text}")
  endif()
endfunction()

function(session script status)
  file(WRITE ${folder}/script "${script}")
  execute_process(COMMAND ${BOARD} ${ARGN} INPUT_FILE ${folder}/script OUTPUT_VARIABLE out ERROR_VARIABLE err
                  RESULT_VARIABLE result TIMEOUT 60)
  if(NOT result EQUAL status)
    message(FATAL_ERROR "exit status ${result}, not ${status}, of '${ARGN}':\n${out}\n${err}")
  endif()
  set(out "${out}" PARENT_SCOPE)
  set(err "${err}" PARENT_SCOPE)
endfunction()

session("version\nget joint0.control.kp\nset joint0.control.kp 0.625\nsave\nstatus" 0 --storage ${folder}/banks)
expect("the board names itself" "${out}" "board linux_rt joints 1")
expect("a last line without its end is answered" "${out}" "state disarmed fault ")
expect("every line is answered" "${out}" "ok.*ok.*ok.*ok.*ok\r?\n$")
expect("the end of input ends the program" "${err}" "[0-9]+ cycles, [0-9]+ missed")

session("version\n" 0)
if(NOT out MATCHES "^capstan [^\n]*\nok\r?\n$")
  message(FATAL_ERROR "one whole line gets one answer, not\n${out}")
endif()
session("timing\n" 0)
expect("timing shows lateness and page faults" "${out}" "began [0-9]+ us late, the latest [0-9]+ us; .* page faults [0-9]+")
session("reboot\n" 0 --storage ${folder}/banks)  # without an arm before it: a loaded machine's overruns would block that
expect("a reboot is answered" "${out}" "^ok")
string(REGEX MATCHALL "[0-9]+ cycles, [0-9]+ missed" lives "${err}")
list(LENGTH lives count)
if(NOT count EQUAL 2)
  message(FATAL_ERROR "a reboot is a second life, but there were ${count}:\n${err}")
endif()

session("get joint0.control.kp\n" 0 --storage ${folder}/banks)
expect("parameters survive the program" "${out}" "0\\.625")

session("move joint0 0.3 rad\n" 0)
expect("nothing moves before it is armed" "${out}" "error not_armed: [^;]+; [^\n]+")

# Exit 0 or 1 by the machine's timing; the report must be whole either way.
execute_process(COMMAND ${BOARD} --selftest --for 1.5 OUTPUT_VARIABLE out RESULT_VARIABLE result TIMEOUT 60)
expect("the self-test says what it saw" "${out}" "kernel .*cycles .*page faults .*wake-up .*verdict: (pass|fail); ")
if(out MATCHES "verdict: pass" AND NOT result EQUAL 0 OR out MATCHES "verdict: fail" AND NOT result EQUAL 1)
  message(FATAL_ERROR "exit status ${result} belongs to the other verdict:\n${out}")
endif()
list(LENGTH BOARD words)
if(out MATCHES "memory +locked" AND words EQUAL 1)  # an emulator's own page faults count as the program's
  expect("locked memory never faults" "${out}" "page faults  0 minor, 0 major")
endif()

session("" 2 --console telnet)
expect("a bad console is refused with the cure" "${err}" "no console 'telnet'; use stdio")
session("" 2 --cpu)
expect("a missing value is refused with the cure" "${err}" "--cpu needs a value; ")
session("" 0 --help)
expect("help says what the joint is" "${out}" "simulated plant")
file(REMOVE_RECURSE ${folder})
