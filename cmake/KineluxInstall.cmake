# SPDX-License-Identifier: GPL-3.0-or-later
# `cmake --install`: programs, manual pages, completions, documents, and the library with its find_package(kinelux) files.
# `cpack -G DEB` in the build folder packs the same.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# Manual pages are what the programs' option tables say.
set(man_folder "${PROJECT_BINARY_DIR}/man")
set(man_pages)
function(kinelux_man_page page program)
    add_custom_command(OUTPUT "${man_folder}/${page}.1"
        COMMAND ${CMAKE_COMMAND} -E make_directory "${man_folder}"
        COMMAND ${program} ${ARGN} --help-man > "${man_folder}/${page}.1"
        DEPENDS ${program}
        VERBATIM)
    set(man_pages ${man_pages} "${man_folder}/${page}.1" PARENT_SCOPE)
endfunction()
kinelux_man_page(kinelux kinelux)
foreach(command run form-factors info)
    kinelux_man_page(kinelux-${command} kinelux ${command})
endforeach()
foreach(stage clean fit cluster plan coefficients solve export reference)
    kinelux_man_page(kinelux-${stage} kinelux-${stage})
endforeach()
add_custom_target(kinelux_man ALL DEPENDS ${man_pages})
install(FILES ${man_pages} DESTINATION "${CMAKE_INSTALL_MANDIR}/man1")

install(FILES stages/completion/kinelux.bash DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions"
        RENAME kinelux)
install(FILES stages/completion/_kinelux DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions")
install(FILES README.md CHANGELOG.md LICENSE TYPE DOC)
install(DIRECTORY docs TYPE DOC)

# The library. Its dependencies are found by the file that finds them here.
set(package_folder "${CMAKE_INSTALL_LIBDIR}/cmake/kinelux")
install(EXPORT kinelux NAMESPACE kinelux:: FILE kineluxTargets.cmake DESTINATION "${package_folder}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/kineluxConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES cmake/kineluxConfig.cmake cmake/KineluxDependencies.cmake "${PROJECT_BINARY_DIR}/kineluxConfigVersion.cmake"
        DESTINATION "${package_folder}")

set(CPACK_PACKAGE_NAME kinelux)
set(CPACK_PACKAGE_VENDOR Kinelux)
set(CPACK_PACKAGE_CONTACT "The Kinelux developers <kinelux@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES TRUE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS TRUE) # libraries, as dpkg-shlibdeps finds them
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "paraview, python3-h5py, python3-numpy, python3-matplotlib")
include(CPack)
