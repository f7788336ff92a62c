// What tests share: a folder that cleans up after itself, the sample clouds, small clouds written in a line.
#pragma once

#include "tests/paths.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace pcm::test {

// A new folder, removed with everything in it at the end of the test.
class TemporaryFolder {
public:
    TemporaryFolder()
    {
        std::string name = (std::filesystem::temp_directory_path() / "pcm-test-XXXXXX").string();
        if (!mkdtemp(name.data())) throw std::runtime_error("cannot make a temporary folder");
        path_ = name;
    }
    ~TemporaryFolder()
    {
        std::error_code ignored;
        std::filesystem::permissions(path_, std::filesystem::perms::owner_all, ignored);
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

private:
    std::filesystem::path path_;
};

inline std::filesystem::path sample(const std::string& name) { return std::filesystem::path(paths::sample_clouds) / name; }

}  // namespace pcm::test

// Skips the test, saying so, when a sample cloud is not on this machine.
#define PCM_REQUIRE_SAMPLE(name)                           \
    if (!std::filesystem::exists(pcm::test::sample(name))) \
    GTEST_SKIP() << "sample cloud " << pcm::test::sample(name) << " is not here"
