#include "pcm/system/text_file.h"

#include "pcm/system/error.h"
#include "tests/support.h"

#include <sys/stat.h>

#include <fstream>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

TEST(TextFile, IsReadWholeOrRefused)
{
    const TemporaryFolder folder;
    const auto refusal = [](const fs::path& file) -> std::string {
        try {
            read_text_file(file, "a list of things", 1000);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    std::ofstream(folder / "a.txt") << std::string(1000, 'a');
    EXPECT_EQ(read_text_file(folder / "a.txt", "a list", 1000), std::string(1000, 'a'));
    std::ofstream(folder / "empty.txt");
    EXPECT_EQ(read_text_file(folder / "empty.txt", "a list", 1000), "");
    fs::create_symlink("a.txt", folder / "link.txt");
    EXPECT_EQ(read_text_file(folder / "link.txt", "a list", 1000).size(), 1000u);

    // Refused by its length, before memory is taken: this one is larger than any.
    fs::resize_file(folder / "a.txt", std::uintmax_t(1) << 40);
    EXPECT_NE(refusal(folder / "a.txt").find("is not a list of things: such a file has at most 1.00 kB"),
              std::string::npos)
        << refusal(folder / "a.txt");
    EXPECT_NE(refusal(folder / "none.txt").find("No such file"), std::string::npos);
    ASSERT_EQ(mkfifo((folder / "fifo").c_str(), 0666), 0);
    EXPECT_NE(refusal(folder / "fifo").find("this is a FIFO"), std::string::npos);
    EXPECT_NE(refusal("/dev/zero").find("this is a device"), std::string::npos);
    EXPECT_NE(refusal(folder / ".").find("this is a folder"), std::string::npos);
}

}  // namespace
