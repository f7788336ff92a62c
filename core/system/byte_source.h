// Bytes that are read by their place: a file of this machine (file.h), or one behind a network (remote/).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace pcm {

// Any number of threads may call every member at once. What throws throws Error, and names path().
class ByteSource {
public:
    virtual ~ByteSource() = default;

    // Its name: a path of this machine, or a URL.
    virtual const std::filesystem::path& path() const = 0;
    virtual std::uint64_t size() const = 0;
    // Reads up to `bytes`, fewer at the end; returns how many.
    virtual std::size_t read_some_at(void* to, std::size_t bytes, std::uint64_t offset) const = 0;
    // Whether the name still stands for what is read here.
    virtual bool keeps_its_name() const = 0;

    // Reads all of `bytes`; throws Error(truncated) when the source ends before.
    void read_at(void* to, std::size_t bytes, std::uint64_t offset) const;

protected:
    ByteSource() = default;
    ByteSource(const ByteSource&) = default;
    ByteSource& operator=(const ByteSource&) = default;
};

}  // namespace pcm
