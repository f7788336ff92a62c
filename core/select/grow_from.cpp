#include "pcm/select/grow_from.h"

#include "pcm/cloud/region.h"
#include "pcm/cloud/vector.h"
#include "pcm/select/point_scan.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "pcm/tree/source_rounding.h"
#include "pcm/view/point_colours.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

namespace pcm {
namespace {

constexpr double nearly_all = 0.95;               // share of a cloud
constexpr double most_colour_difference = 441.7;  // beyond sqrt(3) * 255

// The place of an attribute with three components, for a limit that needs it.
std::size_t place_of(const Tree& tree, std::string_view name, const char* what, const char* remedy)
{
    const Schema& schema = tree.info().schema;
    const auto place = schema.find(name);
    if (!place || schema[*place].components != 3)
        throw Error(ErrorCode::invalid_argument, tree.folder(), std::string("the cloud has no ") + what, remedy);
    return *place;
}

void check_range(const Tree& tree, const std::optional<double>& limit, double most, const char* what)
{
    if (!limit || (*limit >= 0 && *limit <= most)) return;
    throw Error(ErrorCode::invalid_argument, tree.folder(),
                std::string(what) + " is " + exact(*limit) + "; it is 0 to " + brief(most));
}

// A point's own values against the seed's. Any number of threads.
class LikeSeed final : public PlaceTest {
public:
    LikeSeed(const Tree& tree, NodeId node, std::uint32_t number, const SeedLimits& limits, const PlaceTest* other)
        : limits_(limits), other_(other)
    {
        check_range(tree, limits.normal_angle, pi / 2, "the largest angle between normals, in radians,");
        check_range(tree, limits.colour_difference, most_colour_difference, "the largest difference of colours");
        check_range(tree, limits.within, std::numeric_limits<double>::max(), "the largest distance from the seed");
        if (limits.normal_angle)
            normals_ = place_of(tree, attribute_name::normal, "normals", "compute them first, or leave the angle out");
        if (limits.colour_difference)
            colours_ = place_of(tree, attribute_name::rgb, "colours", "leave the difference of colours out");
        ColumnSet columns = own_columns();
        columns.positions = true;
        const Chunk chunk = tree.read_chunk(node, columns);
        if (number >= chunk.points)
            throw Error(ErrorCode::invalid_argument, tree.folder(),
                        "node " + std::to_string(node) + " has no point " + std::to_string(number));
        const SourceRounding rounding(tree.info());
        if (limits.within)
            sphere_ =
                Region::sphere(rounding(tree.info().grid.to_source(chunk.positions->grid(number))), *limits.within);
        if (colours_) take_colour_scale(tree, chunk);
        if (normals_) {
            normal_scale_ = tree.info().schema[*normals_].scale;
            normal_offset_ = tree.info().schema[*normals_].offset;
            normal_ = normal_of(*chunk.attributes[*normals_], number);
            if (!has_direction(normal_))
                throw Error(ErrorCode::invalid_argument, tree.folder(), "the point that is grown from has no normal",
                            "grow from another one, or leave the angle out");
        }
        if (colours_) colour_ = colour_of(*chunk.attributes[*colours_], number);
    }

    BoxRelation relation(const Box3d& box) const override
    {
        BoxRelation found = sphere_ ? sphere_->relation(box) : BoxRelation::inside;
        if (other_) found = both(found, other_->relation(box));
        // Its points are to be looked at: see PlaceTest.
        return found == BoxRelation::inside && limits_.reads_attributes() ? BoxRelation::crosses : found;
    }
    bool holds(const Vec3d& p) const override
    {
        return (!sphere_ || sphere_->contains(p)) && (!other_ || other_->holds(p));
    }
    ColumnSet columns() const override
    {
        ColumnSet columns = own_columns();
        if (other_) columns |= other_->columns();
        return columns;
    }
    void narrow(const Chunk& chunk, const std::vector<Vec3d>& positions,
                std::vector<std::uint32_t>& some) const override
    {
        std::vector<std::uint32_t> kept;
        std::vector<Vec3d> places;
        for (std::size_t k = 0; k < some.size(); ++k) {
            if (sphere_ && !sphere_->contains(positions[k])) continue;
            if (normals_ && !is_turned_alike(normal_of(*chunk.attributes[*normals_], some[k]))) continue;
            if (colours_ &&
                !(length(colour_of(*chunk.attributes[*colours_], some[k]) - colour_) <= *limits_.colour_difference))
                continue;
            kept.push_back(some[k]);
            if (other_) places.push_back(positions[k]);
        }
        if (other_) other_->narrow(chunk, places, kept);
        some = std::move(kept);
    }

private:
    ColumnSet own_columns() const
    {
        ColumnSet columns;
        if (normals_) columns.attributes.set(*normals_);
        if (colours_) columns.attributes.set(*colours_);
        return columns;
    }

    // 16-bit colours may hold no more than 255: the roots, samples of the whole, show it, or the seed's own chunk.
    void take_colour_scale(const Tree& tree, const Chunk& chunk)
    {
        const auto range = [&](const Chunk& sample) {
            const ColourScale scale = ColourScale::of(*sample.attributes[*colours_], ColourSource::rgb);
            return scale.high - scale.low;
        };
        double widest = range(chunk);
        ColumnSet columns;
        columns.positions = false;
        columns.attributes.set(*colours_);
        for (const NodeId root : tree.part_roots()) {
            const bool has_points = root != no_node && tree.node(root).points > 0;
            if (has_points) widest = std::max(widest, range(tree.read_chunk(root, columns)));
        }
        colour_step_ = 255 / widest;
    }

    static Vec3d raw(const Column& column, std::uint32_t i)
    {
        return {column.value(i, 0), column.value(i, 1), column.value(i, 2)};
    }
    Vec3d normal_of(const Column& column, std::uint32_t i) const
    {
        return normal_scale_ * raw(column, i) + Vec3d{normal_offset_, normal_offset_, normal_offset_};
    }
    // Differences alone are used: where the scale begins does not matter.
    Vec3d colour_of(const Column& column, std::uint32_t i) const { return colour_step_ * raw(column, i); }

    static bool has_direction(const Vec3d& n)
    {
        const double size = length(n);
        return size > 0 && std::isfinite(size);
    }
    // By the tangent's two parts: 0 exactly for the seed itself, which a cosine is not.
    bool is_turned_alike(const Vec3d& n) const
    {
        return has_direction(n) &&
               std::atan2(length(cross(n, normal_)), std::fabs(dot(n, normal_))) <= *limits_.normal_angle;
    }

    const SeedLimits limits_;
    const PlaceTest* const other_;
    std::optional<std::size_t> normals_, colours_;  // places in the schema
    std::optional<Region> sphere_;
    Vec3d normal_{}, colour_{};
    double normal_scale_ = 1, normal_offset_ = 0;
    double colour_step_ = 1;  // from a raw value to 0..255
};

}  // namespace

PointSet grow_from(const std::shared_ptr<const Tree>& tree, NodeId node, std::uint32_t number, double distance,
                   const SeedLimits& limits, const GrowOptions& options)
{
    if (node >= tree->nodes().size())
        throw Error(ErrorCode::invalid_argument, tree->folder(), "there is no node " + std::to_string(node));
    const LikeSeed test(*tree, node, number, limits, options.test);
    PointSet seeds(tree);
    seeds.set(node, {number});
    GrowOptions limited = options;
    limited.test = &test;
    return grow(seeds, distance, limited);
}

std::string note_on_growth(const PointSet& grown)
{
    const std::uint64_t all = grown.tree().info().points, reached = grown.size();
    if (all == 0 || static_cast<double>(reached) < nearly_all * static_cast<double>(all)) return {};
    return "growing has reached " + std::string(reached == all ? "all " : grouped(reached) + " of ") + grouped(all) +
           " points of the cloud: take a shorter step, or limit the angle to the seed's normal, the difference from "
           "its colour or the distance from it";
}

}  // namespace pcm
