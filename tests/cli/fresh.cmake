# The file is what `PROGRAM schema OPTION` prints.
execute_process(COMMAND ${PROGRAM} schema ${OPTION} RESULT_VARIABLE code OUTPUT_VARIABLE printed)
if(NOT code EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} schema ${OPTION} ends with exit code ${code}")
endif()
file(READ ${FILE} kept)
if(NOT "${printed}" STREQUAL "${kept}")
  message(FATAL_ERROR "${FILE} is out of date; renew it with: pileus schema ${OPTION} --write ${FILE}")
endif()
