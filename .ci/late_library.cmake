# A library that is loaded when the first of its functions is called, not when a program starts.
#
#   lensproof_late_library(NAME IMPORTED PATTERN)
#
# makes NAME, to be linked in place of the imported library: for each function of its whose mangled name matches PATTERN a
# jump, which at first leads to what loads the library and looks the function up, and from then on to the function, as
# the linker's own tables do for what is loaded at the start. Only functions: a class that derives from one of the
# library's needs -fno-rtti. On other processors than x86-64, and under the sanitizers, whose checks look at type
# information, NAME is the library itself.
function(lensproof_late_library name imported pattern)
    add_library(${name} INTERFACE)
    if(LENSPROOF_SANITIZE OR NOT CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$" OR NOT UNIX OR APPLE)
        target_link_libraries(${name} INTERFACE ${imported})
        return()
    endif()
    get_target_property(configurations ${imported} IMPORTED_CONFIGURATIONS)
    list(GET configurations 0 configuration)
    get_target_property(file ${imported} IMPORTED_LOCATION_${configuration})
    get_target_property(soname ${imported} IMPORTED_SONAME_${configuration})
    get_target_property(others ${imported} INTERFACE_LINK_LIBRARIES)
    get_target_property(includes ${imported} INTERFACE_INCLUDE_DIRECTORIES)
    execute_process(COMMAND ${CMAKE_NM} -D --defined-only ${file} OUTPUT_VARIABLE table COMMAND_ERROR_IS_FATAL ANY)
    string(REGEX MATCHALL " [TW] [^\n@]+" symbols "${table}")
    list(TRANSFORM symbols REPLACE "^ [TW] " "")
    list(FILTER symbols INCLUDE REGEX "${pattern}")
    set(jumps)
    set(names)
    set(index 0)
    foreach(symbol IN LISTS symbols)
        string(APPEND jumps ".globl ${symbol}\n.hidden ${symbol}\n.type ${symbol},@function\n${symbol}: jmp *${name}_slots+8*${index}(%rip)\n"
               "0: pushq $${index}\njmp ${name}_bind\n.pushsection .data.rel.local,\"aw\"\n.quad 0b\n.popsection\n")
        string(APPEND names "    \"${symbol}\",\n")
        math(EXPR index "${index} + 1")
    endforeach()
    set(LATE ${name})
    set(SONAME ${soname})
    set(JUMPS "${jumps}")
    set(NAMES "${names}")
    configure_file(${CMAKE_CURRENT_FUNCTION_LIST_DIR}/late_library.cpp.in ${CMAKE_BINARY_DIR}/generated/${name}.cpp @ONLY)
    add_library(${name}_jumps STATIC ${CMAKE_BINARY_DIR}/generated/${name}.cpp)
    set_target_properties(${name}_jumps PROPERTIES CXX_CLANG_TIDY "" POSITION_INDEPENDENT_CODE ON)
    target_link_libraries(${name}_jumps PRIVATE lensproof_options ${CMAKE_DL_LIBS})
    target_link_libraries(${name} INTERFACE $<BUILD_INTERFACE:${name}_jumps> $<INSTALL_INTERFACE:${imported}> ${others})
    target_include_directories(${name} SYSTEM INTERFACE ${includes})
endfunction()
