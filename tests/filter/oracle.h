// All points of a tree, and their neighbours by comparing all pairs.
#pragma once

#include "pcm/build/builder.h"
#include "pcm/filter/neighbour_attributes.h"
#include "pcm/tree/tree.h"
#include "tests/memory_reader.h"
#include "tests/support.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace pcm::test {

struct OraclePoint {
    NodeId node = no_node;
    std::uint32_t index = 0;
    std::uint16_t level = 0;
    Vec3i q{};
};

struct OracleNeighbours {
    std::vector<double> x, y, z, squared;
    std::size_t count() const { return squared.size(); }
};

class Oracle {
public:
    explicit Oracle(const std::filesystem::path& path) : tree(Tree::open(path))
    {
        for (NodeId id = 0; id < tree->nodes().size(); ++id) {
            chunks.push_back(tree->read_chunk(id, ColumnSet::all(tree->info().schema)));
            const Node& node = tree->node(id);
            for (std::uint32_t i = 0; i < chunks[id].points; ++i) {
                std::uint16_t level = node.first_level;
                while (i >= node.points_to_level(level)) ++level;
                points.push_back({id, i, level, chunks[id].positions->grid(i)});
            }
        }
    }

    Vec3d offset(const OraclePoint& from, const OraclePoint& to) const
    {
        Vec3d d;
        for (std::size_t a = 0; a < 3; ++a)
            d[a] = static_cast<double>(to.q[a] - from.q[a]) * tree->info().grid.scale[a];
        return d;
    }

    // Nearest first.
    OracleNeighbours neighbours(std::size_t point, std::size_t k, double max_distance = HUGE_VAL) const
    {
        std::vector<std::pair<double, std::size_t>> others;
        for (std::size_t j = 0; j < points.size(); ++j) {
            const Vec3d d = offset(points[point], points[j]);
            const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            if (j != point && square <= max_distance * max_distance) others.emplace_back(square, j);
        }
        const auto end = others.begin() + static_cast<std::ptrdiff_t>(std::min(k, others.size()));
        std::partial_sort(others.begin(), end, others.end());
        OracleNeighbours result;
        for (auto other = others.begin(); other != end; ++other) {
            const Vec3d d = offset(points[point], points[other->second]);
            result.x.push_back(d[0]);
            result.y.push_back(d[1]);
            result.z.push_back(d[2]);
            result.squared.push_back(other->first);
        }
        return result;
    }

    double value(const OraclePoint& point, std::string_view name, std::uint32_t component = 0) const
    {
        const auto place = tree->info().schema.find(name);
        if (!place) throw std::runtime_error("the tree has no attribute " + std::string(name));
        return chunks[point.node].attributes[*place]->value(point.index, component);
    }
    Vec3d normal(const OraclePoint& point) const
    {
        return {value(point, "normal", 0), value(point, "normal", 1), value(point, "normal", 2)};
    }
    Vec3d position(const OraclePoint& point) const { return tree->info().grid.to_source(point.q); }

    std::shared_ptr<const Tree> tree;
    std::vector<Chunk> chunks;
    std::vector<OraclePoint> points;
};

// `count` points of doubles, from a function of three random numbers in 0..1.
inline MemoryCloud cloud_of(std::size_t count, std::uint64_t seed,
                            const std::function<Vec3d(double, double, double)>& f)
{
    std::mt19937_64 random(seed);
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    MemoryCloud cloud;
    cloud.info.format = "in memory";
    cloud.info.points = count;
    cloud.info.position_type = ScalarType::f64;
    cloud.points.reset({}, false, count);
    for (std::size_t i = 0; i < count; ++i) {
        const double u = unit(), v = unit(), w = unit();
        const Vec3d p = f(u, v, w);
        for (std::size_t a = 0; a < 3; ++a) cloud.points.xyz[a][i] = p[a];
    }
    return cloud;
}

inline void build_small(const MemoryCloud& cloud, const std::filesystem::path& path, std::uint32_t chunk_points = 1000)
{
    MemoryReader reader(cloud);
    BuildOptions options;
    options.memory_bytes = 64 << 20;
    options.chunk_points = chunk_points;
    options.threads = 2;
    build_tree(reader, {"memory"}, path, options);
}

inline WantedValues all_values()
{
    WantedValues wanted;
    wanted.radius = wanted.normal = wanted.curvature = wanted.confidence = wanted.mean_distance = true;
    return wanted;
}

inline double degrees(const Vec3d& a, const Vec3d& b)
{
    return std::atan2(length(cross(a, b)), std::fabs(dot(a, b))) * 180 / pi;
}

}  // namespace pcm::test
