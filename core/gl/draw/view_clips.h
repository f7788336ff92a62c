// The clips of a cloud in a picture, in the form that splats' shaders test. No OpenGL here.
//
// Clips that are bounded by planes are tested for each point in the vertex stage, so that a box can be moved without
// uploading a point again; the others decide which points are uploaded (gl/l1/chunk_filter.h). Planes are taken to a
// chunk's coordinates in double. Points that lie within single precision of a chunk's extent (2^-21 of it) of a plane
// count as on it, which is as in the region.
#pragma once

#include "pcm/cloud/clip.h"
#include "pcm/cloud/geometry.h"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace pcm {

// As the shaders read them.
struct ClipUniforms {
    static constexpr std::size_t most_planes = 24, most_clips = 4;
    std::array<std::array<float, 4>, most_planes> planes{};  // normal and offset, relative to a chunk's reference
    std::array<int, most_clips> ends{};                      // of each clip's planes
    int count = 0;                                           // of clips
    int outside = 0;                                         // a bit for each clip
};

class ViewClips {
public:
    ViewClips() = default;
    explicit ViewClips(const std::vector<Clip>& clips);

    bool empty() const { return all_.empty(); }
    const std::vector<Clip>& all() const { return all_; }
    // Those that a shader cannot test.
    const std::vector<Clip>& by_point() const { return by_point_; }
    // Whether points of a box in source coordinates stay, of the clips that shaders test.
    BoxRelation relation(const Box3d& source) const { return relation_of(by_plane_, source); }
    // For positions relative to `reference` (source coordinates), of a chunk of this extent.
    ClipUniforms uniforms(const Vec3d& reference, const Vec3d& extent) const;

    // Equal clips have equal texts.
    const std::string& text() const { return text_; }

private:
    std::vector<Clip> all_, by_plane_, by_point_;
    std::vector<std::vector<Region::Plane>> planes_;  // of those by plane
    std::string text_;
};

// The text of these clips; equal clips have equal texts.
std::string text_of(const std::vector<Clip>& clips);

}  // namespace pcm
