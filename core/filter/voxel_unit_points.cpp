#include "pcm/filter/voxel_unit_points.h"

#include "pcm/cloud/vector.h"
#include "pcm/filter/compensated_sum.h"
#include "pcm/filter/copy_points.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

namespace pcm {
namespace {

std::uint32_t stored_count(std::uint64_t count)
{
    if (count > std::numeric_limits<std::uint32_t>::max())
        throw Error(ErrorCode::unsupported, {}, "a voxel has more than 4,294,967,295 points",
                    "choose smaller voxels, or leave out the attribute point_count");
    return static_cast<std::uint32_t>(count);
}

// As flags often are.
bool are_equal_integers(const Column& column)
{
    if (column.type() == ScalarType::f32 || column.type() == ScalarType::f64) return false;
    const std::size_t one = column.point_bytes();
    return column.bytes() >= one && std::memcmp(column.data(), column.data() + one, column.bytes() - one) == 0;
}

// Points after those that a result has.
class ResultEnd {
public:
    ResultEnd(const VoxelRules& rules, VoxelPoints& result) : rules_(rules), result_(result) {}

    void combine(HeldPoints& held)
    {
        PointGroups groups;
        VoxelSort scratch;
        group_by_voxel(held.positions, rules_.options.voxels, scratch, groups);
        scratch = VoxelSort();
        const std::size_t before = result_.points.size, count = groups.size();
        result_.points_in += held.size();
        result_.points.resize(before + count);
        const Positions means = centroids(held.positions, groups);
        if (rules_.options.point == VoxelPoint::nearest) {
            const std::vector<std::uint32_t> chosen = nearest_to(means, held.positions, groups);
            for (std::size_t g = 0; g < count; ++g) put_position(held, chosen[g], before + g);
            for (std::size_t k = 0; k < rules_.from.size(); ++k) {
                Column& to = result_.points.attributes[k];
                copy_points(held.attributes[k], chosen.data(), count, to.data() + before * to.point_bytes());
            }
        } else {
            for (std::size_t a = 0; a < 3; ++a)
                for (std::size_t g = 0; g < count; ++g) result_.points.xyz[a][before + g] = means[g][a];
            for (std::size_t k = 0; k < rules_.from.size(); ++k) {
                if (!are_equal_integers(held.attributes[k]) || rules_.combinations[k] == Combination::direction) {
                    const auto combiner = make_combiner(rules_.from[k], rules_.combinations[k], count);
                    combiner->add(held.attributes[k], groups);
                    put_column(*combiner, k, before);
                } else {
                    const std::vector<std::uint32_t> same(count, 0);  // the mean and the majority of equal integers
                    Column& to = result_.points.attributes[k];
                    copy_points(held.attributes[k], same.data(), count, to.data() + before * to.point_bytes());
                }
                held.attributes[k] = Column();
            }
        }
        for (std::size_t g = 0; g < count; ++g) put_count(groups.points_of(g), before + g);
    }

    void put_column(ColumnCombiner& combiner, std::size_t attribute, std::size_t at)
    {
        Column combined;
        combiner.finish(combined);
        Column& to = result_.points.attributes[attribute];
        if (combined.bytes()) std::memcpy(to.data() + at * to.point_bytes(), combined.data(), combined.bytes());
    }

    void put_count(std::uint64_t count, std::size_t at)
    {
        result_.most_in_one = std::max(result_.most_in_one, count);
        if (rules_.options.count) result_.points.attributes.back().as<std::uint32_t>()[at] = stored_count(count);
    }

private:
    void put_position(const HeldPoints& held, std::size_t point, std::size_t to)
    {
        for (std::size_t a = 0; a < 3; ++a) {
            if (rules_.gridded)
                result_.points.grid_xyz[a][to] = held.grid[a][point];
            else
                result_.points.xyz[a][to] = held.positions[point][a];
        }
    }

    const VoxelRules& rules_;
    VoxelPoints& result_;
};

class UnitCombiner {
public:
    UnitCombiner(const VoxelPlan& plan, VoxelPoints& result)
        : plan_(plan), rules_(plan.rules), result_(result), end_(plan.rules, result), from_(plan.rules.from)
    {
        result.points.reset(rules_.schema, rules_.gridded, 0);
    }

    void combine(const VoxelUnit& unit)
    {
        const Box3i box = grid_box_of(plan_.cloud, rules_.options.voxels, unit);
        if (box.empty()) return;
        if (unit.is_one()) return combine_one(box);
        HeldPoints loaded;
        if (load(box, loaded)) {
            if (loaded.size() > 0) end_.combine(loaded);
            return;
        }
        const auto parts = divide_unit(unit, rules_.options.voxels, loaded.positions);
        loaded = HeldPoints();
        combine(parts.first);
        combine(parts.second);
    }

private:
    void check_stopped() const
    {
        if (plan_.stopped) throw Error(ErrorCode::cancelled, {}, "cancelled");
    }

    // Returns false, with the positions of some points, when there are too many.
    bool load(const Box3i& box, HeldPoints& loaded) const
    {
        for (const Attribute& attribute : from_) loaded.attributes.emplace_back(attribute);
        bool whole = true;
        plan_.cloud.visit(box, ColumnSet::all(from_), [&](PointsInBox& part) {
            check_stopped();
            whole = loaded.size() + part.size() <= plan_.most_points;
            const std::size_t before = loaded.size();
            plan_.cloud.append(part, loaded.positions);
            if (!whole) return false;
            const std::uint32_t* const points = part.all ? nullptr : part.indices.data();
            for (std::size_t k = 0; k < from_.size(); ++k) {
                Column& to = loaded.attributes[k];
                to.resize(before + part.size());
                copy_points(*part.chunk.attributes[k], points, part.size(), to.data() + before * to.point_bytes());
            }
            if (rules_.gridded)
                for (std::size_t a = 0; a < 3; ++a)
                    for (std::size_t i = 0; i < part.size(); ++i)
                        loaded.grid[a].push_back(
                            static_cast<std::int32_t>(part.chunk.positions->grid(part.index(i), a)));
            return true;
        });
        return whole;
    }

    // The points in `box`, a single voxel, without keeping them.
    void combine_one(const Box3i& box)
    {
        const bool centroid = rules_.options.point == VoxelPoint::centroid;
        Vec3d first{0, 0, 0};
        std::array<CompensatedSum, 3> sums;
        std::uint64_t count = 0;
        std::vector<std::unique_ptr<ColumnCombiner>> combiners;
        for (std::size_t k = 0; centroid && k < from_.size(); ++k)
            combiners.push_back(make_combiner(from_[k], rules_.combinations[k], 1));
        const ColumnSet columns = centroid ? ColumnSet::all(from_) : ColumnSet::only_positions();
        plan_.cloud.visit(box, columns, [&](PointsInBox& part) {
            check_stopped();
            Positions some;
            plan_.cloud.append(part, some);
            if (count == 0) first = some[0];
            for (const Vec3d& p : some)
                for (std::size_t a = 0; a < 3; ++a) sums[a].add(p[a] - first[a]);
            count += part.size();
            PointGroups groups;
            for (std::size_t i = 0; centroid && i < part.size(); ++i)
                groups.order.push_back(static_cast<std::uint32_t>(part.index(i)));
            groups.begins = {0, static_cast<std::uint32_t>(groups.order.size())};
            for (std::size_t k = 0; k < combiners.size(); ++k) combiners[k]->add(*part.chunk.attributes[k], groups);
            return true;
        });
        if (count == 0) return;
        Vec3d mean;
        for (std::size_t a = 0; a < 3; ++a) mean[a] = first[a] + sums[a].value() / static_cast<double>(count);
        const std::size_t at = result_.points.size;
        result_.points_in += count;
        result_.points.resize(at + 1);
        if (centroid)
            for (std::size_t a = 0; a < 3; ++a) result_.points.xyz[a][at] = mean[a];
        else
            put_nearest(box, mean, at);
        for (std::size_t k = 0; k < combiners.size(); ++k) end_.put_column(*combiners[k], k, at);
        end_.put_count(count, at);
    }

    // The point in `box` that is nearest to `mean`.
    void put_nearest(const Box3i& box, const Vec3d& mean, std::size_t at)
    {
        double least = std::numeric_limits<double>::infinity();
        plan_.cloud.visit(box, ColumnSet::all(from_), [&](PointsInBox& part) {
            check_stopped();
            Positions some;
            plan_.cloud.append(part, some);
            for (std::size_t i = 0; i < part.size(); ++i) {
                const double square = squared_distance(some[i], mean);
                if (square >= least) continue;
                least = square;
                const auto point = static_cast<std::uint32_t>(part.index(i));
                for (std::size_t a = 0; a < 3; ++a) {
                    if (rules_.gridded)
                        result_.points.grid_xyz[a][at] =
                            static_cast<std::int32_t>(part.chunk.positions->grid(point, a));
                    else
                        result_.points.xyz[a][at] = some[i][a];
                }
                for (std::size_t k = 0; k < from_.size(); ++k) {
                    Column& to = result_.points.attributes[k];
                    copy_points(*part.chunk.attributes[k], &point, 1, to.data() + at * to.point_bytes());
                }
            }
            return true;
        });
    }

    const VoxelPlan& plan_;
    const VoxelRules& rules_;
    VoxelPoints& result_;
    ResultEnd end_;
    const Schema& from_;
};

}  // namespace

std::size_t bytes_of_held_point(const Schema& schema)
{
    constexpr std::size_t position = 24, keys = 2 * 8, order = 8, result = 24;
    return position + keys + order + result + 2 * schema.point_bytes();
}

void combine_points(const VoxelRules& rules, HeldPoints& points, VoxelPoints& result)
{
    ResultEnd(rules, result).combine(points);
}

VoxelPoints combine_unit(const VoxelPlan& plan, const VoxelUnit& unit)
{
    VoxelPoints result;
    UnitCombiner(plan, result).combine(unit);
    return result;
}

}  // namespace pcm
