# The rooms of the house: each folder with sources is one, a library that says which rooms it may use. What a file of it
# includes has to lie in one of these, so a build fails where an include goes up, and there are no circles: a room can
# only use those that stand before it.
#
#   lensproof_room(FOLDER [USES FOLDER…] [LINKS LIBRARY…] [EXPOSES LIBRARY…])
#
# makes the library FOLDER with '/' as '_' of the folder's sources. EXPOSES: libraries whose headers its own include.

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

function(lensproof_room folder)
    cmake_parse_arguments(ARG "" "" "USES;LINKS;EXPOSES" ${ARGN})
    string(REPLACE "/" "_" room ${folder})
    file(GLOB files CONFIGURE_DEPENDS RELATIVE "${PROJECT_SOURCE_DIR}" "${PROJECT_SOURCE_DIR}/${folder}/*.h"
         "${PROJECT_SOURCE_DIR}/${folder}/*.cpp")
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
    list(FILTER sources INCLUDE REGEX "\\.cpp$")
    if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
        list(FILTER sources EXCLUDE REGEX "_avx[0-9]+\\.cpp$")
    endif()
    add_library(${room} STATIC ${sources})
    # Also for the Python module, which is a shared object; the program is as fast as without.
    set_target_properties(${room} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_compile_options(${room} PRIVATE -fno-semantic-interposition)
    add_dependencies(${room} ${room}_includes)
    string(REPLACE "/" "_" uses "${ARG_USES}")
    foreach(used IN LISTS uses)
        if(NOT TARGET ${used})
            message(FATAL_ERROR "${folder} uses ${used}, which is no room before it")
        endif()
    endforeach()
    target_link_libraries(${room} PUBLIC lensproof_options ${uses} ${ARG_EXPOSES} PRIVATE ${ARG_LINKS})
    if(room MATCHES "^engine_(.+)")  # other programs find it as lensproof::optics and the like (install.cmake)
        set_target_properties(${room} PROPERTIES EXPORT_NAME ${CMAKE_MATCH_1})
        set_property(GLOBAL APPEND PROPERTY LENSPROOF_ENGINE ${room})
    endif()
endfunction()
