// A selection that takes no point of a cloud that has some.

#include "pcm/build/builder.h"
#include "pcm/convert/convert.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "tests/clouds.h"
#include "tests/convert/refusal.h"
#include "tests/support.h"

#include <fstream>
#include <functional>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

TEST(Convert, ASelectionWithoutPointsIsRefusedWithTheCloudsBox)
{
    const Grid grid{{0.01, 0.01, 0.01}, {5e5, 4.8e6, 0}};
    const TemporaryFolder folder;
    write_las(folder / "in.las", records(Shape::surface, 20000, 2), grid);
    BuildOptions build;
    build.chunk_points = 1000;
    build_tree({folder / "in.las"}, folder / "in.pct", build);
    Box3d cloud;
    for (const LasRecord& p : records(Shape::surface, 20000, 2)) cloud.extend(grid.to_source(Vec3i{p.x, p.y, p.z}));
    ConvertOptions beside, none, both;
    beside.cloud.selection.box = Box3d{{0, 0, 0}, {1, 1, 1}};
    beside.overwrite = true;
    none.cloud.selection.where = {parse_condition("intensity>65535")};
    both.cloud.selection.region = Region::sphere({5e5, 4.8e6, 1e5}, 1);
    for (const ConvertOptions& options : {beside, none, both})
        for (const char* input : {"in.las", "in.pct"})
            for (const char* output : {"out.bpc", "out.las", "out.xyz", "out.pct"}) {
                const bool replaces = options.overwrite && output != std::string("out.pct");
                if (replaces) std::ofstream(folder / output) << "precious";
                const std::string what =
                    refusal(ErrorCode::invalid_argument, [&] { convert({folder / input}, folder / output, options); });
                EXPECT_NE(what.find("no point is selected"), std::string::npos) << what;
                EXPECT_NE(what.find(exact(cloud.min) + " to " + exact(cloud.max)), std::string::npos) << what;
                EXPECT_EQ(fs::exists(folder / output), replaces);
                if (replaces) EXPECT_EQ(fs::file_size(folder / output), 8u);
                fs::remove(folder / output);
            }
    // The extent of several inputs is that around all of them.
    const std::string what = refusal(ErrorCode::invalid_argument, [&] {
        convert({folder / "in.las", folder / "in.pct"}, folder / "out.bpc", none);
    });
    EXPECT_NE(what.find(exact(cloud.min) + " to " + exact(cloud.max)), std::string::npos) << what;
    // An input without points is not the selection's fault.
    write_las(folder / "empty.las", {}, grid);
    EXPECT_EQ(convert({folder / "empty.las"}, folder / "out.bpc", none).outcome.points_out, 0u);
}

}  // namespace
