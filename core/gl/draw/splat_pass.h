// Draws chunks as splats, in one style, into the current framebuffer.
//
// The kinds, for a point p with radius r, normal n and depth |pz| (source: Botsch, Spernat, Kobbelt 2004, and the
// thesis's chapter 7 with its errata; h is the viewport's height in pixels, n, t, b the near, top and bottom of the
// frustum):
//   constant     a square of point_size_px, whatever the point; visible while its centre is in the view, like every
//                point of OpenGL.
//   adaptive     an image-aligned square of 2 r n h / (|pz| (t - b)) pixels (eq. 7.1 with a diameter), analogously in
//                orthographic views; at least one pixel, so no point vanishes. Its depth is its centre's. As a
//                paraboloid it is a disc, gl.splats.paraboloid_radius times as large, and its depth is the centre's
//                plus half a radius times the square of the relative distance from the centre (Schuetz and Wimmer
//                2015), so that where splats overlap the one whose centre is nearest is seen.
//   affine       the point's disc under rays that are parallel to the view around its centre (eqs 7.2 to 7.4). Exact
//                for an orthographic view. In perspective the disc's edge-on direction is taken as perpendicular to the
//                view's axis, not to the ray: discs near the picture's border are too thick or too thin, and a nearly
//                edge-on disc (n.z -> 0) becomes a line whose depth diverges, which leaves holes. Fragments at or
//                behind the eye, or beyond the near or far plane, are discarded; so is a splat whose centre is behind
//                the eye.
//   perspective  the disc itself: each fragment's ray is intersected with the splat's plane (eqs 7.5 to 7.8), in the
//                cloud's own axes, and the hit's depth written. Where the near plane cuts the disc, what is behind it
//                is visible. Exactly edge-on discs cover nothing.
//   fitted       by the point's surroundings (view/point_shapes.h), found when its chunk was uploaded: on a surface its
//                disc, on a line one that faces the eye and is a quarter as wide as long, else one that faces the eye,
//                among leaves smaller and at most 10 pixels wide. What is drawn is the ellipse that the projection's
//                derivative at the centre makes of it, widened by a filter (covariance + 0.5 square pixels), so that no
//                point vanishes and nothing is edge-on. Its depth is the plane's, at most a radius from the centre's,
//                plus a radius times the square of the relative distance from the centre.
// Discs of the affine and perspective kinds that are smaller than a pixel and cover no pixel's centre are invisible. A
// normal of (0, 0, 0) faces the eye. A radius of 0 draws nothing in the last two kinds; NaN was replaced on upload
// (view/vertex_discs.h).
//
// Accuracy of the perspective mode, relative to the points as they were uploaded: 1e-4 of the radius in place and
// depth, from a graze of 0.1 degree on, for any radius and origin, where the depth buffer resolves it, apart from
// pixels within 1e-2 px of a silhouette. Values common to a splat's fragments are computed in double where the device
// has doubles (and does not emulate them); without, the accuracy is 3e-4.
//
// With several samples per pixel discs are antialiased: coverage is computed per sample, colour and depth at the
// pixel's centre. Where the driver has no ARB_sample_shading, coverage is that of the pixel's centre.
//
// Splats of any size are drawn correctly: a chunk that may hold one beyond the driver's largest point is drawn as
// quads. The visible part of a splat that is not constant does not depend on whether its centre is in the view.
//
// In a chunk that is partly in view only those groups of points are drawn whose boxes are in view, and as quads only
// where splats may be too large for points (gl/draw/splat_sieve.h); the picture is the same.
//
// Projections are perspective, off-axis too, or orthographic; a shear between x and y in them is ignored. The depth
// range is 0 to 1.
//
// GL thread only. Works in compatibility and core contexts of OpenGL 3.3; programs are built on first use.
#pragma once

#include "pcm/gl/draw/splat_sieve.h"
#include "pcm/gl/draw/view_clips.h"
#include "pcm/tree/tree.h"
#include "pcm/view/level_of_detail.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcm {

// Which points of a cloud are shown, and which in another colour.
struct ShownPoints {
    const ViewClips* clips = nullptr;  // outlives the drawing; those that shaders test count
    std::array<float, 3> selected_colour{};
    std::uint32_t frame = 0;  // frame of a mean (gl/draw/smoothing.h); 0: the picture itself
};

class SplatPass {
public:
    // Without `doubles` it works as on a device without double precision.
    explicit SplatPass(bool doubles = true);
    // Makes no OpenGL call: objects that release() has not freed live until the context ends.
    ~SplatPass();
    SplatPass(SplatPass&&) noexcept;
    SplatPass& operator=(SplatPass&&) noexcept;

    // `view` includes the cloud's placement, view.origin is the cloud's local origin; a view that Frustum::of() refuses
    // draws nothing. `reversed`: depth runs from 1 (near) to 0 (far), the clip volume is 0 <= z <= w (glClipControl)
    // and the clear value 0; otherwise OpenGL's defaults. `samples`: the framebuffer's, 1 or 0 for none. The context's
    // viewport is used; its size is the view's. Changes viewport and scissor until end(), and lastingly the state that
    // GlStateGuard restores. Throws Error(unsupported) when the driver cannot compile a program, as does draw().
    // `values` are those that the style's ramp shows. `paraboloids`: adaptive splats are these.
    void begin(const Camera& view, const TreeInfo& info, const CloudStyle& usable, bool reversed, unsigned samples,
               bool paraboloids = false, const ShownValues& values = {}, const ShownPoints& points = {});
    // Draws the entry's points in the style, as far as the entry has its attributes: without normals as adaptive
    // splats, without radii as constant ones (drawable_mode()), without colours in the style's uniform colour, with
    // colours of another attribute in these. Returns the number of points that were left out in groups of which clips
    // leave none; of other groups clipped points are not counted.
    std::uint32_t draw(const VertexEntry& entry, const ChunkLook& look);
    // What draw() would draw with splats of their own sizes: adds the parts of the entry that are in view. Returns the
    // exact number of invocations of the vertex stage: one per point that is drawn, four where splats may be larger
    // than the driver's points.
    std::uint64_t preview(const VertexEntry& entry, std::vector<SplatPart>& parts);
    void end();

    // Number of programs that were built, a permutation each.
    std::size_t programs() const;

    // Frees the GL objects. begin() may be called again afterwards.
    void release();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace pcm
