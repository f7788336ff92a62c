#include "pcm/update/fitted_reader.h"

#include "pcm/cloud/point_batch.h"
#include "pcm/cloud/vector.h"
#include "pcm/io/pipe/batch_shape.h"
#include "pcm/io/pipe/far_points.h"
#include "pcm/io/pipe/grid_choice.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace pcm {
namespace {

// As text: "u16", "3 x u16", "i32 times 0.01 plus 5".
std::string kind_of(const Attribute& attribute)
{
    std::string text = attribute.components == 1 ? "" : std::to_string(attribute.components) + " x ";
    text += name_of(attribute.type);
    if (attribute.scale != 1) text += " times " + exact(attribute.scale);
    if (attribute.offset != 0) text += " plus " + exact(attribute.offset);
    return text;
}

bool same_encoding(const Attribute& a, const Attribute& b)
{
    return a.type == b.type && a.components == b.components && a.scale == b.scale && a.offset == b.offset;
}

}  // namespace

FittedReader::FittedReader(PointReader& cloud, const TreeInfo& tree, const std::filesystem::path& folder)
    : cloud_(cloud),
      tree_(tree),
      folder_(folder),
      same_grid_(!tree.wide && cloud.info().grid && *cloud.info().grid == tree.grid),
      rounding_(tree)
{
    const FileInfo& from = cloud.info();
    if (from.grid) source_offset_ = from.grid->offset;
    for (const Attribute& attribute : from.schema) {
        const auto slot = tree.schema.find(attribute.name);
        const char* const hint =
            "build a new tree of all the files, or leave the attribute out with 'pcmlab convert --drop' first";
        if (!slot)
            throw Error(ErrorCode::invalid_argument, folder,
                        "the new points have the attribute '" + attribute.name + "', which the tree lacks", hint);
        if (!same_encoding(attribute, tree.schema[*slot]))
            throw Error(ErrorCode::invalid_argument, folder,
                        "the attribute '" + attribute.name + "' of the new points is " + kind_of(attribute) +
                            ", the tree's is " + kind_of(tree.schema[*slot]),
                        hint);
        slots_.push_back(*slot);
    }
    same_schema_ = slots_.size() == tree.schema.size() && std::is_sorted(slots_.begin(), slots_.end());
    std::string missing;
    for (const Attribute& attribute : tree.schema)
        if (!from.schema.find(attribute.name)) missing += (missing.empty() ? "" : ", ") + attribute.name;
    if (!missing.empty()) info_.notes.push_back("the new points lack " + missing + ", which the tree has: 0 was set");

    info_.format = from.format;
    info_.schema = tree.schema;
    info_.points = from.points;
    info_.points_known = same_grid_ && from.points_known;
    info_.promised_box = from.promised_box;
    if (tree.wide) {
        info_.position_type = ScalarType::f64;
    } else {
        info_.position_type = ScalarType::i32;
        info_.grid = tree.grid;
    }
}

bool FittedReader::read(PointBatch& batch, std::size_t max_points)
{
    do {
        if (!cloud_.read(batch_, max_points)) {
            refuse_coarse_grid();
            shape_batch(batch, info_.schema, info_.grid.has_value(), 0);
            return false;
        }
        points_ += batch_.size;
        if (!same_grid_) fit_positions(batch_);
        if (misplaced_) refuse();
    } while (batch_.size == 0);
    if (!same_schema_) fit_attributes(batch_);
    std::swap(batch, batch_);
    return true;
}

// The tree's attributes in the tree's order.
void FittedReader::fit_attributes(PointBatch& batch)
{
    std::vector<Column> columns;
    for (const Attribute& attribute : tree_.schema) columns.emplace_back(attribute);
    for (std::size_t k = 0; k < slots_.size(); ++k) columns[slots_[k]] = std::move(batch.attributes[k]);
    for (Column& column : columns) column.resize(batch.size);  // zeros, where the cloud has no such attribute
    batch.attributes = std::move(columns);
}

void FittedReader::fit_positions(PointBatch& batch)
{
    if (batch.gridded) {
        for (std::size_t a = 0; a < 3; ++a) {
            batch.xyz[a].resize(batch.size);
            for (std::size_t i = 0; i < batch.size; ++i)
                batch.xyz[a][i] = cloud_.info().grid->to_source(batch.grid_xyz[a][i], a);
            batch.grid_xyz[a].clear();
        }
        batch.gridded = false;
    }
    std::vector<std::uint32_t> finite;
    std::array<std::vector<std::int32_t>, 3> narrow;
    for (std::size_t i = 0; i < batch.size; ++i) {
        const Vec3d p{batch.xyz[0][i], batch.xyz[1][i], batch.xyz[2][i]};
        if (!is_finite(p)) {
            ++skipped_;
            continue;
        }
        box_.extend(p);
        std::array<std::optional<std::int64_t>, 3> q;
        for (std::size_t a = 0; a < 3; ++a) q[a] = place(p[a], a);
        if (!q[0] || !q[1] || !q[2]) {
            ++misplaced_;
            continue;
        }
        finite.push_back(static_cast<std::uint32_t>(i));
        if (!tree_.wide)
            for (std::size_t a = 0; a < 3; ++a) narrow[a].push_back(static_cast<std::int32_t>(*q[a]));
    }
    if (misplaced_ || tree_.wide) return;  // the build drops doubles that are not finite
    if (finite.size() < batch.size) keep_points(batch, finite);
    for (std::size_t a = 0; a < 3; ++a) batch.xyz[a].clear();
    batch.gridded = true;
    batch.grid_xyz = std::move(narrow);
}

// The place of a coordinate, if there is one.
std::optional<std::int64_t> FittedReader::place(double value, std::size_t axis)
{
    constexpr std::int64_t wide_end = std::int64_t{1} << 62;  // where nearest_on_grid() saturates
    const std::int64_t q = nearest_on_grid(tree_.grid, axis, value);
    const bool outside =
        tree_.wide ? q <= -wide_end || q >= wide_end
                   : q < std::numeric_limits<std::int32_t>::min() || q > std::numeric_limits<std::int32_t>::max();
    if (outside) {
        too_far_ = true;
        return std::nullopt;
    }
    const double deviation = std::fabs(tree_.grid.to_source(q, axis) - value);
    const double scale = tree_.grid.scale[axis];
    // On both grids the step, the offset, the product and the sum are each rounded by half a unit in the last place at
    // most. A product is no larger than the value and the offset together.
    const double offsets = std::fabs(tree_.grid.offset[axis]) + std::fabs(source_offset_[axis]);
    const double rounding = std::numeric_limits<double>::epsilon() * (3 * std::fabs(value) + 1.5 * offsets);
    const double allowed = tree_.position_type == ScalarType::i32 ? std::min(rounding, scale / 4) : scale / 2;
    if (deviation > allowed) {
        largest_deviation_ = std::max(largest_deviation_, deviation);
        return std::nullopt;
    }
    const bool decimal = rounding_.has_decimals() && rounding_(tree_.grid.to_source(q, axis), axis) == value;
    if (!decimal) {
        keeps_decimals_ = false;
        position_error_ = std::max(position_error_, deviation);
    }
    return q;
}

// Without this, new points of a few units would fall onto few places of a tree whose coordinates are many powers of ten
// larger.
void FittedReader::refuse_coarse_grid() const
{
    const double spacing = FarPoints::mean_spacing(box_, points_ - skipped_);
    if (tree_.position_type == ScalarType::i32 || !(spacing > 0) || !(2 * position_error_ > spacing / 4)) return;
    throw Error(ErrorCode::invalid_argument, folder_,
                "the new points are about " + brief(spacing) + " apart; on the tree's grid, whose steps are " +
                    exact(tree_.grid.scale) + ", they would be moved by up to " + brief(position_error_),
                "build a tree of their own");
}

void FittedReader::refuse()
{
    while (cloud_.read(batch_, default_batch_points)) {
        points_ += batch_.size;
        fit_positions(batch_);
    }
    std::string text = grouped(misplaced_) + " of the " + grouped(points_) +
                       " new points have no place on the tree's grid, whose steps are " + exact(tree_.grid.scale);
    if (largest_deviation_ > 0) text += "; the nearest places are up to " + brief(largest_deviation_) + " away";
    if (too_far_) text += "; some points are beyond its range";
    throw Error(
        ErrorCode::invalid_argument, folder_, text,
        tree_.position_type == ScalarType::i32 && !too_far_
            ? "build a new tree of all the files, or round the new ones to the grid first: pcmlab convert NEW "
              "ROUNDED.las --scale " +
                  exact(tree_.grid.scale) + " --offset " + exact(tree_.grid.offset)
        : too_far_
            ? std::string("build a new tree of all the files; if the points are no-data values, leave them out with "
                          "--largest-coordinate, in MeshLab the parameter 'Largest coordinate'")
            : std::string("build a new tree of all the files"));
}

}  // namespace pcm
