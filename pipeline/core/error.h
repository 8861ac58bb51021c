// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace kinelux::core {

/// What an executable returns; documented in docs/command-line.md.
enum class ExitCode : int {
    Ok = 0,           ///< everything asked for was done
    Bug = 1,          ///< a fault of the program itself
    Usage = 2,        ///< command line or scene file
    File = 3,         ///< a file is missing, unreadable or not what it says
    Geometry = 4,     ///< geometry that nothing can be computed on
    NotConverged = 5, ///< result written and marked, but short of the accuracy asked for
    Resources = 6,    ///< refused before work started: memory or time beyond the limit
};

/// Base of every error a user can cause; what() is one line: where, what was expected, what to do.
class Error : public std::runtime_error {
public:
    Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    ExitCode code() const { return code_; }

private:
    ExitCode code_;
};

/// A command line option or a scene file key is wrong. Scene errors start with "file:line: ".
class OptionError : public Error {
public:
    explicit OptionError(const std::string& message) : Error(ExitCode::Usage, message) {}
};

/// A file cannot be read or written, is truncated, or is of another format, version or origin.
class FileError : public Error {
public:
    explicit FileError(const std::string& message) : Error(ExitCode::File, message) {}
};

/// Geometry on which nothing can be computed: no faces, not-a-number coordinates, no area.
class GeometryError : public Error {
public:
    explicit GeometryError(const std::string& message) : Error(ExitCode::Geometry, message) {}
};

/// An iteration stopped short of its tolerance; the result so far has been written and is marked.
class SolverError : public Error {
public:
    explicit SolverError(const std::string& message) : Error(ExitCode::NotConverged, message) {}
};

/// The work would not fit into the memory or time allowed; thrown before it starts.
class ResourceError : public Error {
public:
    explicit ResourceError(const std::string& message) : Error(ExitCode::Resources, message) {}
};

} // namespace kinelux::core
