# The rooms of the house: each folder with sources is one, a library that says which rooms it may use. What a file of it
# includes has to lie in one of these, so a build fails where an include goes up, and there are no circles: a room can
# only use those that stand before it.
#
#   lensproof_room(FOLDER [USES FOLDER…] [LINKS LIBRARY…] [EXPOSES LIBRARY…])
#
# makes the library FOLDER with '/' as '_' of the folder's sources. EXPOSES: libraries whose headers its own include.
#
# Under the sanitizers, where clang-tidy judges every text too, all rooms of engine are one library: its texts hold sources
# of several rooms, and what they all include is read once for each text. Those of experiments are not optimised there.

if(CMAKE_SCRIPT_MODE_FILE)  # cmake -DROOM=… -DUSES=… -DFILES=… -DSTAMP=… -P rooms.cmake: the check, within a build
    cmake_minimum_required(VERSION 3.25)
    foreach(file IN LISTS FILES)
        file(STRINGS "${file}" includes REGEX "^[ \t]*#[ \t]*include[ \t]*\"")
        foreach(include IN LISTS includes)
            string(REGEX REPLACE ".*\"(.*)\".*" "\\1" included "${include}")
            get_filename_component(folder "${included}" DIRECTORY)
            if(folder AND NOT folder IN_LIST USES)  # without a folder: what the build makes
                message(SEND_ERROR "${file} includes ${included}: ${ROOM} uses no ${folder}")
            endif()
        endforeach()
    endforeach()
    file(TOUCH "${STAMP}")
    return()
endif()

set(ROOMS_SCRIPT "${CMAKE_CURRENT_LIST_FILE}")

# Loops over packets: of each X_kernel.h a text for each level (engine/base/simd_level.h), compiled for its instructions;
# which of them runs is chosen at run time. They are built without sanitizers, with which g++ 12 works on one of them for
# more than ten minutes, and in such builds not for wide vectors either.
set(LEVELS scalar baseline)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$" AND NOT LENSPROOF_SANITIZE)
    list(APPEND LEVELS avx2 avx512)
    set(LEVEL_OPTIONS_avx2 -mavx2)
    set(LEVEL_OPTIONS_avx512 -mavx512f -mavx512dq -mavx512bw -mavx512vl -mprefer-vector-width=512)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
        # It takes its own _mm512_undefined for a variable that was forgotten (GCC bug 105593).
        list(APPEND LEVEL_OPTIONS_avx512 -Wno-maybe-uninitialized -Wno-uninitialized)
    endif()
    target_compile_definitions(lensproof_options INTERFACE LENSPROOF_X86_KERNELS)
endif()
function(lensproof_loops header texts)
    string(REGEX REPLACE "\\.h$" "" name ${header})
    foreach(level IN LISTS LEVELS)
        set(text "${CMAKE_BINARY_DIR}/loops/${name}_${level}.cpp")
        file(CONFIGURE OUTPUT "${text}" CONTENT "#include \"@header@\"\n" @ONLY)
        set_source_files_properties("${text}" PROPERTIES
            COMPILE_DEFINITIONS LENSPROOF_LEVEL=${level}
            COMPILE_OPTIONS "$<$<BOOL:${LENSPROOF_SANITIZE}>:-fno-sanitize=all>;${LEVEL_OPTIONS_${level}}")
        list(APPEND ${texts} "${text}")
    endforeach()
    set(${texts} ${${texts}} PARENT_SCOPE)
endfunction()

function(lensproof_room folder)
    cmake_parse_arguments(ARG "" "" "USES;LINKS;EXPOSES" ${ARGN})
    string(REPLACE "/" "_" room ${folder})
    file(GLOB files CONFIGURE_DEPENDS RELATIVE "${PROJECT_SOURCE_DIR}" "${PROJECT_SOURCE_DIR}/${folder}/*.h"
         "${PROJECT_SOURCE_DIR}/${folder}/*.cpp" "${PROJECT_SOURCE_DIR}/${folder}/*.cuh"
         "${PROJECT_SOURCE_DIR}/${folder}/*.cu")
    list(TRANSFORM files PREPEND "${PROJECT_SOURCE_DIR}/" OUTPUT_VARIABLE sources)
    set(stamp "${CMAKE_BINARY_DIR}/rooms/${room}")
    add_custom_command(
        OUTPUT "${stamp}"
        COMMAND "${CMAKE_COMMAND}" -DROOM=${folder} "-DUSES=${folder};${ARG_USES}" "-DFILES=${files}" -DSTAMP=${stamp}
                -P "${ROOMS_SCRIPT}"
        DEPENDS ${sources} "${ROOMS_SCRIPT}"
        WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}"
        COMMENT ""
        VERBATIM)
    add_custom_target(${room}_includes DEPENDS "${stamp}")  # by itself: no file of a room waits for another room's library
    set(jobs ${sources})
    list(FILTER jobs INCLUDE REGEX "\\.cu$")
    list(FILTER sources INCLUDE REGEX "\\.cpp$")
    if(LENSPROOF_CUDA AND jobs)
        add_library(${room}_jobs OBJECT ${jobs})
        set_target_properties(${room}_jobs PROPERTIES POSITION_INDEPENDENT_CODE ON)
        target_link_libraries(${room}_jobs PRIVATE lensproof_options)
        add_dependencies(cuda_jobs ${room}_jobs)
        list(APPEND sources $<TARGET_OBJECTS:${room}_jobs>)
    endif()
    list(FILTER files INCLUDE REGEX "_kernel\\.h$")
    foreach(header IN LISTS files)
        lensproof_loops(${header} sources)
    endforeach()
    string(REPLACE "/" "_" uses "${ARG_USES}")
    foreach(used IN LISTS uses)
        if(NOT TARGET ${used})
            message(FATAL_ERROR "${folder} uses ${used}, which is no room before it")
        endif()
    endforeach()
    set(library ${room})
    if(LENSPROOF_SANITIZE AND folder MATCHES "^engine/")
        set(library engine_rooms)
        list(FILTER uses EXCLUDE REGEX "^engine_")
        add_library(${room} INTERFACE)
        target_link_libraries(${room} INTERFACE engine_rooms)
    endif()
    if(NOT TARGET ${library})
        add_library(${library} STATIC)
    endif()
    if(LENSPROOF_SANITIZE AND folder MATCHES "^experiments/")  # most of their time is others'
        target_compile_options(${library} PRIVATE -O0)
    elseif(NOT LENSPROOF_SANITIZE)  # the Python module is a shared object; the program is as fast as without
        set_target_properties(${library} PROPERTIES POSITION_INDEPENDENT_CODE ON)
        target_compile_options(${library} PRIVATE -fno-semantic-interposition)
    endif()
    target_sources(${library} PRIVATE ${sources})
    add_dependencies(${library} ${room}_includes)
    target_link_libraries(${library} PUBLIC lensproof_options ${uses} ${ARG_EXPOSES} PRIVATE ${ARG_LINKS})
    if(library MATCHES "^engine_(.+)" AND NOT LENSPROOF_SANITIZE)  # other programs find it as lensproof::optics (install.cmake)
        set_target_properties(${library} PROPERTIES EXPORT_NAME ${CMAKE_MATCH_1})
        set_property(GLOBAL APPEND PROPERTY LENSPROOF_ENGINE ${library})
    endif()
endfunction()
