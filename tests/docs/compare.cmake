# cmake -Dprogram=PROGRAM -Dexpected=FILE -P compare.cmake: fails unless the program exits with 0 and prints exactly the
# contents of the file.
execute_process(COMMAND ${program} OUTPUT_VARIABLE printed COMMAND_ERROR_IS_FATAL ANY)
file(READ ${expected} promised)
if(NOT printed STREQUAL promised)
    message(FATAL_ERROR "it prints\n${printed}but the page says\n${promised}")
endif()
