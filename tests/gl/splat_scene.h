// Discs in video memory, drawn by the splat pass alone, and the same discs for the oracle.
#pragma once

#include "tests/gl/gl_support.h"
#include "tests/oracle/disc_oracle.h"

#include "pcm/gl/draw/splat_pass.h"
#include "pcm/view/point_shapes.h"

#include <memory>
#include <vector>

namespace pcm::test {

// A framebuffer with a float depth buffer, multisampled if need be; bound and its viewport set while it lives.
class DepthFramebuffer {
public:
    DepthFramebuffer(int width, int height, unsigned samples = 1);
    ~DepthFramebuffer();
    void clear(bool reversed) const;
    std::vector<Pixel> colours() const;  // averaged over the samples
    std::vector<float> depths() const;   // for a framebuffer of one sample a pixel only

private:
    int width_, height_;
    unsigned samples_;
    GLuint framebuffer_ = 0, colour_ = 0, depth_ = 0;
};

// Points of one chunk on a grid. Disc number d has the colour of d + 1 in base 256, so that a pixel identifies its
// disc.
class SplatScene {
public:
    // Centres are source coordinates and are rounded to the grid.
    SplatScene(const Grid& grid, const std::vector<Disc>& source_discs,
               const VertexFormat& format = {ColourSource::rgb, true, true},
               const std::vector<PointShape>& shapes = {});
    ~SplatScene();

    // As they were uploaded: centres relative to the view's origin, rounded to floats relative to the chunk's, radii
    // and normals as floats.
    std::vector<Disc> discs(const Camera& view) const;
    void draw(SplatPass& pass, const Camera& view, const CloudStyle& style, bool reversed, unsigned samples = 1,
              const ChunkLook& look = {}, bool paraboloids = false) const
    {
        draw(entry(), pass, view, style, reversed, samples, look, paraboloids);
    }
    // As if this were the scene's entry.
    void draw(const VertexEntry& entry, SplatPass& pass, const Camera& view, const CloudStyle& style, bool reversed,
              unsigned samples, const ChunkLook& look, bool paraboloids = false) const;
    const TreeInfo& info() const { return info_; }
    const VertexEntry& entry() const;
    static int disc_of(const Pixel& pixel) { return pixel.r + 256 * pixel.g + 65536 * pixel.b - 1; }  // -1: none

private:
    TreeInfo info_;
    std::vector<Vec3i> places_;
    std::vector<float> radii_, normals_;
    L1Cache l1_;
    L1Cache::Owner owner_;
};

// The depth along the view of a value of the depth buffer.
double depth_of(const Camera& view, bool reversed, float value);

CloudStyle style_of(SplatMode mode);

struct Drawn {
    std::vector<Pixel> colours;
    std::vector<float> depths;
};
// The scene alone, with a pass of its own.
Drawn draw(const SplatScene& scene, const Camera& view, const CloudStyle& style, bool reversed = true,
           const ChunkLook& look = {}, bool paraboloids = false);

// The size of the views below.
constexpr int width = 160;
constexpr int height = 120;
constexpr double aspect = double(width) / height;
Camera perspective_view();
Camera parallel_view();

// Discs in front of an eye at the origin; the centres of some are next to the view.
std::vector<Disc> field(std::size_t count, std::uint64_t seed, double wideness = 0.8, double size = 1);
Grid fine_grid();

struct Agreement {
    std::size_t covered = 0;  // covered pixels about which the oracle is certain
    std::size_t certain = 0;  // these and the empty ones
    std::size_t wrong_coverage = 0;
    std::size_t wrong_disc = 0;
    std::size_t not_numbers = 0;
    double worst_depth = 0;  // maximum error of a hit along its ray, in radii of the disc
};

// Draws the scene in the perspective mode and compares each fragment with the oracle.
Agreement compare(const SplatScene& scene, const Camera& view, bool reversed, bool doubles, double margin = 0.01);

}  // namespace pcm::test
