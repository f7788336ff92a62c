// Part of a cloud: the points in a box or a region, the points that meet conditions, some of the attributes.
#pragma once

#include "pcm/cloud/clip.h"
#include "pcm/cloud/condition.h"
#include "pcm/cloud/geometry.h"
#include "pcm/cloud/point_batch.h"
#include "pcm/cloud/region.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct Selection {
    std::optional<Box3d> box;       // source coordinates, faces included; all points when absent, none when empty
    std::optional<Region> region;   // with a box: the intersection
    std::vector<Clip> clips;        // all must hold
    std::vector<Condition> where;   // all must be met
    std::vector<std::string> keep;  // attributes; all when empty
    std::vector<std::string> drop;

    bool chooses_points() const { return box || region || !clips.empty() || !where.empty(); }
    bool chooses_attributes() const { return !keep.empty() || !drop.empty(); }
};

// Throws Error(invalid_argument) for a box, alone or as the region, that no point can be in: corners in the wrong order
// or not numbers. For selections that users wrote; a Selector takes such a box as one without points.
void refuse_impossible_box(const Selection& selection);

// For users, after a selection without points: where the cloud's points are.
std::string extent_text(const Box3d& cloud);

// A selection prepared for clouds of one schema. Immutable; any number of threads.
class Selector {
public:
    // Throws Error(invalid_argument) for a name that the schema lacks, listing the names it has, and for a condition on
    // an attribute of several components that does not name one component.
    Selector(const Selection& selection, const Schema& schema);

    // The selected attributes in the schema's order: as indices in the schema, and as a schema.
    const std::vector<std::size_t>& kept() const { return kept_; }
    const Schema& kept_schema() const { return kept_schema_; }
    // Indices in the schema of the attributes that conditions test, ascending.
    const std::vector<std::size_t>& tested() const { return tested_; }
    bool tests_points() const { return looks_at_positions() || tests_attributes(); }
    bool tests_attributes() const { return !tests_.empty(); }
    // No point outside of this box is selected; absent when the selection does not bound positions.
    const std::optional<Box3d>& bounds() const { return bounds_; }
    // Whether no position, some positions or all positions in a box are selected. Conservative like
    // Region::relation().
    BoxRelation relation(const Box3d& box) const;

    // Whether a position is selected exactly when it is in bounds().
    bool is_box() const { return !region_ && clips_.empty() && coordinate_tests_.empty(); }
    // Whether a position meets the box, the region, the clips and the conditions on coordinates.
    bool holds_at(const Vec3d& p) const
    {
        bool holds = (!box_ || box_->contains(p)) && (!region_ || region_->contains(p));
        for (const Clip& clip : clips_) holds = holds && clip.holds(p);
        for (const CoordinateTest& test : coordinate_tests_) holds = holds && test.holds(p[test.axis()]);
        return holds;
    }

    // Keeps in `selected`, ascending indices of points, those that meet box, region and conditions. `columns[k]` is
    // attribute k of the schema (only tested ones are accessed), `position(i)` the source coordinates of point i. Pass
    // the relation() of a box around the points: where it is `inside`, positions are not tested.
    template <class Position>
    void narrow(const std::vector<const Column*>& columns, const Position& position,
                std::vector<std::uint32_t>& selected, BoxRelation relation = BoxRelation::crosses) const;

    // Removes the points of a batch that are not selected; the batch has all attributes of the schema, and keeps them.
    // `grid` is the grid of a gridded batch, else unused.
    void apply(PointBatch& batch, const Grid* grid) const;

private:
    struct Test {
        std::size_t attribute;
        std::unique_ptr<AttributeTest> test;
    };
    void bound(std::size_t axis, double low, double high);
    void add(const Condition& condition, const Schema& schema);
    void choose_attributes(const Selection& selection, const Schema& schema);
    void narrow_by_attributes(const std::vector<const Column*>& columns, std::vector<std::uint32_t>& selected) const;
    bool looks_at_positions() const { return box_ || region_ || !clips_.empty() || !coordinate_tests_.empty(); }

    std::optional<Box3d> box_, bounds_;
    std::optional<Region> region_;
    std::vector<Clip> clips_;
    std::vector<CoordinateTest> coordinate_tests_;
    std::vector<Test> tests_;
    std::vector<std::size_t> kept_, tested_;
    Schema kept_schema_;
};

template <class Position>
void Selector::narrow(const std::vector<const Column*>& columns, const Position& position,
                      std::vector<std::uint32_t>& selected, BoxRelation relation) const
{
    if (looks_at_positions() && relation != BoxRelation::inside) {
        std::size_t kept = 0;
        for (const std::uint32_t i : selected) {
            const bool wanted = holds_at(position(i));
            selected[kept] = i;
            kept += wanted;
        }
        selected.resize(kept);
    }
    narrow_by_attributes(columns, selected);
}

}  // namespace pcm
