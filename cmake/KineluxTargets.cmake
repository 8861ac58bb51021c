# SPDX-License-Identifier: GPL-3.0-or-later
include(GNUInstallDirs)

if(NOT CMAKE_BUILD_TYPE)
    set(CMAKE_BUILD_TYPE Release)
endif()
find_program(KINELUX_CCACHE ccache)
if(KINELUX_CCACHE)
    set(CMAKE_CXX_COMPILER_LAUNCHER "${KINELUX_CCACHE}")
    set(CMAKE_C_COMPILER_LAUNCHER "${KINELUX_CCACHE}")
endif()
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")

# What every target of ours is compiled with. -ffp-contract=off and no slp vectoriser: the same bytes on every run and
# machine, and g++ 12.2 miscompiles double->float->double rounding under it (docs/architecture.md).
# -Wno-missing-field-initializers: designated initialisers leave the rest to its defaults on purpose.
# -Wno-restrict: g++ 12 warns falsely of "literal" + std::string (gcc bug 105651).
add_library(kinelux_compile_options INTERFACE)
target_compile_features(kinelux_compile_options INTERFACE cxx_std_20)
target_compile_options(kinelux_compile_options INTERFACE
    $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
    -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wno-missing-field-initializers -Werror
    -ffp-contract=off -fno-tree-slp-vectorize)
target_compile_definitions(kinelux_compile_options INTERFACE GLM_FORCE_CTOR_INIT GLM_ENABLE_EXPERIMENTAL)
if(KINELUX_SANITIZE)
    target_compile_options(kinelux_compile_options INTERFACE -fsanitize=address,undefined -fno-omit-frame-pointer)
    target_link_options(kinelux_compile_options INTERFACE -fsanitize=address,undefined)
endif()
if(KINELUX_COVERAGE)
    target_compile_options(kinelux_compile_options INTERFACE --coverage)
    target_link_options(kinelux_compile_options INTERFACE --coverage)
endif()

# kinelux_module(name SOURCES a.cpp ... HEADERS a.h ... LINKS modules/public libs ... PRIVATE_LINKS third parties ...)
# A module of pipeline/: target kinelux_<name>, alias kinelux::<name>; headers are included as "<name>/<header>".
function(kinelux_module name)
    cmake_parse_arguments(arg "" "" "SOURCES;HEADERS;LINKS;PRIVATE_LINKS" ${ARGN})
    if(arg_SOURCES)
        add_library(kinelux_${name} STATIC ${arg_SOURCES})
        set(scope PUBLIC)
        target_link_libraries(kinelux_${name} PUBLIC ${arg_LINKS} PRIVATE $<BUILD_INTERFACE:kinelux_compile_options> ${arg_PRIVATE_LINKS})
    else()
        add_library(kinelux_${name} INTERFACE)
        set(scope INTERFACE)
        target_link_libraries(kinelux_${name} INTERFACE ${arg_LINKS})
    endif()
    add_library(kinelux::${name} ALIAS kinelux_${name})
    target_compile_features(kinelux_${name} ${scope} cxx_std_20)
    target_compile_definitions(kinelux_${name} ${scope} GLM_FORCE_CTOR_INIT GLM_ENABLE_EXPERIMENTAL)
    target_sources(kinelux_${name} ${scope}
        FILE_SET HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}/pipeline" FILES ${arg_HEADERS})
    set_target_properties(kinelux_${name} PROPERTIES EXPORT_NAME ${name})
    install(TARGETS kinelux_${name} EXPORT kinelux
        ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}/kinelux"
        FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/kinelux")
endfunction()

# kinelux_stage(name LINKS ...): an executable of stages/<name>.cpp.
function(kinelux_stage name)
    cmake_parse_arguments(arg "" "" "LINKS" ${ARGN})
    add_executable(${name} ${name}.cpp)
    target_link_libraries(${name} PRIVATE kinelux_compile_options ${arg_LINKS})
    install(TARGETS ${name})
endfunction()

# kinelux_test(name LABEL unit|validation|hard|stages SOURCES ... LINKS ...): one gtest executable, every TEST a ctest.
function(kinelux_test name)
    cmake_parse_arguments(arg "" "LABEL" "SOURCES;LINKS" ${ARGN})
    add_executable(${name} ${arg_SOURCES})
    target_link_libraries(${name} PRIVATE kinelux_compile_options GTest::gtest_main ${arg_LINKS})
    target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}/tests" "${PROJECT_SOURCE_DIR}/pipeline")
    set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
    gtest_discover_tests(${name} TEST_PREFIX "${name}." PROPERTIES LABELS "${arg_LABEL}" TIMEOUT 600
        DISCOVERY_TIMEOUT 60)
endfunction()
