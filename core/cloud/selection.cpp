#include "pcm/cloud/selection.h"

#include "pcm/system/error.h"
#include "pcm/cloud/with_type.h"
#include "pcm/io/pipe/batch_shape.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <string_view>
#include <type_traits>
#include <utility>

namespace pcm {
namespace {

[[noreturn]] void refuse(const std::string& condition, const std::string& what)
{
    throw Error(ErrorCode::invalid_argument, {}, "condition '" + condition + "': " + what,
                "write for example classification=2,6 or \"intensity>=100\" or gps_time=100..200");
}

std::string_view trim(std::string_view text)
{
    const auto blank = [](char c) { return c == ' ' || c == '\t'; };
    while (!text.empty() && blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && blank(text.back())) text.remove_suffix(1);
    return text;
}

Condition::Number parse_value(std::string_view text, const std::string& condition)
{
    const std::string quoted = "'" + std::string(text) + "'";
    if (text.empty()) refuse(condition, "a number is missing");
    if (text[0] == '+') text.remove_prefix(1);
    Condition::Number number;
    const char *begin = text.data(), *end = begin + text.size();
    const auto result = std::from_chars(begin, end, number.value);
    if (result.ec == std::errc::result_out_of_range) refuse(condition, quoted + " is too large or too small a number");
    if (result.ec != std::errc() || result.ptr != end) refuse(condition, quoted + " is not a number");
    if (!std::isfinite(number.value)) refuse(condition, quoted + " is not a finite number");
    std::int64_t i = 0;
    std::uint64_t u = 0;
    if (const auto r = std::from_chars(begin, end, i); r.ec == std::errc() && r.ptr == end) number.i64 = i;
    if (const auto r = std::from_chars(begin, end, u); r.ec == std::errc() && r.ptr == end) number.u64 = u;
    return number;
}

using Wide = long double;  // 64 bits of mantissa: every i64 and u64 is exact
static_assert(std::numeric_limits<Wide>::digits >= 64);

// Where a user's value lies among an integer attribute's raw values.
Wide raw_of(const Condition::Number& number, const Attribute& attribute)
{
    if (attribute.scale == 1 && attribute.offset == 0) {
        if (number.i64) return static_cast<Wide>(*number.i64);
        if (number.u64) return static_cast<Wide>(*number.u64);
        return number.value;
    }
    const Wide raw = (static_cast<Wide>(number.value) - attribute.offset) / attribute.scale;
    const Wide nearest = std::round(raw);
    return std::fabs(raw - nearest) <= 1e-6L ? nearest : raw;
}

template <class T>
using Interval = std::array<T, 2>;  // closed

template <class T>
Interval<T> nothing()
{
    return {std::numeric_limits<T>::max(), std::numeric_limits<T>::lowest()};
}

// The raw values of type T from `low` to `high`, as users see them; the ends belong to it unless `open`.
template <class T>
Interval<T> interval(std::optional<Condition::Number> low, std::optional<Condition::Number> high, bool open,
                     const Attribute& attribute)
{
    if (attribute.scale < 0) std::swap(low, high);
    if constexpr (std::is_integral_v<T>) {
        Wide from = std::numeric_limits<T>::min(), to = std::numeric_limits<T>::max();
        if (low) {
            const Wide raw = raw_of(*low, attribute);
            from = std::max(from, open ? std::floor(raw) + 1 : std::ceil(raw));
        }
        if (high) {
            const Wide raw = raw_of(*high, attribute);
            to = std::min(to, open ? std::ceil(raw) - 1 : std::floor(raw));
        }
        if (from > to) return nothing<T>();
        return {static_cast<T>(from), static_cast<T>(to)};
    } else {
        constexpr T infinity = std::numeric_limits<T>::infinity();
        const auto nearest = [&](const Condition::Number& number) {
            const double raw = attribute.scale == 1 && attribute.offset == 0
                                   ? number.value
                                   : (number.value - attribute.offset) / attribute.scale;
            constexpr double largest = std::numeric_limits<T>::max();
            return static_cast<T>(std::clamp(raw, -largest, largest));
        };
        Interval<T> result{-infinity, infinity};
        if (low) result[0] = open ? std::nextafter(nearest(*low), infinity) : nearest(*low);
        if (high) result[1] = open ? std::nextafter(nearest(*high), -infinity) : nearest(*high);
        return result;
    }
}

template <class T>
std::vector<Interval<T>> intervals(const Condition& condition, const Attribute& attribute)
{
    std::vector<Interval<T>> result;
    for (const Condition::Range& range : condition.ranges) {
        using R = Condition::Relation;
        switch (condition.relation) {
            case R::equal:
            case R::not_equal:
                result.push_back(interval<T>(range.low, range.high, false, attribute));
                break;
            case R::less:
                result.push_back(interval<T>({}, range.high, true, attribute));
                break;
            case R::less_equal:
                result.push_back(interval<T>({}, range.high, false, attribute));
                break;
            case R::greater:
                result.push_back(interval<T>(range.low, {}, true, attribute));
                break;
            case R::greater_equal:
                result.push_back(interval<T>(range.low, {}, false, attribute));
                break;
        }
    }
    return result;
}

std::string list_of(const Schema& schema)
{
    if (schema.empty()) return "this cloud has no attributes, only positions";
    std::string text = "known are ";
    for (std::size_t i = 0; i < schema.size(); ++i) text += (i ? ", " : "") + schema[i].name;
    return text;
}

// An attribute's number and the component that a condition names.
std::pair<std::size_t, std::uint32_t> find_component(const Condition& condition, const Schema& schema)
{
    std::string name = condition.name;
    std::uint32_t component = 0;
    bool named_component = false;
    auto slot = schema.find(name);
    if (const auto bracket = name.rfind('['); !slot && bracket != std::string::npos && name.back() == ']') {
        const char *begin = name.data() + bracket + 1, *end = name.data() + name.size() - 1;
        const auto result = std::from_chars(begin, end, component);
        if (result.ec == std::errc() && result.ptr == end) {
            named_component = true;
            name.resize(bracket);
            slot = schema.find(name);
        }
    }
    if (!slot)
        throw Error(ErrorCode::invalid_argument, {}, "this cloud has no attribute '" + name + "'", list_of(schema));
    const std::uint32_t components = schema[*slot].components;
    if (component >= components || (components > 1 && !named_component))
        refuse(condition.text, "'" + name + "' has " + std::to_string(components) + " components; name one, " + name +
                                   "[0] to " + name + "[" + std::to_string(components - 1) + "]");
    return {*slot, component};
}

template <std::size_t Size>
void keep_of_size(std::byte* data, const std::vector<std::uint32_t>& kept)
{
    for (std::size_t i = 0; i < kept.size(); ++i)
        if (kept[i] != i) std::memcpy(data + i * Size, data + kept[i] * Size, Size);
}

template <class T>
void keep_in(std::vector<T>& values, const std::vector<std::uint32_t>& kept)
{
    for (std::size_t i = 0; i < kept.size(); ++i) values[i] = values[kept[i]];
}

}  // namespace

Condition parse_condition(const std::string& text)
{
    using R = Condition::Relation;
    static constexpr std::pair<std::string_view, R> relations[] = {
        {"==", R::equal}, {"!=", R::not_equal}, {"<=", R::less_equal}, {">=", R::greater_equal},
        {"=", R::equal},  {"<", R::less},       {">", R::greater}};
    Condition condition;
    condition.text = text;
    const std::string_view all = text;
    const auto at = all.find_first_of("=!<>");
    if (at == std::string_view::npos) refuse(text, "it has no =, !=, <, <=, > or >=");
    condition.name = trim(all.substr(0, at));
    if (condition.name.empty()) refuse(text, "no attribute stands before the sign");
    std::string_view rest = all.substr(at);
    bool found = false;
    for (const auto& [sign, relation] : relations)
        if (!found && rest.substr(0, sign.size()) == sign) {
            found = true;
            condition.relation = relation;
            rest.remove_prefix(sign.size());
        }
    if (!found) refuse(text, "'!' must be followed by '='");

    const bool lists = condition.relation == R::equal || condition.relation == R::not_equal;
    while (true) {
        const auto comma = rest.find(',');
        const std::string_view item = trim(rest.substr(0, comma));
        const auto dots = item.find("..");
        if (!lists && (dots != std::string_view::npos || comma != std::string_view::npos))
            refuse(text, "one number was expected; lists and ranges go with = and !=");
        Condition::Range range;
        if (dots == std::string_view::npos) {
            range.low = range.high = parse_value(item, text);
        } else {
            const std::string_view low = trim(item.substr(0, dots)), high = trim(item.substr(dots + 2));
            if (low.empty() && high.empty()) refuse(text, "a range needs at least one end");
            if (!low.empty()) range.low = parse_value(low, text);
            if (!high.empty()) range.high = parse_value(high, text);
            if (range.low && range.high && range.low->value > range.high->value)
                refuse(text, "the range '" + std::string(item) + "' ends before it begins");
        }
        condition.ranges.push_back(range);
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
    }
    return condition;
}

class Selector::Test {
public:
    explicit Test(std::size_t attribute) : attribute_(attribute) {}
    virtual ~Test() = default;
    virtual void narrow(const Column& column, std::vector<std::uint32_t>& selected) const = 0;
    std::size_t attribute() const { return attribute_; }

private:
    std::size_t attribute_;
};

namespace {

template <class T>
class TypedTest final : public Selector::Test {
public:
    TypedTest(std::size_t slot, std::uint32_t component, const Condition& condition, const Attribute& attribute)
        : Test(slot),
          component_(component),
          ranges_(intervals<T>(condition, attribute)),
          inside_(condition.relation != Condition::Relation::not_equal)
    {
    }
    void narrow(const Column& column, std::vector<std::uint32_t>& selected) const override
    {
        const T* values = column.as<T>() + component_;
        const std::size_t stride = column.components();
        std::size_t kept = 0;
        for (const std::uint32_t i : selected) {
            const T v = values[i * stride];
            bool inside = false;
            for (const Interval<T>& range : ranges_) inside = inside || (v >= range[0] && v <= range[1]);
            selected[kept] = i;
            kept += inside == inside_;
        }
        selected.resize(kept);
    }

private:
    std::uint32_t component_;
    std::vector<Interval<T>> ranges_;
    bool inside_;
};

std::unique_ptr<Selector::Test> make_test(std::size_t slot, std::uint32_t component, const Condition& condition,
                                          const Attribute& attribute)
{
    return with_type(attribute.type, [&](auto zero) -> std::unique_ptr<Selector::Test> {
        return std::make_unique<TypedTest<decltype(zero)>>(slot, component, condition, attribute);
    });
}

}  // namespace

Selector::Selector(const Selection& selection, const Schema& schema)
    : box_(selection.box), bounds_(selection.box), region_(selection.region)
{
    const auto bound = [this](std::size_t axis, double low, double high) {
        if (!bounds_) {
            bounds_.emplace();
            bounds_->min.fill(-std::numeric_limits<double>::infinity());
            bounds_->max.fill(std::numeric_limits<double>::infinity());
        }
        bounds_->min[axis] = std::max(bounds_->min[axis], low);
        bounds_->max[axis] = std::min(bounds_->max[axis], high);
    };
    if (region_ && region_->kind() == Region::Kind::box) {
        Box3d box = region_->bounds();
        for (std::size_t axis = 0; axis < 3 && box_; ++axis) {
            box.min[axis] = std::max(box.min[axis], box_->min[axis]);
            box.max[axis] = std::min(box.max[axis], box_->max[axis]);
        }
        box_ = bounds_ = box;
        region_.reset();
    }
    if (region_)
        for (std::size_t axis = 0; axis < 3; ++axis)
            bound(axis, region_->bounds().min[axis], region_->bounds().max[axis]);
    for (const Condition& condition : selection.where) {
        const std::string& name = condition.name;
        if (!schema.find(name) && name.size() == 1 && name[0] >= 'x' && name[0] <= 'z') {
            CoordinateTest test;
            test.axis = static_cast<std::size_t>(name[0] - 'x');
            test.ranges = intervals<double>(condition, {name, ScalarType::f64, 1, 1, 0, {}});
            test.inside = condition.relation != Condition::Relation::not_equal;
            if (test.inside) {
                double low = std::numeric_limits<double>::infinity(), high = -low;
                for (const auto& range : test.ranges) {
                    low = std::min(low, range[0]);
                    high = std::max(high, range[1]);
                }
                bound(test.axis, low, high);
            }
            coordinate_tests_.push_back(std::move(test));
            continue;
        }
        const auto [slot, component] = find_component(condition, schema);
        tests_.push_back(make_test(slot, component, condition, schema[slot]));
        if (std::find(tested_.begin(), tested_.end(), slot) == tested_.end()) tested_.push_back(slot);
    }
    std::sort(tested_.begin(), tested_.end());

    std::vector<bool> keep(schema.size(), selection.keep.empty());
    for (const auto* names : {&selection.keep, &selection.drop})
        for (const std::string& name : *names) {
            const auto slot = schema.find(name);
            if (!slot)
                throw Error(ErrorCode::invalid_argument, {}, "this cloud has no attribute '" + name + "'",
                            list_of(schema));
            keep[*slot] = names == &selection.keep;
        }
    for (std::size_t k = 0; k < schema.size(); ++k)
        if (keep[k]) {
            kept_.push_back(k);
            kept_schema_.add(schema[k]);
        }
}

Selector::~Selector() = default;
Selector::Selector(Selector&&) noexcept = default;
Selector& Selector::operator=(Selector&&) noexcept = default;

BoxRelation Selector::relation(const Box3d& box) const
{
    if (box.empty() || (bounds_ && !bounds_->intersects(box))) return BoxRelation::outside;
    BoxRelation relation = BoxRelation::inside;
    if (box_ && !box_->contains(box)) relation = BoxRelation::crosses;
    for (const CoordinateTest& test : coordinate_tests_)
        if (!test.surely_holds(box.min[test.axis], box.max[test.axis])) relation = BoxRelation::crosses;
    return region_ ? both(relation, region_->relation(box)) : relation;
}

void Selector::narrow_by_attributes(const std::vector<const Column*>& columns,
                                    std::vector<std::uint32_t>& selected) const
{
    for (const auto& test : tests_) test->narrow(*columns[test->attribute()], selected);
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

void keep_points(Column& column, const std::vector<std::uint32_t>& kept)
{
    std::byte* data = column.data();
    switch (const std::size_t size = column.point_bytes()) {
        case 1:
            keep_of_size<1>(data, kept);
            break;
        case 2:
            keep_of_size<2>(data, kept);
            break;
        case 4:
            keep_of_size<4>(data, kept);
            break;
        case 6:
            keep_of_size<6>(data, kept);
            break;
        case 8:
            keep_of_size<8>(data, kept);
            break;
        case 12:
            keep_of_size<12>(data, kept);
            break;
        default:
            for (std::size_t i = 0; i < kept.size(); ++i)
                if (kept[i] != i) std::memcpy(data + i * size, data + kept[i] * size, size);
    }
    column.resize(kept.size());
}

void keep_points(PointBatch& batch, const std::vector<std::uint32_t>& kept)
{
    for (std::size_t a = 0; a < 3; ++a) {
        if (batch.gridded)
            keep_in(batch.grid_xyz[a], kept);
        else
            keep_in(batch.xyz[a], kept);
    }
    for (Column& column : batch.attributes) keep_points(column, kept);
    batch.resize(kept.size());
}

SelectedReader::SelectedReader(std::unique_ptr<PointReader> cloud, const Selection& selection)
    : cloud_(std::move(cloud)), selector_(selection, cloud_->info().schema), info_(cloud_->info())
{
    info_.schema = selector_.kept_schema();
    if (!selector_.tests_points()) return;
    info_.points_known = false;
    if (info_.promised_box && selector_.bounds()) {
        Box3d& box = *info_.promised_box;
        for (std::size_t a = 0; a < 3; ++a) {
            box.min[a] = std::max(box.min[a], selector_.bounds()->min[a]);
            box.max[a] = std::min(box.max[a], selector_.bounds()->max[a]);
        }
        if (box.empty()) info_.promised_box.reset();
    }
}

bool SelectedReader::read(PointBatch& batch, std::size_t max_points)
{
    const Grid* grid = info_.grid ? &*info_.grid : nullptr;
    const std::vector<std::size_t>& kept = selector_.kept();
    const bool all_attributes = kept.size() == cloud_->info().schema.size();
    // A batch without a selected point is not the end.
    while (cloud_->read(all_attributes ? batch : whole_, max_points)) {
        PointBatch& whole = all_attributes ? batch : whole_;
        seen_ += whole.size;
        selector_.apply(whole, grid);
        if (whole.size == 0) continue;
        if (all_attributes) return true;
        shape_batch(batch, info_.schema, whole.gridded, whole.size);
        for (std::size_t a = 0; a < 3; ++a) {
            std::swap(batch.grid_xyz[a], whole.grid_xyz[a]);
            std::swap(batch.xyz[a], whole.xyz[a]);
        }
        for (std::size_t k = 0; k < kept.size(); ++k) std::swap(batch.attributes[k], whole.attributes[kept[k]]);
        return true;
    }
    info_.notes = cloud_->info().notes;  // readers count on the way what they drop
    shape_batch(batch, info_.schema, info_.grid.has_value(), 0);
    return false;
}

void SelectedReader::seek(std::uint64_t index)
{
    if (!seekable()) return PointReader::seek(index);
    cloud_->seek(index);
}

}  // namespace pcm
