#include "pcm/shapes/shape_mesh.h"

#include "pcm/shapes/axis_frame.h"
#include "pcm/shapes/flat_points.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm {
namespace {

// Clips ears of a polygon on a grid of integers, on which turns are exact.
class EarClipper {
public:
    explicit EarClipper(std::vector<FlatPoint> corners) : corners_(std::move(corners))
    {
        const auto count = static_cast<std::uint32_t>(corners_.size());
        for (std::uint32_t i = 0; i < count; ++i) {
            before_.push_back(i == 0 ? count - 1 : i - 1);
            after_.push_back(i + 1 == count ? 0 : i + 1);
        }
    }
    std::vector<std::array<std::uint32_t, 3>> clip()
    {
        for (std::uint32_t i = 0; i < corners_.size(); ++i)
            if (turn_at(i) <= 0) reflex_.push_back(i);
        std::size_t left = corners_.size(), tried = 0;
        for (std::uint32_t i = 0; left > 3 && tried <= left;) {
            if (!is_ear(i)) {
                i = after_[i];
                ++tried;
                continue;
            }
            triangles_.push_back({before_[i], i, after_[i]});
            after_[before_[i]] = after_[i];
            before_[after_[i]] = before_[i];
            // Clipped corners, and those that no longer point inwards, are in nobody's way.
            const std::uint32_t gone = i;
            reflex_.erase(std::remove_if(reflex_.begin(), reflex_.end(),
                                         [&](std::uint32_t r) { return r == gone || turn_at(r) > 0; }),
                          reflex_.end());
            i = after_[i];
            i = after_[i];  // not all from one corner
            first_ = i;
            --left;
            tried = 0;
        }
        if (left != 3 || turn_at(first_) <= 0) return {};
        triangles_.push_back({before_[first_], first_, after_[first_]});
        return triangles_;
    }

private:
    std::int64_t turn_at(std::uint32_t i) const
    {
        return turn_of(corners_[before_[i]], corners_[i], corners_[after_[i]]);
    }
    bool is_ear(std::uint32_t i) const
    {
        if (turn_at(i) <= 0) return false;
        const FlatPoint &a = corners_[before_[i]], &b = corners_[i], &c = corners_[after_[i]];
        return std::none_of(reflex_.begin(), reflex_.end(), [&](std::uint32_t r) {
            const FlatPoint& p = corners_[r];
            return r != i && r != before_[i] && r != after_[i] && turn_of(a, b, p) >= 0 && turn_of(b, c, p) >= 0 &&
                   turn_of(c, a, p) >= 0;
        });
    }

    std::vector<FlatPoint> corners_;
    std::vector<std::uint32_t> before_, after_, reflex_;
    std::vector<std::array<std::uint32_t, 3>> triangles_;
    std::uint32_t first_ = 0;  // a corner that is left
};

void check(const MeshOptions& options)
{
    if (!(options.chord >= 0 && std::isfinite(options.chord)))
        throw Error(ErrorCode::invalid_argument, {}, "the chord tolerance is not 0 or above");
}

}  // namespace

void mesh_shape(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options, const FaceVisitor& visit)
{
    check(shape);
    check(options);
    traits_of(shape.kind).mesh(shape, bounds, options, visit);
}

ShapeLines lines_of(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options)
{
    check(shape);
    check(options);
    ShapeLines found;
    traits_of(shape.kind).mesh_lines(shape, bounds, options, found);
    return found;
}

std::vector<std::array<std::uint32_t, 3>> triangulate_outline(const std::vector<Vec3d>& outline, const Vec3d& normal)
{
    if (outline.size() < 3) return {};
    const AxisFrame frame(normal);
    std::vector<Vec2d> flat;
    for (const Vec3d& p : outline) flat.push_back({dot(p - outline[0], frame.u), dot(p - outline[0], frame.v)});
    const FlatPoints sorted(flat);
    if (sorted.size() != outline.size()) return {};
    std::vector<FlatPoint> corners(outline.size());
    for (const FlatPoint& p : sorted.points()) corners[p.index] = p;
    return EarClipper(std::move(corners)).clip();
}

}  // namespace pcm
