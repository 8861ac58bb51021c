# SPDX-License-Identifier: GPL-3.0-or-later
# find_package(kinelux): targets kinelux::core, kinelux::geometry, kinelux::solve and so on, one per folder of headers. A
# project that uses it enables the languages C and CXX (VTK's IOHDF configuration needs C).
include("${CMAKE_CURRENT_LIST_DIR}/KineluxDependencies.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/kineluxTargets.cmake")
