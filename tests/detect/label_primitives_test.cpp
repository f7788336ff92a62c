// Which attributes labels of primitives may be written to.
#include "pcm/detect/detect.h"
#include "tests/place/shape_cloud.h"

namespace {

using namespace pcm;
using namespace pcm::test;

TEST(LabelPrimitives, NamesWithAMeaningAreRefusedUnlessValuesMayBeLost)
{
    const TemporaryFolder folder;
    const auto tree = build_surface_tree(folder.path(), {{{0, 0, 0}, {}}, {{1, 0, 0}, {}}, {{0, 1, 0}, {}}});
    LabelOptions options;
    EXPECT_NO_THROW(check_label_attribute(*tree, options));
    options.attribute = "classification";
    EXPECT_THROW(check_label_attribute(*tree, options), Error);
    options.overwrite = true;
    EXPECT_NO_THROW(check_label_attribute(*tree, options));
}

}  // namespace
