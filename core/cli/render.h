// pcmlab-render, the program beside pcmlab that has OpenGL: pcmlab itself loads none. It is started with the name of
// the command as its own name.
#pragma once

#include "pcm/update/target.h"

#include <cstdint>
#include <string>

namespace pcm::cli {

// `pcmlab render`; arguments[0] is "render". Replaces this process. Throws Error(not_found) when the program is
// missing.
void start_render(char** arguments);

// Radii by compute shaders (gpu_radii.h); measured across the tree's normals where it has them.
struct GpuRadii {
    std::string tree;
    TargetChoice target;
    std::uint32_t neighbours = 16;
    std::uint64_t memory = std::uint64_t(512) << 20;        // of the cache for chunks
    std::uint64_t video_memory = std::uint64_t(512) << 20;  // of the cache for chunks there
    bool json = false, quiet = false;                       // Common
};

// Replaces this process by one that computes them and prints its report. Throws Error(not_found) when the program is
// missing.
[[noreturn]] void start_gpu_radii(const GpuRadii& radii);

}  // namespace pcm::cli
