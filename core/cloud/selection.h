// What is wanted of a cloud: the points in a box or a region, the points whose attributes meet conditions, some of the
// attributes.
#pragma once

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
    std::optional<Box3d> box;       // source coordinates, both ends included; all points when absent, none when empty
    std::optional<Region> region;   // beside the box: both must hold
    std::vector<Condition> where;   // all must be met
    std::vector<std::string> keep;  // attributes; all when empty
    std::vector<std::string> drop;

    bool chooses_points() const { return box || region || !where.empty(); }
    bool chooses_attributes() const { return !keep.empty() || !drop.empty(); }
};

// A selection, made ready for clouds of one schema. Immutable; any number of threads.
class Selector {
public:
    // Throws Error(invalid_argument) for a name that the schema lacks, naming those it has, and for an attribute of
    // several components without one of them.
    Selector(const Selection& selection, const Schema& schema);

    // Attributes that the selection leaves, in the schema's order: as numbers in the schema, and as a schema.
    const std::vector<std::size_t>& kept() const { return kept_; }
    const Schema& kept_schema() const { return kept_schema_; }
    // Attributes, by number in the schema, that conditions look at.
    const std::vector<std::size_t>& tested() const { return tested_; }
    bool tests_points() const { return looks_at_positions() || tests_attributes(); }
    bool tests_attributes() const { return !tests_.empty(); }
    // No point outside of this box is selected; absent when points anywhere may be.
    const std::optional<Box3d>& bounds() const { return bounds_; }
    // Whether points in a box can have a position that is selected, or all have one. Conservative: see
    // Region::relation().
    BoxRelation relation(const Box3d& box) const;

    // Whether bounds() is all that is asked of positions.
    bool is_box() const { return !region_ && coordinate_tests_.empty(); }
    // Box, region and conditions on coordinates of a position.
    bool holds_at(const Vec3d& p) const
    {
        bool holds = (!box_ || box_->contains(p)) && (!region_ || region_->contains(p));
        for (const CoordinateTest& test : coordinate_tests_) holds = holds && test.holds(p[test.axis()]);
        return holds;
    }

    // Keeps in `selected`, ascending numbers of points, those that meet box, region and conditions. `columns[k]` is
    // attribute k of the schema (only tested ones are looked at), `position(i)` the source coordinates of point i.
    // Where relation() of a box around the points is `inside`, their positions need no look.
    template <class Position>
    void narrow(const std::vector<const Column*>& columns, const Position& position,
                std::vector<std::uint32_t>& selected, BoxRelation relation = BoxRelation::crosses) const;

    // Leaves the selected points of a batch with all attributes of the schema; its attributes stay. `grid` is the
    // batch's, for gridded ones.
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
    bool looks_at_positions() const { return box_ || region_ || !coordinate_tests_.empty(); }

    std::optional<Box3d> box_, bounds_;
    std::optional<Region> region_;
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

// Keeps the points of `kept` (ascending) in a column or a batch, in place.
void keep_points(Column& column, const std::vector<std::uint32_t>& kept);
void keep_points(PointBatch& batch, const std::vector<std::uint32_t>& kept);

}  // namespace pcm
