// Primitives to write, and what is read of the written files.
#pragma once

#include "pcm/shapes/primitive.h"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace pcm::test {

inline std::string text_of_file(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

inline std::vector<std::string> lines_of(const std::filesystem::path& path)
{
    std::vector<std::string> lines;
    std::istringstream text(text_of_file(path));
    for (std::string line; std::getline(text, line);) {
        if (!line.empty() && line.back() == '\r') line.pop_back();
        lines.push_back(line);
    }
    return lines;
}

inline Primitive made(const char* shape, const std::string& name)
{
    Primitive primitive;
    primitive.name = name;
    primitive.fit.shape = parse_shape(shape);
    primitive.fit.verdict = FitVerdict::good;
    return primitive;
}

}  // namespace pcm::test
