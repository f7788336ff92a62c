// The inside of flat faces: where their points are those of one surface.
//
// Another surface that meets a face has points within the threshold of its plane, all on one side of it, next to the
// line where they meet: at the face's border, as the sides of posts, or across it, as the web of a beam on its flange.
// They turn and shift the plane by far more than chance does, and a narrow face has few others.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/shapes/flat_hull.h"
#include "pcm/shapes/shape.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

// A surface of a cloud, which may meet others; source coordinates and units.
struct MeetingSurface {
    Shape shape;
    Box3d box;  // around its points
    double threshold = 0;
    std::optional<FlatHull> outline;  // outline of a plane that is a face
};

// Any number of threads.
class FaceInteriors {
public:
    // Surfaces that meet a face are those in whose box it is, but planes nearly parallel to it.
    explicit FaceInteriors(std::vector<MeetingSurface> surfaces);

    // The inside of one face, for points in a box. Valid as long as the whole.
    class InBox {
    public:
        // Farther than detect.faces.border from the outline, inwards, and than detect.faces.reach from other surfaces.
        bool has(const Vec3d& p) const;

    private:
        friend class FaceInteriors;
        const MeetingSurface* face_ = nullptr;
        std::vector<const MeetingSurface*> others_;  // those that have points in the box
        double border_ = 0, reach_ = 0;              // thresholds
    };
    // `surface`: place in the list. Nothing of a surface without an outline.
    std::optional<InBox> inside(std::size_t surface, const Box3d& box) const;

private:
    std::vector<MeetingSurface> surfaces_;           // boxes with what lies within reach
    std::vector<std::vector<std::uint32_t>> meets_;  // for each face the surfaces that meet it
};

}  // namespace pcm
