// What holds of the labels of any detection.
#pragma once

#include "pcm/detect/detect.h"
#include "pcm/detect/point_labels.h"
#include "tests/place/shape_cloud.h"

#include <cstdint>
#include <map>
#include <vector>

namespace pcm::test {

// Each label is that of a primitive within the threshold, and each primitive has as many points as it says; labels are
// in the order of the list, most points first.
inline void check_labels(const Tree& tree, const DetectReport& report)
{
    std::map<std::uint32_t, std::uint64_t> counts;
    std::uint64_t labelled = 0;
    NodeId node = no_node;
    std::vector<std::uint32_t> labels;
    for (const PlacedPoint& p : all_points(tree)) {
        if (p.node != node) labels = report.labels->get(node = p.node);
        const std::uint32_t label = labels[p.number];
        if (label == 0) continue;
        ASSERT_LE(label, report.primitives.size());
        ASSERT_LE(distance_to(report.primitives[label - 1].fit.shape, p.position),
                  report.primitives[label - 1].fit.threshold * (1 + 1e-6));
        ++counts[label];
        ++labelled;
    }
    EXPECT_EQ(labelled, report.outcome.points_out);
    for (std::size_t i = 0; i < report.primitives.size(); ++i) {
        const Primitive& primitive = report.primitives[i];
        EXPECT_EQ(primitive.label, i + 1);
        EXPECT_EQ(primitive.points, counts[primitive.label]);
        EXPECT_TRUE(primitive.bounds.known(primitive.fit.shape.kind));
        if (i > 0) EXPECT_LE(primitive.points, report.primitives[i - 1].points);
    }
}

}  // namespace pcm::test
