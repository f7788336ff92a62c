// What the tests of builds share.
#pragma once

#include "pcm/build/builder.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

namespace pcm::test {

inline BuildOptions small_chunks(std::uint32_t chunk_points = 1000)
{
    BuildOptions options;
    options.chunk_points = chunk_points;
    options.memory_bytes = 64 << 20;
    options.threads = 2;
    return options;
}

using Contents = std::map<std::string, std::string>;

// The bytes of each file of a folder.
inline Contents contents(const std::filesystem::path& folder)
{
    Contents files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        std::ifstream file(entry.path(), std::ios::binary);
        files[entry.path().filename()] = std::string(std::istreambuf_iterator<char>(file), {});
    }
    return files;
}

inline std::vector<std::string> names_in(const std::filesystem::path& folder)
{
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace pcm::test
