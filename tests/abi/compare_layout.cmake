# Runs PROGRAM and compares what it prints with the file EXPECTED, line by line.
execute_process(COMMAND ${PROGRAM} OUTPUT_VARIABLE printed RESULT_VARIABLE result)
file(READ ${EXPECTED} expected)
if(NOT result EQUAL 0 OR NOT printed STREQUAL expected)
  message(FATAL_ERROR "the layout of pileus/abi.h has changed. Printed:\n${printed}\n"
                      "expected (${EXPECTED}):\n${expected}")
endif()
