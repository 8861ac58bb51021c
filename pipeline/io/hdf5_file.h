// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/vec.h"

namespace kinelux::io {

/// Shape of a dataset, slowest dimension first.
using Hdf5Shape = std::vector<std::uint64_t>;

/// Element types that files hold: double, float, uint8, int32, uint32, uint64; little-endian on disk.
enum class Hdf5Type { Float64, Float32, UInt8, Int32, UInt32, UInt64 };

template <class Value>
constexpr Hdf5Type hdf5_type() {
    if constexpr (std::is_same_v<Value, double>)
        return Hdf5Type::Float64;
    else if constexpr (std::is_same_v<Value, float>)
        return Hdf5Type::Float32;
    else if constexpr (std::is_same_v<Value, std::uint8_t>)
        return Hdf5Type::UInt8;
    else if constexpr (std::is_same_v<Value, std::int32_t>)
        return Hdf5Type::Int32;
    else if constexpr (std::is_same_v<Value, std::uint32_t>)
        return Hdf5Type::UInt32;
    else {
        static_assert(std::is_same_v<Value, std::uint64_t>, "not a type of our HDF5 files");
        return Hdf5Type::UInt64;
    }
}

/// Writes one HDF5 file aside (NAME.part); finish() renames it. The same calls give the same bytes. Datasets are
/// chunked, shuffled and deflated; names are paths, groups on the way are made. The file's user block (its first 512
/// bytes) holds a hash of the rest.
class Hdf5Writer {
public:
    /// @throws FileError  the file cannot be made
    explicit Hdf5Writer(std::filesystem::path file);
    ~Hdf5Writer();
    Hdf5Writer(const Hdf5Writer&) = delete;
    Hdf5Writer& operator=(const Hdf5Writer&) = delete;

    void attribute(const std::string& name, const std::string& value);
    void attribute(const std::string& name, double value);
    void attribute(const std::string& name, std::int64_t value);

    /// @param shape  its product is values.size()
    template <class Value>
    void dataset(const std::string& name, std::span<const Value> values, const Hdf5Shape& shape) {
        write(name, hdf5_type<Value>(), values.data(), values.size(), shape);
    }
    template <class Value>
    void dataset(const std::string& name, const std::vector<Value>& values) {
        dataset(name, std::span<const Value>(values), {values.size()});
    }
    void dataset(const std::string& name, const std::vector<Vec2>& values);
    void dataset(const std::string& name, const std::vector<Vec3>& values);
    void dataset(const std::string& name, const std::vector<std::array<std::uint32_t, 3>>& values);

    /// Closes, waits for the disk, and renames. @throws FileError  e.g. the disk is full
    void finish();

private:
    void write(const std::string& name, Hdf5Type type, const void* values, std::size_t count,
               const Hdf5Shape& shape);

    std::filesystem::path file_, part_;
    std::int64_t handle_ = -1; ///< a hid_t
};

/// Reads one HDF5 file of Hdf5Writer. Everything throws FileError that says what is wrong with which dataset, without the file's name.
class Hdf5Reader {
public:
    explicit Hdf5Reader(const std::filesystem::path& file);
    ~Hdf5Reader();
    Hdf5Reader(const Hdf5Reader&) = delete;
    Hdf5Reader& operator=(const Hdf5Reader&) = delete;

    std::string text(const std::string& name) const;     ///< an attribute
    double number(const std::string& name) const;        ///< an attribute
    std::int64_t integer(const std::string& name) const; ///< an attribute

    Hdf5Shape shape(const std::string& name) const;
    /// All values of a dataset that must have this shape.
    template <class Value>
    std::vector<Value> dataset(const std::string& name, const Hdf5Shape& expected) const {
        std::vector<Value> values(checked_size(name, hdf5_type<Value>(), expected));
        read(name, hdf5_type<Value>(), values.data());
        return values;
    }
    /// All values of a dataset with one dimension, of any length.
    template <class Value>
    std::vector<Value> dataset(const std::string& name) const {
        return dataset<Value>(name, {rows(name)});
    }
    std::vector<Vec2> points_2d(const std::string& name) const;                         ///< shape n x 2
    std::vector<Vec3> points_3d(const std::string& name) const;                         ///< shape n x 3
    std::vector<std::array<std::uint32_t, 3>> triangles(const std::string& name) const; ///< shape n x 3

private:
    std::uint64_t rows(const std::string& name) const;
    std::size_t checked_size(const std::string& name, Hdf5Type type, const Hdf5Shape& expected) const;
    void read(const std::string& name, Hdf5Type type, void* values) const;

    std::int64_t handle_ = -1; ///< a hid_t
};

} // namespace kinelux::io
