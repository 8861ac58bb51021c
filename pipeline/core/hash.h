// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace kinelux::core {

/// 128-bit XXH3 of bytes, as 32 hexadecimal digits.
std::string content_hash(std::string_view bytes);

/// content_hash of a file's bytes. @throws FileError  the file cannot be read
std::string file_hash(const std::filesystem::path& file);

} // namespace kinelux::core
