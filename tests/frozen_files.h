// Files of what a test kept of an earlier run, one for each of its cases.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace pcm::test {

// Whether files are to be written anew instead of being compared.
inline bool is_freezing() { return std::getenv("PCM_FREEZE") != nullptr; }

// Two cases of one name, and a file without a case, are failures.
inline void expect_files_of(const std::vector<std::string>& cases, const std::filesystem::path& folder)
{
    std::set<std::string> names;
    for (const std::string& name : cases) EXPECT_TRUE(names.insert(name).second) << name << " is there twice";
    for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(folder))
        EXPECT_TRUE(names.count(entry.path().stem().string())) << entry.path();
}

}  // namespace pcm::test
