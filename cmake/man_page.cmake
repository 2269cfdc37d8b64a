# SPDX-License-Identifier: Apache-2.0
# cmake -DPROGRAM=FILE -DOUTPUT=FILE -DVERSION=X -P man_page.cmake: a manual page of what `PROGRAM --help` prints, and `PROGRAM COMMAND --help`
# for each command that it names under "Subcommands:".
get_filename_component(name ${PROGRAM} NAME)

# What the program prints, as lines of a page.
function(help_of result)
  execute_process(COMMAND ${PROGRAM} ${ARGN} --help OUTPUT_VARIABLE help RESULT_VARIABLE failed)
  if(failed OR help STREQUAL "")
    message(FATAL_ERROR "${PROGRAM} ${ARGN} --help does not answer; a manual page is made of it")
  endif()
  string(REPLACE "\\" "\\e" help "${help}")
  string(REPLACE "-" "\\-" help "${help}")
  string(REGEX REPLACE "\n([.'])" "\n\\\\&\\1" help "${help}")
  set(${result} "${help}" PARENT_SCOPE)
endfunction()

help_of(help)
set(commands "")
if(help MATCHES "\nSubcommands:\n(.*)$")
  string(REGEX MATCHALL "(^|\n)  [a-z]+" names "${CMAKE_MATCH_1}")
  foreach(command ${names})
    string(STRIP "${command}" command)
    help_of(own ${command})
    string(APPEND commands ".SS ${name} ${command}\n.nf\n${own}.fi\n")
  endforeach()
  if(commands STREQUAL "")
    message(FATAL_ERROR "${PROGRAM} --help names no subcommand where they were looked for")
  endif()
  set(commands ".SH COMMANDS\n${commands}")
endif()
string(TOUPPER ${name} title)
string(REPLACE "-" "\\-" plain "${name}")
file(WRITE ${OUTPUT} ".TH ${title} 1 \"\" \"capstan ${VERSION}\" \"User Commands\"\n.SH NAME\n${plain} \\- ${PURPOSE}\n"
  ".SH DESCRIPTION\n.nf\n${help}\n.fi\n${commands}.SH SEE ALSO\n/usr/share/doc/capstan/README.md, /usr/share/doc/capstan/README.Debian\n")
find_program(GZIP gzip REQUIRED)
execute_process(COMMAND ${GZIP} -9 -n -f ${OUTPUT} COMMAND_ERROR_IS_FATAL ANY)
