// What is wanted of a cloud: the points in a box or a region, the points whose attributes meet conditions, some of the
// attributes.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/cloud/point_batch.h"
#include "pcm/cloud/region.h"
#include "pcm/io/reader.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// A condition on an attribute, as users write it:
//
//     NAME RELATION VALUE                relation: = == != < <= > >=
//     NAME = VALUE or RANGE, ...         one of them; with != none of them
//
// RANGE is LOW..HIGH, both ends included; an end may be left out. NAME is an attribute, one of its components as in
// rgb[0], or x, y, z. Values are those that users see, raw * scale + offset. A value stands for the nearest float where
// the attribute is one (0.1 is found among f32), and for a scaled integer that it misses by less than a millionth of a
// step. NaN meets != alone.
struct Condition {
    enum class Relation { equal, not_equal, less, less_equal, greater, greater_equal };
    struct Number {
        double value = 0;
        std::optional<std::int64_t> i64;  // set when the number was written as an integer that fits
        std::optional<std::uint64_t> u64;
    };
    struct Range {
        std::optional<Number> low, high;
    };
    std::string name;
    Relation relation = Relation::equal;
    std::vector<Range> ranges;  // one single value, unless the relation is equal or not_equal
    std::string text;           // as written, for messages
};

// Throws Error(invalid_argument), saying what is wrong with the text and what was expected.
Condition parse_condition(const std::string& text);

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
    ~Selector();
    Selector(Selector&&) noexcept;
    Selector& operator=(Selector&&) noexcept;

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
        for (const CoordinateTest& test : coordinate_tests_) holds = holds && test.holds(p[test.axis]);
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

    class Test;  // of one attribute

private:
    struct CoordinateTest {
        std::size_t axis;
        std::vector<std::array<double, 2>> ranges;  // closed
        bool inside;                                // else outside of all of them
        bool holds(double v) const
        {
            for (const auto& range : ranges)
                if (v >= range[0] && v <= range[1]) return inside;
            return !inside;
        }
        // Of all numbers from `low` to `high`.
        bool surely_holds(double low, double high) const
        {
            bool holds = !inside;
            for (const auto& range : ranges)
                if (inside)
                    holds = holds || (low >= range[0] && high <= range[1]);
                else
                    holds = holds && (high < range[0] || low > range[1]);
            return holds;
        }
    };
    void narrow_by_attributes(const std::vector<const Column*>& columns, std::vector<std::uint32_t>& selected) const;
    bool looks_at_positions() const { return box_ || region_ || !coordinate_tests_.empty(); }

    std::optional<Box3d> box_, bounds_;
    std::optional<Region> region_;
    std::vector<CoordinateTest> coordinate_tests_;
    std::vector<std::unique_ptr<Test>> tests_;
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

// The selection of another reader's cloud. One thread.
class SelectedReader final : public PointReader {
public:
    // Throws what Selector throws.
    SelectedReader(std::unique_ptr<PointReader> cloud, const Selection& selection);

    // The number of points is known when none is left out.
    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    bool seekable() const override { return !selector_.tests_points() && cloud_->seekable(); }
    void seek(std::uint64_t index) override;
    double fraction_read() const override { return cloud_->fraction_read(); }

    std::uint64_t points_seen() const { return seen_; }  // of the other cloud, so far

private:
    std::unique_ptr<PointReader> cloud_;
    Selector selector_;
    FileInfo info_;
    PointBatch whole_;
    std::uint64_t seen_ = 0;
};

}  // namespace pcm
