#include "pcm/shapes/bounds.h"

#include "pcm/shapes/axis_bounds.h"
#include "pcm/shapes/axis_frame.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace pcm {
namespace {

constexpr const char* outline_names[] = {"box", "rectangle", "convex", "concave"};

void check_box(const Box3d& box)
{
    if (!box.empty() && !(is_finite(box.min) && is_finite(box.max)))
        throw Error(ErrorCode::invalid_argument, {}, "the box that bounds a shape is not finite");
}

}  // namespace

std::optional<OutlineKind> outline_kind(const std::string& name)
{
    for (std::size_t i = 0; i < std::size(outline_names); ++i)
        if (name == outline_names[i]) return static_cast<OutlineKind>(i);
    return {};
}

const char* name_of(OutlineKind kind) { return outline_names[static_cast<std::size_t>(kind)]; }

ShapeBounds bounds_in_box(const Shape& shape, const Box3d& box)
{
    check(shape);
    check_box(box);
    ShapeBounds bounds;
    const ShapeTraits& traits = traits_of(shape.kind);
    if (traits.has_arc()) bounds.zero = AxisFrame(shape.axis).u;
    if (!box.empty()) traits.bound_in_box(shape, box, bounds);
    return bounds;
}

ShapeBounds bounds_of(const Shape& shape, const std::vector<Vec3d>& inliers, const OutlineOptions& options,
                      const Box3d& box)
{
    check(shape);
    check_box(box);
    if (!(options.edge >= 0 && std::isfinite(options.edge)))
        throw Error(ErrorCode::invalid_argument, {}, "the edge length of a concave outline is not 0 or above");
    if (inliers.empty())
        throw Error(ErrorCode::invalid_argument, {},
                    "there are no points to bound the " + std::string(traits_of(shape.kind).name) + " by");
    if (!std::all_of(inliers.begin(), inliers.end(), is_finite))
        throw Error(ErrorCode::invalid_argument, {}, "a point that bounds a shape is not finite");
    const ShapeTraits& traits = traits_of(shape.kind);
    ShapeBounds bounds;
    if (options.kind == OutlineKind::box)
        bounds = bounds_in_box(shape, box);
    else
        traits.bound_points(shape, inliers, options, bounds);
    if (traits.has_arc()) shapes::bound_arc(shape, inliers, bounds);
    return bounds;
}

}  // namespace pcm
