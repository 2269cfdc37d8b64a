# SPDX-License-Identifier: Apache-2.0
# cmake -DPROGRAM=FILE -DOUTPUT=FILE -DVERSION=X -P man_page.cmake: a manual page of what `PROGRAM --help` prints.
get_filename_component(name ${PROGRAM} NAME)
execute_process(COMMAND ${PROGRAM} --help OUTPUT_VARIABLE help RESULT_VARIABLE failed)
if(failed OR help STREQUAL "")
  message(FATAL_ERROR "${PROGRAM} --help does not answer; a manual page is made of it")
endif()
string(REPLACE "\\" "\\e" help "${help}")
string(REPLACE "-" "\\-" help "${help}")
string(REGEX REPLACE "\n([.'])" "\n\\\\&\\1" help "${help}")
string(TOUPPER ${name} title)
string(REPLACE "-" "\\-" plain "${name}")
file(WRITE ${OUTPUT} ".TH ${title} 1 \"\" \"capstan ${VERSION}\" \"User Commands\"\n.SH NAME\n${plain} \\- ${PURPOSE}\n"
  ".SH DESCRIPTION\n.nf\n${help}\n.fi\n.SH SEE ALSO\n/usr/share/doc/capstan/README.md\n")
find_program(GZIP gzip REQUIRED)
execute_process(COMMAND ${GZIP} -9 -n -f ${OUTPUT} COMMAND_ERROR_IS_FATAL ANY)
