// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5_file.h"

#include <cstdio>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5.h>
#include <sys/mman.h>
#include <unistd.h>

#include "core/error.h"
#include "core/hash.h"

namespace kinelux::io {

namespace {

static_assert(std::is_same_v<hid_t, std::int64_t>);
static_assert(sizeof(Vec2) == 2 * sizeof(double) && sizeof(Vec3) == 3 * sizeof(double));

/// Owns one HDF5 identifier; `close` is the H5?close that belongs to it.
class Handle {
public:
    Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
    ~Handle() {
        if (id_ >= 0) close_(id_);
    }
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    operator hid_t() const { return id_; } // NOLINT: it stands for the identifier in C calls
    bool valid() const { return id_ >= 0; }

private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

/// The library prints its error stack on stderr unless told not to; our own messages say what matters.
void silence_library() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

hid_t disk_type(Hdf5Type type) {
    switch (type) {
    case Hdf5Type::Float64: return H5T_IEEE_F64LE;
    case Hdf5Type::Float32: return H5T_IEEE_F32LE;
    case Hdf5Type::UInt8: return H5T_STD_U8LE;
    case Hdf5Type::Int32: return H5T_STD_I32LE;
    case Hdf5Type::UInt32: return H5T_STD_U32LE;
    case Hdf5Type::UInt64: return H5T_STD_U64LE;
    }
    throw std::logic_error("unknown HDF5 type");
}

hid_t memory_type(Hdf5Type type) {
    switch (type) {
    case Hdf5Type::Float64: return H5T_NATIVE_DOUBLE;
    case Hdf5Type::Float32: return H5T_NATIVE_FLOAT;
    case Hdf5Type::UInt8: return H5T_NATIVE_UINT8;
    case Hdf5Type::Int32: return H5T_NATIVE_INT32;
    case Hdf5Type::UInt32: return H5T_NATIVE_UINT32;
    case Hdf5Type::UInt64: return H5T_NATIVE_UINT64;
    }
    throw std::logic_error("unknown HDF5 type");
}

std::uint64_t product(const Hdf5Shape& shape) {
    std::uint64_t count = 1;
    for (const std::uint64_t length : shape) count *= length;
    return count;
}

/// A chunk is the whole dataset, halved along its slowest dimensions until it fits HDF5's chunk cache.
std::vector<hsize_t> chunk_shape(const Hdf5Shape& shape, std::size_t value_size) {
    constexpr std::uint64_t chunk_bytes = 512 * 1024;
    std::vector<hsize_t> chunk(shape.begin(), shape.end());
    for (hsize_t& length : chunk)
        while (length > 1 && product({chunk.begin(), chunk.end()}) * value_size > chunk_bytes)
            length = (length + 1) / 2;
    return chunk;
}

Handle creation_properties(const Hdf5Shape& shape, std::size_t value_size) {
    constexpr unsigned deflate_level = 1; // higher levels cost twice the time for a tenth of the size
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_obj_track_times(properties, false); // the same data must give the same bytes
    if (product(shape) > 0) {
        const auto chunk = chunk_shape(shape, value_size);
        H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data());
        H5Pset_shuffle(properties);
        H5Pset_deflate(properties, deflate_level);
    }
    return {properties, H5Pclose};
}

/// HDF5 leaves the first bytes of a file to its user. Ours hold one line with the hash of all that follows: HDF5 itself
/// crashes on damaged files, so that it must not see one.
constexpr std::size_t user_block = 512;

std::string user_line(const std::string& hash) {
    return fmt::format("Kinelux HDF5 file, content hash {}\n", hash);
}

/// The hash of a file's bytes behind the user block; "" when it cannot be read or is no longer than that.
std::string hash_behind_block(const std::filesystem::path& file) {
    std::error_code failed;
    const auto size = std::filesystem::file_size(file, failed);
    if (failed || size <= user_block) return "";
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"),
                                                                 &std::fclose);
    if (!stream) return "";
    void* bytes = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fileno(stream.get()), 0);
    if (bytes == MAP_FAILED) return "";
    const std::string_view all(static_cast<const char*>(bytes), size);
    std::string hash = core::content_hash(all.substr(user_block));
    munmap(bytes, size);
    return hash;
}

bool seal(const std::filesystem::path& file) {
    const std::string line = user_line(hash_behind_block(file));
    std::fstream out(file, std::ios::binary | std::ios::in | std::ios::out);
    out.write(line.data(), static_cast<std::streamsize>(line.size()));
    out.close();
    return !out.fail();
}

bool seal_is_whole(const std::filesystem::path& file) {
    const std::string hash = hash_behind_block(file), wanted = user_line(hash);
    std::string found(wanted.size(), '\0');
    std::ifstream in(file, std::ios::binary);
    return !hash.empty() && in.read(found.data(), static_cast<std::streamsize>(found.size())) &&
           found == wanted;
}

/// What a file holds is on the disk, not only with the system, when this is true.
bool reaches_disk(const std::filesystem::path& file) {
    const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return false;
    const bool done = fsync(descriptor) == 0;
    return close(descriptor) == 0 && done;
}

hid_t create_file(const std::filesystem::path& file) {
    const Handle properties(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    H5Pset_userblock(properties, user_block);
    H5Pset_obj_track_times(properties, false);
    return H5Fcreate(file.c_str(), H5F_ACC_TRUNC, properties, H5P_DEFAULT);
}

Handle text_type() {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, H5T_VARIABLE);
    H5Tset_cset(type, H5T_CSET_UTF8);
    return {type, H5Tclose};
}

core::FileError cannot_write(const std::filesystem::path& file) {
    return core::FileError(
        fmt::format("{}: cannot be written; is the folder there, writable and not full?", file.string()));
}

void write_attribute(hid_t file, const std::string& name, hid_t disk, hid_t memory, const void* value) {
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const Handle attribute(H5Acreate2(file, name.c_str(), disk, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    if (!attribute.valid() || H5Awrite(attribute, memory, value) < 0)
        throw core::FileError(fmt::format("attribute '{}' cannot be written; is the disk full?", name));
}

void read_attribute(hid_t file, const std::string& name, H5T_class_t expected, hid_t memory, void* value) {
    const Handle attribute(H5Aopen(file, name.c_str(), H5P_DEFAULT), H5Aclose);
    if (!attribute.valid()) throw core::FileError(fmt::format("attribute '{}' is missing", name));
    const Handle type(H5Aget_type(attribute), H5Tclose);
    const Handle space(H5Aget_space(attribute), H5Sclose);
    const bool fits = H5Tget_class(type) == expected && H5Sget_simple_extent_npoints(space) == 1 &&
                      (expected != H5T_STRING || H5Tis_variable_str(type) > 0);
    if (!fits || H5Aread(attribute, memory, value) < 0)
        throw core::FileError(fmt::format("attribute '{}' is unreadable", name));
}

} // namespace

Hdf5Writer::Hdf5Writer(std::filesystem::path file) : file_(std::move(file)), part_(file_) {
    silence_library();
    part_ += ".part";
    handle_ = create_file(part_);
    if (handle_ < 0) throw cannot_write(file_);
}

Hdf5Writer::~Hdf5Writer() {
    if (handle_ < 0) return;
    H5Fclose(handle_);
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
}

void Hdf5Writer::attribute(const std::string& name, const std::string& value) {
    const Handle type = text_type();
    const char* bytes = value.c_str();
    write_attribute(handle_, name, type, type, &bytes);
}

void Hdf5Writer::attribute(const std::string& name, double value) {
    write_attribute(handle_, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

void Hdf5Writer::attribute(const std::string& name, std::int64_t value) {
    write_attribute(handle_, name, H5T_STD_I64LE, H5T_NATIVE_INT64, &value);
}

void Hdf5Writer::dataset(const std::string& name, const std::vector<Vec2>& values) {
    write(name, Hdf5Type::Float64, values.data(), 2 * values.size(), {values.size(), 2});
}

void Hdf5Writer::dataset(const std::string& name, const std::vector<Vec3>& values) {
    write(name, Hdf5Type::Float64, values.data(), 3 * values.size(), {values.size(), 3});
}

void Hdf5Writer::dataset(const std::string& name, const std::vector<std::array<std::uint32_t, 3>>& values) {
    write(name, Hdf5Type::UInt32, values.data(), 3 * values.size(), {values.size(), 3});
}

void Hdf5Writer::write(const std::string& name, Hdf5Type type, const void* values, std::size_t count,
                       const Hdf5Shape& shape) {
    if (product(shape) != count)
        throw std::logic_error("dataset " + name + ": shape and number of values differ");
    const std::vector<hsize_t> extent(shape.begin(), shape.end());
    const Handle space(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose);
    const Handle link(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    H5Pset_create_intermediate_group(link, 1);
    const Handle creation = creation_properties(shape, H5Tget_size(disk_type(type)));
    const Handle set(H5Dcreate2(handle_, name.c_str(), disk_type(type), space, link, creation, H5P_DEFAULT),
                     H5Dclose);
    const bool written = set.valid() && (count == 0 || H5Dwrite(set, memory_type(type), H5S_ALL, H5S_ALL,
                                                                H5P_DEFAULT, values) >= 0);
    if (!written) throw cannot_write(file_);
}

void Hdf5Writer::finish() {
    const hid_t handle = std::exchange(handle_, -1);
    const bool whole = H5Fflush(handle, H5F_SCOPE_GLOBAL) >= 0;
    if (H5Fclose(handle) < 0 || !whole || !seal(part_) || !reaches_disk(part_)) {
        std::error_code ignored;
        std::filesystem::remove(part_, ignored);
        throw cannot_write(file_);
    }
    std::error_code failed;
    std::filesystem::rename(part_, file_, failed);
    if (failed) throw cannot_write(file_);
}

Hdf5Reader::Hdf5Reader(const std::filesystem::path& file) {
    silence_library();
    if (!seal_is_whole(file))
        throw core::FileError("truncated, damaged, or not an HDF5 file of this program");
    handle_ = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    if (handle_ < 0) throw core::FileError("not an HDF5 file");
}

Hdf5Reader::~Hdf5Reader() { H5Fclose(handle_); }

std::string Hdf5Reader::text(const std::string& name) const {
    const Handle type = text_type();
    char* bytes = nullptr;
    read_attribute(handle_, name, H5T_STRING, type, &bytes);
    std::string value = bytes == nullptr ? "" : bytes;
    H5free_memory(bytes);
    return value;
}

double Hdf5Reader::number(const std::string& name) const {
    double value = 0.0;
    read_attribute(handle_, name, H5T_FLOAT, H5T_NATIVE_DOUBLE, &value);
    return value;
}

std::int64_t Hdf5Reader::integer(const std::string& name) const {
    std::int64_t value = 0;
    read_attribute(handle_, name, H5T_INTEGER, H5T_NATIVE_INT64, &value);
    return value;
}

Hdf5Shape Hdf5Reader::shape(const std::string& name) const {
    const Handle set(H5Dopen2(handle_, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!set.valid()) throw core::FileError(fmt::format("dataset '{}' is missing or unreadable", name));
    const Handle space(H5Dget_space(set), H5Sclose);
    const int dimensions = H5Sget_simple_extent_ndims(space);
    if (dimensions < 1) throw core::FileError(fmt::format("dataset '{}' has no extent", name));
    std::vector<hsize_t> extent(static_cast<std::size_t>(dimensions));
    H5Sget_simple_extent_dims(space, extent.data(), nullptr);
    return {extent.begin(), extent.end()};
}

std::uint64_t Hdf5Reader::rows(const std::string& name) const { return shape(name).front(); }

std::size_t Hdf5Reader::checked_size(const std::string& name, Hdf5Type type,
                                     const Hdf5Shape& expected) const {
    const Hdf5Shape found = shape(name);
    if (found != expected)
        throw core::FileError(fmt::format("dataset '{}' has shape {}, expected {}", name, found, expected));
    const Handle set(H5Dopen2(handle_, name.c_str(), H5P_DEFAULT), H5Dclose);
    const Handle stored(H5Dget_type(set), H5Tclose);
    if (H5Tequal(stored, disk_type(type)) <= 0)
        throw core::FileError(fmt::format("dataset '{}' holds another type of number than expected", name));
    return product(found);
}

void Hdf5Reader::read(const std::string& name, Hdf5Type type, void* values) const {
    const Handle set(H5Dopen2(handle_, name.c_str(), H5P_DEFAULT), H5Dclose);
    const Handle space(H5Dget_space(set), H5Sclose);
    if (H5Sget_simple_extent_npoints(space) == 0) return;
    if (H5Dread(set, memory_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
        throw core::FileError(fmt::format("dataset '{}' is damaged", name));
}

std::vector<Vec2> Hdf5Reader::points_2d(const std::string& name) const {
    std::vector<Vec2> points(checked_size(name, Hdf5Type::Float64, {rows(name), 2}) / 2);
    read(name, Hdf5Type::Float64, points.data());
    return points;
}

std::vector<Vec3> Hdf5Reader::points_3d(const std::string& name) const {
    std::vector<Vec3> points(checked_size(name, Hdf5Type::Float64, {rows(name), 3}) / 3);
    read(name, Hdf5Type::Float64, points.data());
    return points;
}

std::vector<std::array<std::uint32_t, 3>> Hdf5Reader::triangles(const std::string& name) const {
    std::vector<std::array<std::uint32_t, 3>> triangles(
        checked_size(name, Hdf5Type::UInt32, {rows(name), 3}) / 3);
    read(name, Hdf5Type::UInt32, triangles.data());
    return triangles;
}

} // namespace kinelux::io
