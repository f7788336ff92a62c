#include "pcm/cloud/selection.h"

#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <numeric>
#include <utility>

namespace pcm {
namespace {

std::string list_of(const Schema& schema)
{
    if (schema.empty()) return "this cloud has no attributes, only positions";
    std::string text = "known are ";
    for (std::size_t i = 0; i < schema.size(); ++i) text += (i ? ", " : "") + schema[i].name;
    return text;
}

[[noreturn]] void refuse_unknown(const std::string& name, const Schema& schema)
{
    throw Error(ErrorCode::invalid_argument, {}, "this cloud has no attribute '" + name + "'", list_of(schema));
}

// The index of the attribute and the component that a condition names.
std::pair<std::size_t, std::uint32_t> find_component(const Condition& condition, const Schema& schema)
{
    std::string name = condition.name;
    std::uint32_t component = 0;
    bool named_component = false;
    auto slot = schema.find(name);
    if (const auto bracket = name.rfind('['); !condition.quoted && bracket != std::string::npos && name.back() == ']') {
        const char *begin = name.data() + bracket + 1, *end = name.data() + name.size() - 1;
        const auto result = std::from_chars(begin, end, component);
        const bool is_index = result.ec == std::errc() && result.ptr == end;
        const auto whole = schema.find(name.substr(0, bracket));
        // In 'rgb'[0] the quotes say that the index is not part of the name.
        const bool is_apart =
            is_index && condition.text.find_first_of("'\"") == condition.text.find_first_not_of(" \t");
        if (is_apart) slot.reset();
        if (slot && is_index && whole && component < schema[*whole].components)
            throw Error(ErrorCode::invalid_argument, {},
                        "condition '" + condition.text + "': '" + name +
                            "' is an attribute of this cloud, and a component of '" + name.substr(0, bracket) + "'",
                        "write '" + name + "' in quotes for the attribute, '" + name.substr(0, bracket) + "'" +
                            name.substr(bracket) + " for the component");
        if (!slot && is_index) {
            named_component = true;
            name.resize(bracket);
            slot = schema.find(name);
        } else {
            component = 0;  // the brackets belong to the attribute's own name
        }
    }
    if (!slot) refuse_unknown(name, schema);
    const std::uint32_t components = schema[*slot].components;
    if (component >= components || (components > 1 && !named_component))
        throw Error(
            ErrorCode::invalid_argument, {},
            "condition '" + condition.text + "': '" + name + "' has " + std::to_string(components) + " components",
            "name one, " + name + "[0] to " + name + "[" + std::to_string(components - 1) + "]");
    return {*slot, component};
}

Box3d intersection(Box3d a, const Box3d& b)
{
    for (std::size_t axis = 0; axis < 3; ++axis) {
        a.min[axis] = std::max(a.min[axis], b.min[axis]);
        a.max[axis] = std::min(a.max[axis], b.max[axis]);
    }
    return a;
}

}  // namespace

void refuse_impossible_box(const Selection& selection)
{
    const auto refuse_axis = [](std::size_t axis, double low, double high) {
        if (low <= high) return;  // false for what is not a number, too
        throw Error(ErrorCode::invalid_argument, {},
                    "no point can be in the box: along " + std::string(1, "xyz"[axis]) + " it goes from " + exact(low) +
                        " to " + exact(high),
                    "give the smaller corner first, as x0 y0 z0 x1 y1 z1");
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (selection.box) refuse_axis(axis, selection.box->min[axis], selection.box->max[axis]);
        if (selection.region && selection.region->kind() == Region::Kind::box)
            refuse_axis(axis, selection.region->bounds().min[axis], selection.region->bounds().max[axis]);
    }
}

std::string extent_text(const Box3d& cloud)
{
    if (cloud.empty()) return "the cloud has no points";
    return "the cloud's points lie from " + exact(cloud.min) + " to " + exact(cloud.max);
}

Selector::Selector(const Selection& selection, const Schema& schema)
    : box_(selection.box), bounds_(selection.box), region_(selection.region), clips_(selection.clips)
{
    if (region_ && region_->kind() == Region::Kind::box) {
        box_ = bounds_ = box_ ? intersection(region_->bounds(), *box_) : region_->bounds();
        region_.reset();
    }
    const auto bound_by = [this](const Box3d& box) {
        for (std::size_t axis = 0; axis < 3; ++axis) bound(axis, box.min[axis], box.max[axis]);
    };
    if (region_) bound_by(region_->bounds());
    for (const Clip& clip : clips_)
        if (!clip.outside) bound_by(clip.region.bounds());
    for (const Condition& condition : selection.where) add(condition, schema);
    std::sort(tested_.begin(), tested_.end());
    choose_attributes(selection, schema);
}

void Selector::bound(std::size_t axis, double low, double high)
{
    if (!bounds_) {
        bounds_.emplace();
        bounds_->min.fill(-std::numeric_limits<double>::infinity());
        bounds_->max.fill(std::numeric_limits<double>::infinity());
    }
    bounds_->min[axis] = std::max(bounds_->min[axis], low);
    bounds_->max[axis] = std::min(bounds_->max[axis], high);
}

void Selector::add(const Condition& condition, const Schema& schema)
{
    const std::string& name = condition.name;
    if (!condition.quoted && name.size() == 1 && name[0] >= 'x' && name[0] <= 'z') {
        if (schema.find(name))
            throw Error(
                ErrorCode::invalid_argument, {},
                "condition '" + condition.text + "': '" + name + "' is a coordinate, and an attribute of this cloud",
                "write '" + name + "' in quotes for the attribute; a box or a clip bounds the coordinate");
        const CoordinateTest test(condition, static_cast<std::size_t>(name[0] - 'x'));
        if (const auto ends = test.bounds()) bound(test.axis(), (*ends)[0], (*ends)[1]);
        coordinate_tests_.push_back(test);
        return;
    }
    const auto [slot, component] = find_component(condition, schema);
    tests_.push_back({slot, make_attribute_test(condition, schema[slot], component)});
    if (std::find(tested_.begin(), tested_.end(), slot) == tested_.end()) tested_.push_back(slot);
}

void Selector::choose_attributes(const Selection& selection, const Schema& schema)
{
    std::vector<bool> keep(schema.size(), selection.keep.empty());
    for (const auto* names : {&selection.keep, &selection.drop})
        for (const std::string& name : *names) {
            const auto slot = schema.find(name);
            if (!slot) refuse_unknown(name, schema);
            keep[*slot] = names == &selection.keep;
        }
    for (std::size_t k = 0; k < schema.size(); ++k)
        if (keep[k]) {
            kept_.push_back(k);
            kept_schema_.add(schema[k]);
        }
}

BoxRelation Selector::relation(const Box3d& box) const
{
    if (box.empty() || (bounds_ && !bounds_->intersects(box))) return BoxRelation::outside;
    BoxRelation relation = BoxRelation::inside;
    if (box_ && !box_->contains(box)) relation = BoxRelation::crosses;
    for (const CoordinateTest& test : coordinate_tests_)
        if (!test.surely_holds(box.min[test.axis()], box.max[test.axis()])) relation = BoxRelation::crosses;
    if (region_) relation = both(relation, region_->relation(box));
    for (const Clip& clip : clips_) relation = both(relation, clip.relation(box));
    return relation;
}

void Selector::narrow_by_attributes(const std::vector<const Column*>& columns,
                                    std::vector<std::uint32_t>& selected) const
{
    for (const Test& test : tests_) test.test->narrow(*columns[test.attribute], selected);
}

void Selector::apply(PointBatch& batch, const Grid* grid) const
{
    if (!tests_points()) return;
    std::vector<std::uint32_t> selected(batch.size);
    std::iota(selected.begin(), selected.end(), 0u);
    std::vector<const Column*> columns;
    for (const Column& column : batch.attributes) columns.push_back(&column);
    if (batch.gridded)
        narrow(
            columns,
            [&](std::size_t i) {
                return grid->to_source(Vec3i{batch.grid_xyz[0][i], batch.grid_xyz[1][i], batch.grid_xyz[2][i]});
            },
            selected);
    else
        narrow(
            columns,
            [&](std::size_t i) {
                return Vec3d{batch.xyz[0][i], batch.xyz[1][i], batch.xyz[2][i]};
            },
            selected);
    if (selected.size() < batch.size) keep_points(batch, selected);
}

}  // namespace pcm
