// The interface between the library and the shared object with FLANN in it, which is loaded only if that backend is
// chosen: core builds and runs without FLANN (a library of its own, licence BSD).
#pragma once

#include <cstddef>
#include <cstdint>

namespace pcm {

// Its single k-d tree, exact for the single-precision coordinates that it gets. Functions that fail return null or
// false and write a text to `message`, which has room for flann_message_bytes.
struct FlannFunctions {
    std::uint32_t version;
    // `xyz`: three coordinates per point, kept by the caller as long as the index lives.
    void* (*make)(const float* xyz, std::size_t points, char* message);
    // The `k` (at most the points) nearest of each query, ascending. Any number of threads.
    bool (*search)(const void* index, const float* xyz, std::size_t queries, std::size_t k, std::size_t* neighbours,
                   float* squared, char* message);
    void (*free)(void* index);
};

inline constexpr std::uint32_t flann_module_version = 1;
inline constexpr std::size_t flann_message_bytes = 256;

// The one symbol of the shared object: see system/shared_module.h.
inline constexpr const char* flann_module_symbol = "pcm_flann_functions";

}  // namespace pcm
