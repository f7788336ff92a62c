#include "pcm/place/next_to.h"

#include "pcm/system/progress_part.h"
#include "pcm/tree/source_rounding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <mutex>
#include <unordered_set>
#include <utility>
#include <vector>

namespace pcm {
namespace {

constexpr std::size_t most_cubes = std::size_t(1) << 18;

// Which cubes have points.
class Cubes {
public:
    Cubes(const Vec3d& corner, double edge) : corner_(corner), edge_(edge) {}

    void add(const Vec3d& p)
    {
        const Key key = key_of(p);
        if (key == last_) return;
        last_ = key;
        keys_.insert(key);
        while (keys_.size() > most_cubes) widen();
    }
    bool is_near(const Vec3d& p) const
    {
        const Key key = key_of(p);
        for (std::int64_t n = 0; n < 27; ++n)
            if (keys_.count({key[0] + n % 3 - 1, key[1] + n / 3 % 3 - 1, key[2] + n / 9 - 1}) > 0) return true;
        return false;
    }
    double edge() const { return edge_; }

private:
    using Key = std::array<std::int64_t, 3>;
    struct Hash {
        std::size_t operator()(const Key& key) const
        {
            std::uint64_t hash = 0;
            for (const std::int64_t k : key) hash = (hash ^ static_cast<std::uint64_t>(k)) * 0x9e3779b97f4a7c15u;
            return static_cast<std::size_t>(hash ^ (hash >> 32));
        }
    };
    Key key_of(const Vec3d& p) const
    {
        Key key{};
        for (std::size_t a = 0; a < 3; ++a)
            key[a] = static_cast<std::int64_t>(std::clamp(std::floor((p[a] - corner_[a]) / edge_), -1e15, 1e15));
        return key;
    }
    void widen()
    {
        edge_ *= 2;
        std::unordered_set<Key, Hash> wide;
        for (const Key& key : keys_) wide.insert({key[0] >> 1, key[1] >> 1, key[2] >> 1});
        keys_ = std::move(wide);
        last_ = {std::numeric_limits<std::int64_t>::max(), 0, 0};
    }

    const Vec3d corner_;
    double edge_;
    Key last_{std::numeric_limits<std::int64_t>::max(), 0, 0};
    std::unordered_set<Key, Hash> keys_;
};

ScanOptions positions_of(unsigned threads, const ProgressFunction& progress)
{
    ScanOptions scan;
    scan.columns = ColumnSet::only_positions();
    scan.select.threads = threads;
    scan.select.progress = progress;
    scan.stage = "Finding what is next to the surface";
    return scan;
}

}  // namespace

PointSet points_next_to(const PointSet& points, double way, const PlaceTest& test, const Selection& limit,
                        unsigned threads, const ProgressFunction& progress)
{
    const Tree& tree = points.tree();
    const SourceRounding rounding(tree.info());
    Cubes cubes(tree.info().bounds().min, way);
    Box3d box;
    std::mutex mutex;
    ScanOptions scan = positions_of(threads, part_of(progress, 0, 0.4));
    scan.within = &points;
    scan_points(tree, {}, scan, [&](const ScannedPoints& found) {
        const std::vector<Vec3d> positions = source_positions(found, tree.info().grid, rounding);
        const std::lock_guard lock(mutex);
        for (const Vec3d& p : positions) {
            cubes.add(p);
            box.extend(p);
        }
    });
    PointSet near(points.shared_tree());
    if (box.empty()) return near;
    for (std::size_t a = 0; a < 3; ++a) {
        box.min[a] -= 2 * cubes.edge();
        box.max[a] += 2 * cubes.edge();
        if (limit.box) box.min[a] = std::max(box.min[a], limit.box->min[a]);
        if (limit.box) box.max[a] = std::min(box.max[a], limit.box->max[a]);
    }
    Selection here = limit;
    here.box = box;
    scan = positions_of(threads, part_of(progress, 0.4, 1));
    scan.test = &test;
    scan_points(tree, here, scan, [&](const ScannedPoints& found) {
        const std::vector<Vec3d> positions = source_positions(found, tree.info().grid, rounding);
        std::vector<std::uint32_t> numbers;
        for (std::size_t k = 0; k < positions.size(); ++k)
            if (cubes.is_near(positions[k])) numbers.push_back(found.numbers[k]);
        const std::lock_guard lock(mutex);
        near.set(found.node, numbers);
    });
    return near;
}

}  // namespace pcm
