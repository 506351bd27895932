# What the files for wider registers define must be theirs alone: where two files define the same inline function, the
# linker keeps either, and a machine without those registers would run code for them. Tables of constants are no code.
# cmake -DNM=nm -DOBJECTS=a.o,b.o -P no_shared_code.cmake
string(REPLACE "," ";" OBJECTS "${OBJECTS}")
if(NOT OBJECTS)
    message(STATUS "No such files on this processor: nothing to look at")
endif()
foreach(object IN LISTS OBJECTS)
    execute_process(COMMAND ${NM} --demangle --defined-only --format=sysv ${object} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
    string(REGEX MATCHALL "[^\n]+" lines "${symbols}")
    set(of_its_own 0)
    foreach(line IN LISTS lines)
        # Name | value | class | type | size | line | section
        if(line MATCHES "\\|[0-9a-f]+\\| *[WVu] *\\|" AND NOT line MATCHES "\\|\\.rodata" AND
           NOT line MATCHES "DW\\.ref\\.__gxx_personality")
            if(line MATCHES "simd_abi::_Vec")
                math(EXPR of_its_own "${of_its_own} + 1")
            else()
                message(SEND_ERROR "${object} shares with other machines' code: ${line}")
            endif()
        endif()
    endforeach()
    if(of_its_own EQUAL 0)
        message(SEND_ERROR "${object} defines no packet code: is it the right file?")
    endif()
endforeach()
