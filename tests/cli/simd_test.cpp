// Trees do not depend on the vector instructions of the machine that built them.

#include "pcm/system/cpu.h"
#include "tests/cli/command.h"

#include <map>

namespace pcm::test {
namespace {

class SimdLevels : public CommandTest {};

std::map<std::string, std::string> files_of(const std::filesystem::path& folder)
{
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (!entry.is_regular_file()) continue;
        std::ifstream file(entry.path(), std::ios::binary);
        files[std::filesystem::relative(entry.path(), folder).string()].assign(std::istreambuf_iterator<char>(file),
                                                                               {});
    }
    return files;
}

TEST_F(SimdLevels, BuildTheSameBytes)
{
    ASSERT_EQ(pcmlab("generate -q -n 60000 --no-truth " + path("scene.las")).code, 0);
    for (const std::string options : {"", "--fast "}) {
        std::map<std::string, std::string> first;
        for (const SimdLevel level : simd_levels()) {
            const std::string name(name_of(level));
            const std::string tree = "tree" + name + (options.empty() ? "" : "-fast") + ".pct";
            const Result built =
                pcmlab("build -q --chunk-points 5000 " + options + "-o " + path(tree) + " " + path("scene.las"),
                       "PCM_SIMD=" + name);
            ASSERT_EQ(built.code, 0) << built.err;
            const auto files = files_of(folder_ / tree);
            ASSERT_GT(files.size(), 1u);
            if (first.empty()) first = files;
            EXPECT_EQ(files, first) << name << ' ' << options;
        }
    }
}

}  // namespace
}  // namespace pcm::test
