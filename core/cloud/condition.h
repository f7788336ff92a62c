// Conditions on attributes and coordinates: as users write them, and prepared for testing points.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/cloud/point_batch.h"

#include <array>
#include <cstddef>
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
// RANGE is LOW..HIGH, both ends included; either end may be left out. NAME is an attribute, a component such as rgb[0],
// or x, y, z. A name that is a number, has one of = ! < >, or that a coordinate or a component has as well, is written
// in quotes: '1'>3 or "a=b"=2 (attribute_names.h). Values are those that users see, raw * scale + offset. For a float
// attribute, a value stands for the nearest float (0.1 matches an f32 of 0.1); for a scaled integer, it stands for the
// nearest step if it is less than a millionth of a step away. NaN meets only !=.
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
    bool quoted = false;  // the name is an attribute's: no coordinate's, and no component's
    Relation relation = Relation::equal;
    std::vector<Range> ranges;  // one single value, unless the relation is equal or not_equal
    std::string text;           // as written, for messages
};

// Throws Error(invalid_argument) with what is wrong with the text and what was expected.
Condition parse_condition(const std::string& text);

// A condition prepared for the columns of one attribute. Immutable; any number of threads.
class AttributeTest {
public:
    virtual ~AttributeTest() = default;
    // Keeps in `selected`, indices of points of the column, those that meet the condition.
    virtual void narrow(const Column& column, std::vector<std::uint32_t>& selected) const = 0;
};

// The attribute's name is not compared with the condition's. `component` is below the attribute's number of components.
std::unique_ptr<AttributeTest> make_attribute_test(const Condition& condition, const Attribute& attribute,
                                                   std::uint32_t component);

// A condition prepared for one coordinate of positions. Immutable; any number of threads.
class CoordinateTest {
public:
    CoordinateTest(const Condition& condition, std::size_t axis);

    std::size_t axis() const { return axis_; }
    bool holds(double v) const
    {
        for (const auto& range : ranges_)
            if (v >= range[0] && v <= range[1]) return inside_;
        return !inside_;
    }
    // Whether it holds for all numbers from `low` to `high`. Conservative: may be false where only several ranges
    // together cover them.
    bool surely_holds(double low, double high) const
    {
        bool holds = !inside_;
        for (const auto& range : ranges_)
            if (inside_)
                holds = holds || (low >= range[0] && high <= range[1]);
            else
                holds = holds && (high < range[0] || low > range[1]);
        return holds;
    }
    // No number outside of these holds; absent for !=.
    std::optional<std::array<double, 2>> bounds() const;

private:
    std::size_t axis_;
    std::vector<std::array<double, 2>> ranges_;  // closed
    bool inside_;                                // else outside of all of them
};

}  // namespace pcm
