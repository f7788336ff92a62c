// Numbers with which nothing can be computed are refused by every command that takes places, and FIFOs and devices are
// read by none.

#include "tests/cli/command.h"

#include <sys/stat.h>

#include <fstream>

namespace {

using namespace pcm::test;
namespace fs = std::filesystem;

class OutOfRangeTest : public CommandTest {
protected:
    void SetUp() override
    {
        ASSERT_EQ(pcmlab("generate -n 3000 " + path("scene.las")).code, 0);
        ASSERT_EQ(pcmlab("build " + path("scene.las")).code, 0);
    }
    // Not waited for: a command that reads for ever is ended, and fails here.
    Result within_a_minute(const std::string& arguments) { return pcmlab(arguments, "timeout 60"); }
};

TEST_F(OutOfRangeTest, PlacesThatOverflow)
{
    const std::string tree = path("scene.pct");
    for (const std::string& command : {
             "measure point -p V 0 0",
             "measure distance -p -V 0 0 V V 0",
             "measure height -p 0 0 -V 0 0 V",
             "measure angle -p 0 0 0 V 0 0 V V 0",
             "measure area -p 0 0 0 V 0 0 V V 0",
             "measure plane -p V 0 0 1 0 0 0 1 0 0 0 1",
             "measure surface -p 0 0 0 --surface 'plane V 0 0 1 0 0'",
             "measure surface -p 0 0 0 --surface 'sphere 0 0 0 V'",
             "query TREE --nearest V 0 0",
             "pick TREE --ray V 0 0 0 0 1",
             "pick TREE --at 1 1 --eye V 0 0",
             "pick TREE --at 1 1 --height V",
             "fit TREE --at 'V 0 0'",
             "profile TREE --line 0 0 V 0 -w 1",
             "profile TREE --line 0 0 1 0 -w V",
             "volume TREE --reference V",
             "volume TREE --plane V 0 0 0 0 1",
             "select TREE --brush V 0 0 --radius 1",
             "align TREE TREE --pair V 0 0 0 0 0 --pair 1 0 0 1 0 0 --pair 0 1 0 0 1 0",
#ifdef PCM_HAVE_RENDER
             "render TREE -o p.png --eye V 0 0",
             "render TREE -o p.png --target V 0 0",
             "render TREE -o p.png --height V",
#endif
         })
        for (const char* value : {"1e308", "1e200", "nan", "inf"}) {
            std::string words = command;
            const auto replace = [&](const std::string& what, const std::string& by) {
                for (std::size_t at; (at = words.find(what)) != std::string::npos;) words.replace(at, what.size(), by);
            };
            // "-nan" would be an option's name.
            replace("-V", *value == '1' ? std::string("-") + value : value);
            replace("V", value);
            replace("TREE", tree);
            const Result result = within_a_minute(words);
            EXPECT_NE(result.code, 0) << words << ": " << result.out;
            const bool says = result.err.find("out of range") != std::string::npos ||
                              result.err.find("not finite") != std::string::npos ||
                              (*value > '9' && result.err.find("number") != std::string::npos);
            EXPECT_TRUE(says) << words << ": " << result.err;
        }
}

TEST_F(OutOfRangeTest, WhatIsNoFileIsNotRead)
{
    ASSERT_EQ(mkfifo((folder_ / "fifo").c_str(), 0666), 0);
    const std::string tree = path("scene.pct");
    // A list that is added to has its name's ending.
    fs::create_symlink("fifo", folder_ / "list.json");
    const Result added = within_a_minute("fit " + tree + " --at '500030 4800030 100' --add " + path("list.json"));
    EXPECT_EQ(added.code, 1);
    EXPECT_NE(added.err.find("FIFO"), std::string::npos) << added.err;
    for (const std::string& source : {path("fifo"), std::string("/dev/zero"), std::string("/dev/null")})
        for (const std::string& command : {
                 "align " + tree + " " + tree + " --pairs " + source,
                 "measure --list " + source,
                 "primitives " + source,
                 "info " + source,
                 "build -o " + path("o.pct") + " " + source,
                 "convert " + source + " " + path("o.las"),
                 "append " + tree + " " + source,
                 "verify " + source,
                 "merge " + path("m.pct") + " " + tree + " " + source,
#ifdef PCM_HAVE_RENDER
                 "render " + tree + " -o " + path("tour") + " --path " + source,
#endif
             }) {
            const Result result = within_a_minute(command);
            EXPECT_TRUE(result.code == 1 || result.code == 2) << command << ": " << result.code << result.out;
            EXPECT_FALSE(result.err.empty()) << command;
            EXPECT_NE(result.err.find(source.front() == '/' ? "device" : "FIFO"), std::string::npos)
                << command << ": " << result.err;
        }
}

}  // namespace
