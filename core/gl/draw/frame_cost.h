// Estimates what the chunks of a frame cost to draw, before they are drawn.
#pragma once

#include "pcm/gl/draw/frame.h"

#include <cstdint>
#include <vector>

namespace pcm {

// A chunk that can be drawn.
struct Stroke {
    SceneSelection::Place place;
    const VertexEntry* entry;
    std::uint64_t vertices;         // invocations of the vertex stage
    std::size_t first_part, parts;  // of the FrameCost's parts: those in view
};

class FrameCost {
public:
    // `places` are in drawing order and their chunks in L1. Begins and ends the splats of each cloud once.
    FrameCost(Frame& frame, const SceneSelection& selection, const std::vector<SceneSelection::Place>& places);

    const std::vector<Stroke>& strokes() const { return strokes_; }
    FrameWork work(const Stroke& stroke, const FrameCloud::Gap& gap) const;

private:
    Frame& frame_;
    std::vector<Stroke> strokes_;
    std::vector<SplatPart> parts_;
};

inline FrameWork operator+(const FrameWork& a, const FrameWork& b)
{
    return {a.points + b.points, a.vertices + b.vertices, a.splats + b.splats, a.pixels + b.pixels,
            a.at_rest || b.at_rest};
}

}  // namespace pcm
