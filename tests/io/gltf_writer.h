// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace kinelux::support {

/// Collects the numbers of a glTF file and the JSON of its accessors.
class GltfWriter {
public:
    /// @param type  "SCALAR", "VEC3" or "VEC4"; @return  number of the accessor
    int add(const std::vector<float>& values, const std::string& type) {
        const std::size_t width = type == "SCALAR" ? 1 : type == "VEC3" ? 3 : 4;
        return add(values.data(), values.size() * sizeof(float), values.size() / width, 5126, type);
    }
    int add(const std::vector<std::uint32_t>& indices) {
        return add(indices.data(), indices.size() * sizeof(std::uint32_t), indices.size(), 5125, "SCALAR");
    }

    /// The JSON of the whole file; `rest` is everything but asset, accessors, bufferViews and buffers.
    std::string json(const std::string& rest, const std::string& buffer_uri) const {
        const std::string uri = buffer_uri.empty() ? "" : ",\"uri\":\"" + buffer_uri + "\"";
        return "{\"asset\":{\"version\":\"2.0\"},\"accessors\":[" + accessors_ + "],\"bufferViews\":[" +
               views_ + "],\"buffers\":[{\"byteLength\":" + std::to_string(bytes_.size()) + uri + "}]," +
               rest + "}";
    }
    std::string glb(const std::string& rest) const {
        std::string text = json(rest, "");
        text.resize((text.size() + 3) / 4 * 4, ' ');
        const std::size_t length = 12 + 8 + text.size() + 8 + bytes_.size();
        return "glTF" + number(2) + number(length) + number(text.size()) + "JSON" + text +
               number(bytes_.size()) + std::string("BIN\0", 4) + bytes_;
    }
    const std::string& bytes() const { return bytes_; }

private:
    static std::string number(std::size_t value) {
        const auto small = static_cast<std::uint32_t>(value);
        std::string text(4, '\0');
        std::memcpy(text.data(), &small, 4);
        return text;
    }
    int add(const void* data, std::size_t size, std::size_t count, int component, const std::string& type) {
        const std::string comma = count_ == 0 ? "" : ",";
        views_ += comma + "{\"buffer\":0,\"byteOffset\":" + std::to_string(bytes_.size()) +
                  ",\"byteLength\":" + std::to_string(size) + "}";
        accessors_ += comma + "{\"bufferView\":" + std::to_string(count_) +
                      ",\"componentType\":" + std::to_string(component) +
                      ",\"count\":" + std::to_string(count) + ",\"type\":\"" + type + "\"}";
        bytes_.append(static_cast<const char*>(data), size);
        return count_++;
    }

    std::string bytes_, views_, accessors_;
    int count_ = 0;
};

} // namespace kinelux::support
