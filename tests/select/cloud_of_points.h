// A tree at map coordinates and all its points, for comparisons by brute force.
#pragma once

#include "pcm/build/builder.h"
#include "pcm/query/point_set.h"
#include "pcm/tree/source_rounding.h"
#include "pcm/update/append.h"
#include "tests/clouds.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace pcm::test {

struct KnownPoint {
    NodeId node = no_node;
    std::uint32_t number = 0;
    Vec3d position{};
    double classification = 0, intensity = 0;
};

class CloudOfPoints : public testing::Test {
protected:
    // Two parts: the records of one seed, and those of another that were appended.
    void make(Shape shape, std::size_t count, std::uint32_t chunk_points = 1000)
    {
        Grid grid;
        grid.scale = {0.001, 0.001, 0.001};
        grid.offset = {512345, 4812345, 100};
        write_las(folder_ / "a.las", records(shape, count, 3), grid);
        write_las(folder_ / "b.las", records(shape, count / 4, 4), grid);
        BuildOptions options;
        options.chunk_points = chunk_points;
        build_tree({folder_ / "a.las"}, path(), options);
        const auto more = open_reader(folder_ / "b.las");
        append_points(path(), *more, {"b.las"});
        read();
    }
    void read()
    {
        tree_ = Tree::open(path());
        points_.clear();
        const SourceRounding rounding(tree_->info());
        const auto classes = tree_->info().schema.find("classification"),
                   intensity = tree_->info().schema.find("intensity");
        for (NodeId node = 0; node < tree_->nodes().size(); ++node) {
            const Chunk chunk = tree_->read_chunk(node, ColumnSet::all(tree_->info().schema));
            for (std::uint32_t i = 0; i < chunk.points; ++i) {
                KnownPoint point{node, i, rounding(tree_->info().grid.to_source(chunk.positions->grid(i))), 0, 0};
                if (classes) point.classification = chunk.attributes[*classes]->value(i, 0);
                if (intensity) point.intensity = chunk.attributes[*intensity]->value(i, 0);
                points_.push_back(point);
            }
        }
    }
    std::filesystem::path path() const { return folder_ / "cloud.pct"; }

    PointSet expected(const std::function<bool(const KnownPoint&)>& wanted) const
    {
        PointSet set(tree_);
        for (const KnownPoint& point : points_)
            if (wanted(point)) set.combine(SetOperation::add, point.node, {point.number});
        return set;
    }
    Vec3d middle() const { return tree_->info().bounds().centre(); }
    double size() const { return tree_->info().bounds().diagonal(); }

    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
    std::vector<KnownPoint> points_;
};

}  // namespace pcm::test
