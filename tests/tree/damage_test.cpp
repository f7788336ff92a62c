// The command that repairs a tree, as a shell reads it.
#include "pcm/tree/damage.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

using namespace pcm;

namespace {

// What /bin/sh makes of the third word of `command`.
std::string third_word(const std::string& command)
{
    FILE* const shell = ::popen(("set -- " + command + "; printf '%s' \"$3\"").c_str(), "r");
    std::string word;
    for (int c; shell && (c = std::fgetc(shell)) != EOF;) word += static_cast<char>(c);
    if (shell) ::pclose(shell);
    return word;
}

TEST(RepairCommand, IsOneWordForAShellWhateverThePath)
{
    EXPECT_EQ(repair_command("/scans/a-b_2,1.pct"), "pcmlab repair /scans/a-b_2,1.pct");
    EXPECT_EQ(repair_command("/scans/Gr\u00f6\u00dfe.pct"), "pcmlab repair /scans/Gr\u00f6\u00dfe.pct");
    for (const std::string path : {"/scans/old mill.pct", "/it's.pct", "/$HOME/`id`.pct", "~/a.pct", "/a#b;c&d|e.pct",
                                   "/\"q\"\\.pct", "/a\nb.pct", "/[x]{y,z}!*?.pct", "/(a)<b>.pct"})
        EXPECT_EQ(third_word(repair_command(path)), path) << repair_command(path);
    // Not taken for an option.
    EXPECT_EQ(third_word(repair_command("-r.pct")), "./-r.pct");
}

}  // namespace
