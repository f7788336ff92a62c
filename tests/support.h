// Shared by tests: a temporary folder, the sample clouds.
#pragma once

#include "tests/paths.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace pcm::test {

// A new folder; the destructor removes it with its contents.
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

inline std::filesystem::path sample(const std::string& name)
{
    return std::filesystem::path(paths::sample_clouds) / name;
}

}  // namespace pcm::test

// Skips the test, with a message, when a sample cloud is missing.
#define PCM_REQUIRE_SAMPLE(name)                           \
    if (!std::filesystem::exists(pcm::test::sample(name))) \
    GTEST_SKIP() << "sample cloud " << pcm::test::sample(name) << " is missing"
