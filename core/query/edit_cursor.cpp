#include "pcm/query/edit_cursor.h"

#include "pcm/cloud/with_type.h"
#include "pcm/query/point_cursor.h"
#include "pcm/query/query_source.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

namespace pcm {
namespace {

template <class T>
bool can_hold(double value)
{
    if constexpr (std::is_floating_point_v<T>) {
        return !std::isfinite(value) || std::fabs(value) <= static_cast<double>(std::numeric_limits<T>::max());
    } else {
        // The largest integer of 64 bits is not a double; the power of two after it is.
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
    return *(column = &edit_->column((*slots_)[attribute]));  // after a mark this is a new copy
}

void EditView::set(std::size_t i, std::size_t attribute, double value, std::uint32_t component)
{
    Column& to = column(attribute);
    if (component >= to.components())
        throw Error(ErrorCode::invalid_argument, {},
                    "there is no component " + std::to_string(component) + " of " + std::to_string(to.components()));
    with_type(to.type(), [&](auto scalar) {
        using T = decltype(scalar);
        if (!can_hold<T>(value))
            throw Error(ErrorCode::invalid_argument, {},
                        "an attribute of type " + std::string(name_of(to.type())) + " cannot be " + exact(value));
        to.as<T>()[std::size_t((*numbers_)[i]) * to.components() + component] = static_cast<T>(value);
    });
}

struct EditCursor::State {
    std::shared_ptr<QuerySource> source;
    PointCursor points;
    std::vector<std::size_t> slots;
    ColumnSet columns;
    std::optional<L2Cache::Edit> edit;
    std::vector<std::uint32_t> numbers;
    SourceRounding rounding;

    void end_edit()
    {
        if (!edit) return;
        const bool unmarked = edit->changed();
        edit->discard();
        edit.reset();
        if (unmarked)
            throw Error(ErrorCode::invalid_argument, source->folder,
                        "points were changed and not marked as written; the change is dropped",
                        "call mark_written() before moving on");
    }
};

EditCursor::EditCursor(std::shared_ptr<QuerySource> source, const Query& query)
{
    // The inner cursor finds the selected points; the values are taken when a chunk comes up.
    Query which = query;
    which.attributes.clear();
    std::vector<std::size_t> slots = slots_of(*source, query);
    ColumnSet columns;
    for (const std::size_t slot : slots) columns.attributes.set(slot);
    PointCursor points(source, which);
    const TreeInfo& info = source->info();
    state_.reset(
        new State{std::move(source), std::move(points), std::move(slots), columns, {}, {}, SourceRounding(info)});
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
    s.edit.emplace(s.source->cache.edit(points.node(), s.columns));
    view.node_ = points.node();
    view.grid_ = &s.source->info().grid;
    view.rounding_ = &s.rounding;
    view.edit_ = &*s.edit;
    view.numbers_ = &s.numbers;
    view.slots_ = &s.slots;
    view.columns_.assign(s.slots.size(), nullptr);
    return true;
}

}  // namespace pcm
