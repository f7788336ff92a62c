// Draws chunks as splats, in one style, into the current framebuffer.
//
// The kinds, for a point p with radius r, normal n and depth |pz| (source: Botsch, Spernat, Kobbelt 2004, and the
// thesis's chapter 7 with its errata; h is the viewport's height in pixels, n, t, b the near, top and bottom of the
// frustum):
//   constant     a square of point_size_px, whatever the point; seen while its centre is in the view, as OpenGL has it.
//   dynamic      an image-aligned square of 2 r n h / (|pz| (t - b)) pixels (eq. 7.1 with a diameter), parallel views
//   alike; at least
//                one pixel, so no point vanishes. Its depth is its centre's.
//   affine       the point's disc under rays that are parallel to the view around its centre (eqs 7.2 to 7.4). Exact
//   for a parallel
//                view. In a perspective the disc's edge-on direction is taken as perpendicular to the view's axis, not
//                to the ray: discs near the picture's border are too thick or too thin, and one that is seen from
//                nearly the side (n.z -> 0) becomes a line whose depth runs away, which leaves holes. What would lie at
//                or behind the eye, or beyond the near or far plane, is dropped; so is a splat whose centre lies behind
//                the eye.
//   perspective  the disc itself: each fragment's ray is cut with the splat's plane (eqs 7.5 to 7.8), in the cloud's
//   own axes, and the
//                hit's depth written. Where the near plane cuts the disc, what is behind it is seen. What exactly
//                edge-on discs cover is nothing.
// Discs that are smaller than a pixel and cover no pixel's centre are not seen. A normal of (0, 0, 0) is one that faces
// the eye. A radius of 0 draws nothing in the last two; numbers that are none have been taken out on upload
// (gl/vertex_discs.h).
//
// Accuracy of the perspective mode, relative to the points as they were uploaded: 1e-4 of the radius in place and
// depth, from a graze of 0.1 degree on, for any radius and origin, with a depth buffer that can tell it, apart from
// pixels within 1e-2 px of a silhouette. What a splat's fragments have in common is computed in double where the device
// has doubles (and does not emulate them); without, it is 3e-4.
//
// With several samples a pixel discs are antialiased: coverage is found for each sample, colour and depth for the
// pixel's centre. Where the driver has no ARB_sample_shading, coverage is that of the pixel's centre.
//
// Splats of any size are right: a chunk that may hold one beyond the driver's largest point is drawn as quads. What is
// seen of one that is not constant does not depend on whether its centre is in the view.
//
// Of a chunk that is partly in view only those groups of points are drawn whose boxes are, and only where splats may be
// too large for points, quads (gl/splat_sieve.h): what is drawn does not change by it.
//
// Projections are perspective, off-axis too, or orthographic; a mix of x and y in them is not looked at. The depth
// range is 0 to 1.
//
// GL thread only. Works in compatibility and core contexts of OpenGL 3.3; programs are built on first use.
#pragma once

#include "pcm/gl/splat_sieve.h"
#include "pcm/tree/tree.h"
#include "pcm/view/level_of_detail.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcm {

class SplatPass {
public:
    // Without `doubles` it works as on a device that has none.
    explicit SplatPass(bool doubles = true);
    // Touches no OpenGL: what release() has not freed is left to the context's end.
    ~SplatPass();
    SplatPass(SplatPass&&) noexcept;
    SplatPass& operator=(SplatPass&&) noexcept;

    // `view` includes the cloud's placement, view.origin is the cloud's local origin; a view that Frustum::of() refuses
    // draws nothing. `reversed`: depth runs from 1 (near) to 0 (far), the clip volume is 0 <= z <= w (glClipControl),
    // the clear value 0; else the usual. `samples`: of the framebuffer, 1 or 0 for none. The viewport is that of the
    // context, as large as the view's. Changes, until end() and beyond, what GlStateGuard restores; viewport and
    // scissor until end(). Throws Error(unsupported) when the driver cannot compile a program, as does draw().
    void begin(const Camera& view, const TreeInfo& info, const CloudStyle& usable, bool reversed, unsigned samples);
    // The entry's points, in the style's way as far as the entry has what that reads: without normals it is drawn with
    // dynamic splats, without radii with constant ones, without colours in the style's uniform colour, with those of
    // another attribute in those.
    void draw(const VertexEntry& entry, const ChunkLook& look);
    // What draw() would draw of it, were splats no larger than their own sizes: adds the parts of it that are in view.
    // Returns how often the vertex stage runs, exactly: once a point that is drawn, four times where splats may be
    // larger than the driver's points.
    std::uint64_t preview(const VertexEntry& entry, std::vector<SplatPart>& parts);
    void end();

    // Frees the GL objects. begin() may be called again afterwards.
    void release();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace pcm
