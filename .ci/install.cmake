# What `cmake --install` puts where, in two components, of which `cpack` makes a Debian package each:
#   program      the program, the data that it looks for beside itself (engine/base/data_root.h), manual page, completions
#   development  the engine's libraries and headers, and the CMake package that finds them (tests/package/uses_engine)
include(GNUInstallDirs)

set(data ${CMAKE_INSTALL_DATADIR}/lensproof)
install(TARGETS lensproof COMPONENT program)
install(DIRECTORY lenses reference_photos DESTINATION ${data} COMPONENT program)
install(DIRECTORY engine/spectral/data DESTINATION ${data}/engine/spectral COMPONENT program)
install(DIRECTORY engine/scene/data DESTINATION ${data}/engine/scene COMPONENT program)
install(DIRECTORY experiments/scenes experiments/gallery DESTINATION ${data}/experiments COMPONENT program)
file(GLOB experiments CONFIGURE_DEPENDS experiments/*.toml)
install(FILES ${experiments} DESTINATION ${data}/experiments COMPONENT program)
# Pages link to each other and to what they describe, so they lie as in the source tree.
file(GLOB_RECURSE pages CONFIGURE_DEPENDS RELATIVE "${PROJECT_SOURCE_DIR}" engine/*.md calibration/*.md experiments/*.md
     tests/*.md engine/*.png calibration/*.png experiments/draw/*.jpg experiments/docs/*.png experiments/docs/*.svg)
foreach(page IN LISTS pages ITEMS README.md)
    get_filename_component(folder ${page} DIRECTORY)
    install(FILES ${page} DESTINATION ${data}/${folder} COMPONENT program)
endforeach()
# An installation has no .git to ask.
install(CODE "
    execute_process(COMMAND git -c safe.directory=* -C \"${PROJECT_SOURCE_DIR}\" rev-parse HEAD
                    OUTPUT_FILE \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${data}/commit\" ERROR_QUIET)"
    COMPONENT program)

set(made ${PROJECT_BINARY_DIR}/installed)
add_custom_command(
    OUTPUT ${made}/lensproof.1 ${made}/lensproof ${made}/_lensproof
    COMMAND ${CMAKE_COMMAND} -E make_directory ${made}
    COMMAND lensproof manual > ${made}/lensproof.1
    COMMAND lensproof completion bash > ${made}/lensproof
    COMMAND lensproof completion zsh > ${made}/_lensproof
    DEPENDS lensproof
    VERBATIM)
add_custom_target(manual ALL DEPENDS ${made}/lensproof.1)
install(FILES ${made}/lensproof.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
install(FILES ${made}/lensproof DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
install(FILES ${made}/_lensproof DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program)

get_property(engine GLOBAL PROPERTY LENSPROOF_ENGINE)
add_custom_target(engine DEPENDS ${engine})
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/lensproof)
install(TARGETS ${engine} lensproof_options lensproof_opencv lensproof_oidn lensproof_oiio EXPORT lensproof
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/lensproof COMPONENT development)
install(EXPORT lensproof NAMESPACE lensproof:: DESTINATION ${package} FILE lensproofTargets.cmake COMPONENT development)
install(DIRECTORY engine DESTINATION include/lensproof COMPONENT development FILES_MATCHING PATTERN "*.h")
include(CMakePackageConfigHelpers)
write_basic_package_version_file(${made}/lensproofConfigVersion.cmake COMPATIBILITY SameMinorVersion)
set(EMBREE_MAJOR ${embree_VERSION_MAJOR})
configure_file(.ci/lensproofConfig.cmake.in ${made}/lensproofConfig.cmake @ONLY)
install(FILES ${made}/lensproofConfig.cmake ${made}/lensproofConfigVersion.cmake DESTINATION ${package}
        COMPONENT development)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_CONTACT "The lensproof developers")
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME lensproof)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
# Lenses calibrated from photographs; the demo's photos.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "liblensfun-data-v1, opencv-doc")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME liblensproof-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
string(CONCAT CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
       "lensproof, libopencv-core-dev, libopencv-imgproc-dev, libopencv-calib3d-dev, libopencv-contrib-dev, libeigen3-dev, "
       "libopenimageio-dev, openimageio-tools, libopenexr-dev, libembree-dev, libassimp-dev, libboost-dev, "
       "libtomlplusplus-dev, nlohmann-json3-dev, libyaml-cpp-dev, libfmt-dev")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "The engine of lensproof for other programs: libraries, headers, CMake package")
include(CPack)
