#include "pcm/cad/drawing_list.h"

#include "pcm/system/counted.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace pcm {
namespace {

void check_numbers(const Primitive& primitive)
{
    const ShapeBounds& bounds = primitive.bounds;
    try {
        check(primitive.fit.shape);
    } catch (const Error& error) {
        throw Error(ErrorCode::invalid_argument, {}, "'" + primitive.name + "': " + error.what());
    }
    if (!std::all_of(bounds.outline.begin(), bounds.outline.end(), is_finite) || !std::isfinite(bounds.from) ||
        !std::isfinite(bounds.to) || !is_finite(bounds.zero) || !std::isfinite(bounds.begin) ||
        !std::isfinite(bounds.end))
        throw Error(ErrorCode::invalid_argument, {}, "the bounds of '" + primitive.name + "' are not finite");
}

}  // namespace

void DrawingList::note_unit(CadUnit unit, const std::string& file)
{
    if (unit == CadUnit::none)
        notes.push_back(file + " has a unit, and none is given: its lengths are taken for metres");
}

std::vector<std::string> DrawingList::names() const
{
    std::vector<std::string> names;
    for (const Primitive* primitive : shown) names.push_back(primitive->name);
    return names;
}

DrawingList drawing_list(const std::vector<Primitive>& primitives, bool bounded)
{
    DrawingList list;
    std::size_t hidden = 0;
    std::vector<std::size_t> unbounded(shape_kinds().size());
    for (const Primitive& primitive : primitives) {
        const ShapeKind kind = primitive.fit.shape.kind;
        if (primitive.hidden) {
            ++hidden;
            continue;
        }
        check_numbers(primitive);
        if (bounded && !primitive.bounds.known(kind))
            ++unbounded[static_cast<std::size_t>(kind)];
        else
            list.shown.push_back(&primitive);
    }
    if (hidden) list.notes.push_back(counted(hidden, "hidden primitive", "is left out", "are left out"));
    for (const ShapeTraits& traits : shape_kinds()) {
        const std::string what = traits.extent == ShapeExtent::outline ? "no outline" : "no known length";
        if (const std::size_t count = unbounded[static_cast<std::size_t>(traits.kind)])
            list.notes.push_back(
                counted(count, traits.name, "has " + what + " and is left out", "have " + what + " and are left out"));
    }
    if (list.shown.empty()) {
        std::string why = primitives.empty() ? "the list is empty" : "";
        for (const std::string& note : list.notes) why += (why.empty() ? "" : "; ") + note;
        throw Error(ErrorCode::invalid_argument, {}, "there is no primitive to write: " + why);
    }
    list.runs = pipe_runs(list.shown);
    return list;
}

}  // namespace pcm
