// The names of inputs and outputs: files of trees, trees named twice, places inside trees, promises of other formats.

#include "pcm/convert/convert.h"
#include "pcm/convert/open_cloud.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree.h"
#include "pcm/tree/verify.h"
#include "pcm/update/erase.h"
#include "tests/clouds.h"
#include "tests/support.h"

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

class ConvertNames : public testing::Test {
protected:
    ConvertNames()
    {
        write_las(folder_ / "in.las", records(Shape::volume, 5000, 1), {{0.01, 0.01, 0.01}, {0, 0, 0}});
        options_.memory_bytes = 64 << 20;
        options_.chunk_points = 1000;
        options_.overwrite = true;
        convert({folder_ / "in.las"}, tree_, options_);
        // Points that are deleted are still in the data files.
        Selection selection;
        selection.where.push_back(parse_condition("classification=0..15"));
        points_ = 5000 - erase_points(tree_, selection).points_deleted;
    }
    ConvertReport run(const std::vector<fs::path>& inputs, const fs::path& output = "out.bpc")
    {
        return convert(inputs, folder_ / output, options_);
    }
    ErrorCode refusal_of(const std::vector<fs::path>& inputs, const fs::path& output, const std::string& word)
    {
        try {
            run(inputs, output);
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
            return error.code();
        }
        ADD_FAILURE() << output << " was written";
        return ErrorCode::io;
    }
    const TemporaryFolder folder_;
    const fs::path tree_ = folder_ / "in.pct";
    ConvertOptions options_;
    std::uint64_t points_ = 0;
};

TEST_F(ConvertNames, AFileOfATreeStandsForTheTree)
{
    ASSERT_LT(points_, 5000u);
    for (const char* name : {"index.pct", "about.pct", "chunks-000.bpc", "chunks-001.bpc", "lock"}) {
        const ConvertReport report = run({tree_ / name});
        EXPECT_EQ(report.outcome.points_out, points_) << name;
        const bool said = !report.notes.empty() && report.notes[0].find("the whole tree is read") != std::string::npos;
        EXPECT_EQ(said, name != std::string("index.pct")) << name;
    }
    EXPECT_EQ(open_cloud({tree_ / "chunks-000.bpc"})->info().points, points_);
    // On its own such a file is a cloud, with the deleted points.
    fs::copy_file(tree_ / "chunks-000.bpc", folder_ / "chunks-000.bpc");
    EXPECT_EQ(run({folder_ / "chunks-000.bpc"}).outcome.points_out, 5000u);
}

TEST_F(ConvertNames, ATreeNamesWhatItWasMadeFrom)
{
    using Names = std::vector<std::string>;
    EXPECT_EQ(Tree::open(tree_)->info().sources, Names{"in.las"});
    run({tree_}, "copy.pct");
    EXPECT_EQ(Tree::open(folder_ / "copy.pct")->info().sources, Names{"in.pct"});
    fs::copy_file(folder_ / "in.las", folder_ / "more.las");
    run({folder_ / "more.las", tree_}, "both.pct");
    Names both = Tree::open(folder_ / "both.pct")->info().sources;
    std::sort(both.begin(), both.end());
    EXPECT_EQ(both, (Names{"in.pct", "more.las"}));
    CloudSources sources({tree_}, {});
    for (int time = 0; time < 2; ++time) {
        sources.open();
        EXPECT_EQ(sources.names(), Names{"in.pct"});
    }
}

TEST_F(ConvertNames, ATreeIsReadOnce)
{
    fs::create_directory_symlink("in.pct", folder_ / "link.pct");
    const ConvertReport report =
        run({tree_ / "chunks-000.bpc", tree_ / "chunks-001.bpc", tree_, tree_ / "index.pct", folder_ / "link.pct"});
    EXPECT_EQ(report.outcome.points_out, points_);
    EXPECT_EQ(std::count_if(report.notes.begin(), report.notes.end(),
                            [](const std::string& note) { return note.find("read once") != std::string::npos; }),
              4);
}

TEST_F(ConvertNames, ADamagedTreeIsNoFolderOfFiles)
{
    fs::remove(tree_ / index_file_name);
    EXPECT_EQ(refusal_of({tree_}, "out.bpc", "pcmlab repair"), ErrorCode::not_a_tree);
    EXPECT_EQ(refusal_of({tree_ / "chunks-000.bpc"}, "out.bpc", "pcmlab repair"), ErrorCode::not_a_tree);
    EXPECT_FALSE(fs::exists(folder_ / "out.bpc"));
}

TEST_F(ConvertNames, NothingIsWrittenIntoATree)
{
    for (const bool overwrite : {false, true}) {
        options_.overwrite = overwrite;
        for (const char* name : {"in.pct/index.pct", "in.pct/chunks-000.bpc", "in.pct/new.las", "in.pct/new.pct"})
            for (const fs::path& input : {folder_ / "in.las", tree_}) {
                const bool own = name != std::string("in.pct/new.las") && name != std::string("in.pct/new.pct");
                EXPECT_EQ(refusal_of({input}, name, own ? "of the point cloud tree" : "inside the folder"),
                          ErrorCode::invalid_argument);
            }
        EXPECT_EQ(refusal_of({tree_ / "chunks-000.bpc"}, "in.pct", "this is the input"), ErrorCode::invalid_argument);
    }
    EXPECT_EQ(verify_tree(tree_, 1).outcome.points_out, points_);
    EXPECT_TRUE(verify_tree(tree_, 1).notes.empty());
}

TEST_F(ConvertNames, CopcIsNotPromised)
{
    for (const char* name : {"a.copc.laz", "A.COPC.LAZ"}) {
        EXPECT_EQ(refusal_of({folder_ / "in.las"}, name, "COPC is not written"), ErrorCode::unsupported);
        EXPECT_FALSE(fs::exists(folder_ / name));
    }
    EXPECT_EQ(run({folder_ / "in.las"}, "a.copc.las").outcome.points_out, 5000u);
}

TEST_F(ConvertNames, ALinkStaysAndItsTargetIsReplaced)
{
    std::ofstream(folder_ / "real.bpc") << "old";
    fs::create_symlink("real.bpc", folder_ / "link.bpc");
    options_.overwrite = false;
    EXPECT_EQ(refusal_of({tree_}, "link.bpc", "exists already"), ErrorCode::exists);
    options_.overwrite = true;
    EXPECT_EQ(run({tree_}, "link.bpc").outcome.points_out, points_);
    EXPECT_TRUE(fs::is_symlink(folder_ / "link.bpc"));
    EXPECT_EQ(run({folder_ / "real.bpc"}).outcome.points_out, points_);
    // The link is the input under another name.
    fs::create_symlink("in.las", folder_ / "again.las");
    EXPECT_EQ(refusal_of({folder_ / "in.las"}, "again.las", "this is the input"), ErrorCode::invalid_argument);
}

}  // namespace
