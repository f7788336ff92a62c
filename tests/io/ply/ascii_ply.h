// PLY files as text, for tests.
#pragma once

#include <string>

namespace pcm::test {

inline const std::string xyz = "property float x\nproperty float y\nproperty float z\n";

inline std::string ascii_ply(const std::string& properties, std::size_t count, const std::string& body)
{
    return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) + "\n" + properties + "end_header\n" + body;
}

}  // namespace pcm::test
