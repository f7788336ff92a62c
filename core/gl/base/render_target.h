// An offscreen picture, colour and depth, and its composition into the host's framebuffer.
//
// Splats are drawn here and not into the host's framebuffer for three features that the host may lack: several samples
// per pixel; 32-bit float depth that runs from 1 at the near plane to 0 (so that its precision does not end a few
// metres from the eye); and persistence: frames of a resting view add to the picture. GL thread only; a target belongs
// to one context, a Compositor to a share group.
#pragma once

#include "pcm/gl/base/gl_state.h"
#include "pcm/gl/base/shader_program.h"
#include "pcm/view/level_of_detail.h"

#include <cstdint>
#include <map>
#include <tuple>

namespace pcm {

class RenderTarget {
public:
    // Per pixel. Beyond these NVIDIA's driver draws a picture twice as wide and high and puts it together, and a point
    // of 20 pixels has 10.
    static constexpr int most_samples = 8;

    // Resizes it, with `samples` per pixel, most_samples or the driver's most, whichever is fewest. True when the
    // contents are lost. Throws Error(unsupported) when the driver cannot make such a framebuffer.
    bool prepare(int width, int height, unsigned samples);
    void bind() const;  // for drawing, the viewport covering all of it
    void clear() const;

    int width() const { return width_; }
    int height() const { return height_; }
    unsigned samples() const { return samples_; }
    bool reversed() const { return reversed_; }
    std::uint32_t colours() const
    {
        return colours_;
    }  // RGBA8; alpha 0 where nothing was drawn, else as shaders/splat.vert marks it
    std::uint32_t depths() const { return depths_; }  // 32-bit float

    void release();

private:
    int width_ = 0, height_ = 0;
    unsigned asked_samples_ = 0, samples_ = 0;
    bool reversed_ = false;
    std::uint32_t framebuffer_ = 0, colours_ = 0, depths_ = 0;
};

// A texture to draw into, without depth. GL thread only; it belongs to one context.
class ColourTarget {
public:
    // sums: colours times coverage, and coverage, added up over pictures, in 32-bit floats: sums of some thousand bytes
    //     are exact;
    // shades: how bright eye-dome lighting leaves a pixel, in a byte, and interpolated between pixels.
    enum Content : std::uint8_t { sums, shades };
    explicit ColourTarget(Content content) : content_(content) {}

    // Makes it, black. False when the driver cannot, or has no memory for it; then there is none.
    bool begin(int width, int height);
    void bind() const;  // for drawing, the viewport covering all of it
    std::uint32_t texture() const { return texture_; }
    void release();

private:
    Content content_;
    int width_ = 0, height_ = 0;
    std::uint32_t framebuffer_ = 0, texture_ = 0;
};

// What is made of a picture when it is composited.
struct Finish {
    float eye_dome = 0;       // strength of eye-dome lighting; 0: none
    bool fast = false;        // eye-dome lighting of every other pixel in every other row, from half as many neighbours
    bool close_gaps = false;  // pixels that no splat covers are filled where they lie within a surface
    bool needs_one_sample() const { return eye_dome > 0 || close_gaps; }
};

class Compositor {
public:
    // Draws the picture into the host's framebuffer, depth tested (GL_LEQUAL) and written in the host's projection and
    // depth range; partly covered pixels are blended. `resolved` is scratch for pictures of several samples, `shades`
    // for fast lighting.
    void draw(const RenderTarget& picture, RenderTarget& resolved, ColourTarget& shades, const GlStateGuard& host,
              const Matrix4d& projection, const Finish& finish);
    // Adds the picture, as draw() would show it, to the sum.
    void add(const RenderTarget& picture, RenderTarget& resolved, const ColourTarget& sum, const Matrix4d& projection,
             const Finish& finish);
    // Draws the mean of `frames` pictures in place of draw(), with the depth of `picture`, which is one of them.
    void draw_mean(const ColourTarget& sum, unsigned frames, const RenderTarget& picture, const GlStateGuard& host);
    std::size_t programs() const { return programs_.size(); }  // number that were built
    void release();

private:
    enum Into { the_host, another_target, a_sum, the_host_mean, shades_of_it, the_host_shaded };
    // `resolved`: the picture is what one_sample() has made of one of several samples.
    const ShaderProgram& program(const RenderTarget& picture, Into into, const Finish& finish = {},
                                 bool resolved = false);
    // One texture each for the shader's first two units (shades: the third), then a triangle over the viewport.
    void run(const ShaderProgram& program, const char* colours, std::uint32_t of_colours, std::uint32_t colour_target,
             const RenderTarget& depths);
    // Fast lighting of a picture of one sample; false when the driver has no memory for it.
    bool find_shades(const RenderTarget& from, ColourTarget& shades, const Matrix4d& projection, const Finish& finish,
                     bool resolved);
    const RenderTarget& one_sample(const RenderTarget& picture, RenderTarget& resolved, const Finish& finish);
    std::map<std::tuple<unsigned, bool, bool, Into, unsigned, bool>, ShaderProgram> programs_;
};

// (x + y d) / (z + w d) is the distance from the eye, along its axis, of depth d: 1 at the near plane, 0 at the far
// one.
std::array<double, 4> distance_of_depth(const Matrix4d& projection);

}  // namespace pcm
