// The help offers what is installed, and nothing else.

#include "tests/cli/command.h"

namespace {

using namespace pcm::test;
namespace fs = std::filesystem;

class BackendsTest : public CommandTest {
protected:
    // The command in a folder with nothing next to it but its library: how it is called there.
    std::string called_alone()
    {
        const fs::path folder = fs::path(pcm::paths::command).parent_path();
        for (const char* const name : {"pcmlab", "libpcmlab.so"}) {
            std::error_code other_disk;
            fs::create_hard_link(folder / name, folder_ / name, other_disk);
            if (other_disk) fs::copy_file(folder / name, folder_ / name);
        }
        return "LD_LIBRARY_PATH=" + path("") + " " + path("pcmlab");
    }
};

TEST_F(BackendsTest, HelpShowsWhatIsInstalledBesideTheCommand)
{
    const std::string alone = called_alone();
    const auto help_of = [&](const std::string& command, const std::string& topic) {
        FILE* pipe = popen((command + " help " + topic).c_str(), "r");
        std::string text;
        std::array<char, 4096> buffer;
        for (std::size_t n; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) text.append(buffer.data(), n);
        EXPECT_EQ(pclose(pipe), 0);
        return text;
    };
    const fs::path modules = fs::path(pcm::paths::command).parent_path() / "../lib/pcmlab";
    for (const auto& [module, topic, option] : {std::array<const char*, 3>{"libpcm_flann.so", "normals", "--flann"},
                                                std::array<const char*, 3>{"libpcm_pcl.so", "fit", "--backend"}}) {
        EXPECT_EQ(help_of("'" + std::string(pcm::paths::command) + "'", topic).find(option) != std::string::npos,
                  fs::exists(modules / module));
        EXPECT_EQ(help_of(alone, topic).find(option), std::string::npos) << topic;
    }
}

TEST_F(BackendsTest, ABackendThatIsNotThereIsNamedWithWhatToInstall)
{
    ASSERT_EQ(pcmlab("generate -n 3000 " + path("scene.las")).code, 0);
    ASSERT_EQ(pcmlab("build " + path("scene.las")).code, 0);
    const fs::path err = folder_ / "err.txt";
    const int code = std::system((called_alone() + " normals --flann " + path("scene.pct") + " -o " + path("n.pct") +
                                  " >'" + err.string() + "' 2>&1")
                                     .c_str());
    EXPECT_NE(code, 0);
    std::ifstream file(err);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    EXPECT_NE(text.find("libpcm_flann.so"), std::string::npos) << text;
}

}  // namespace
