#include "pcm/edit_cursor.h"

#include "pcm/system/error.h"
#include "pcm/cloud/with_type.h"
#include "pcm/point_cloud.h"

#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

namespace pcm {
namespace {

template <class T>
bool can_have(double value)
{
    if constexpr (std::is_floating_point_v<T>) {
        return !std::isfinite(value) || std::fabs(value) <= static_cast<double>(std::numeric_limits<T>::max());
    } else {
        // The largest of 64 bits is no double; the power of two after it is.
        const double end = std::ldexp(1.0, std::numeric_limits<T>::digits);
        return value == std::floor(value) && value < end && value >= (std::is_signed_v<T> ? -end : 0.0);
    }
}

}  // namespace

double EditView::value(std::size_t i, std::size_t attribute, std::uint32_t component) const
{
    const Column* column = columns_[attribute];
    if (!column) column = edit_->chunk().attributes[(*slots_)[attribute]].get();
    return column->value((*numbers_)[i], component);
}

Column& EditView::column(std::size_t attribute)
{
    Column*& column = columns_[attribute];
    return *(column = &edit_->column((*slots_)[attribute]));  // marking begins a new copy
}

void EditView::set(std::size_t i, std::size_t attribute, double value, std::uint32_t component)
{
    Column& to = column(attribute);
    if (component >= to.components())
        throw Error(ErrorCode::invalid_argument, {},
                    "there is no component " + std::to_string(component) + " of " + std::to_string(to.components()));
    with_type(to.type(), [&](auto scalar) {
        using T = decltype(scalar);
        if (!can_have<T>(value))
            throw Error(
                ErrorCode::invalid_argument, {},
                "an attribute of type " + std::string(name_of(to.type())) + " cannot be " + std::to_string(value));
        to.as<T>()[std::size_t((*numbers_)[i]) * to.components() + component] = static_cast<T>(value);
    });
}

struct EditCursor::State {
    std::shared_ptr<PointCloud> cloud;
    PointCursor points;
    std::vector<std::size_t> slots;
    ColumnSet columns;
    std::optional<L2Cache::Edit> edit;
    std::vector<std::uint32_t> numbers;

    void end_edit()
    {
        if (!edit) return;
        const bool unmarked = edit->changed();
        edit->discard();
        edit.reset();
        if (unmarked)
            throw Error(ErrorCode::invalid_argument, cloud->tree()->folder(),
                        "points were changed and not marked as written; the change is dropped",
                        "call mark_written() before going on");
    }
};

EditCursor::EditCursor(std::shared_ptr<PointCloud> cloud, const Query& query)
{
    // What is selected is found in what there is; the values are taken when a chunk's turn has come.
    Query which = query;
    which.attributes.clear();
    State state{cloud, cloud->points(which), {}, {}, {}, {}};
    for (const std::string& name : query.attributes) {
        const auto slot = cloud->info().schema.find(name);
        if (!slot)
            throw Error(ErrorCode::invalid_argument, cloud->tree()->folder(),
                        "this cloud has no attribute '" + name + "'");
        state.slots.push_back(*slot);
        state.columns.attributes.set(*slot);
    }
    state_ = std::make_unique<State>(std::move(state));
}

EditCursor::EditCursor(EditCursor&&) noexcept = default;
EditCursor& EditCursor::operator=(EditCursor&&) noexcept = default;
EditCursor::~EditCursor() = default;

bool EditCursor::getNextData(EditView& view)
{
    State& s = *state_;
    view = EditView();
    s.end_edit();
    PointView points;
    if (!s.points.getNextData(points)) return false;
    s.numbers.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) s.numbers[i] = points.number(i);
    s.edit.emplace(s.cloud->cache().edit(points.node(), s.columns));
    view.node_ = points.node();
    view.grid_ = &s.cloud->info().grid;
    view.edit_ = &*s.edit;
    view.numbers_ = &s.numbers;
    view.slots_ = &s.slots;
    view.columns_.assign(s.slots.size(), nullptr);
    return true;
}

}  // namespace pcm
