// Little-endian scalars in byte buffers, for headers and tables. The library supports little-endian machines only
// (checked at compile time), so this is memcpy with a bounds check.
#pragma once

#include "pcm/system/error.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <type_traits>
#include <vector>

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "chunk and index files are little-endian");

namespace pcm {

class ByteWriter {
public:
    template <class T>
    void put(T value)
    {
        static_assert(std::is_arithmetic_v<T>);
        const std::size_t at = bytes_.size();
        bytes_.resize(at + sizeof(T));
        std::memcpy(bytes_.data() + at, &value, sizeof(T));
    }
    void put_bytes(const void* from, std::size_t count)
    {
        const std::size_t at = bytes_.size();
        bytes_.resize(at + count);
        if (count) std::memcpy(bytes_.data() + at, from, count);
    }
    // u32 length, then the bytes.
    void put_string(const std::string& text)
    {
        put(static_cast<std::uint32_t>(text.size()));
        put_bytes(text.data(), text.size());
    }
    template <class T>
    void set(std::size_t at, T value)
    {
        std::memcpy(bytes_.data() + at, &value, sizeof(T));
    }
    std::size_t size() const { return bytes_.size(); }
    std::vector<std::byte>& bytes() { return bytes_; }

private:
    std::vector<std::byte> bytes_;
};

// Reads what ByteWriter wrote. Reading past the end throws Error(corrupt), naming the byte.
class ByteReader {
public:
    ByteReader(const std::byte* data, std::size_t size, const std::filesystem::path& path)
        : data_(data), size_(size), path_(path)
    {
    }
    template <class T>
    T get()
    {
        static_assert(std::is_arithmetic_v<T>);
        T value;
        require(sizeof(T));
        std::memcpy(&value, data_ + at_, sizeof(T));
        at_ += sizeof(T);
        return value;
    }
    const std::byte* get_bytes(std::size_t count)
    {
        require(count);
        at_ += count;
        return data_ + at_ - count;
    }
    std::string get_string()
    {
        const auto count = get<std::uint32_t>();
        const auto* from = reinterpret_cast<const char*>(get_bytes(count));
        return std::string(from, count);
    }
    std::size_t position() const { return at_; }
    std::size_t left() const { return size_ - at_; }

private:
    void require(std::size_t count) const
    {
        if (count > size_ - at_)
            throw Error(ErrorCode::corrupt, path_,
                        "the data ends at byte " + std::to_string(size_) + " where " + std::to_string(count) +
                            " more bytes were expected from byte " + std::to_string(at_));
    }
    const std::byte* data_;
    std::size_t size_;
    std::size_t at_ = 0;
    const std::filesystem::path& path_;
};

}  // namespace pcm
