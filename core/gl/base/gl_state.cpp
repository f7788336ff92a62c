#include "pcm/gl/base/gl_state.h"

#include <GL/glew.h>

#include <cstdio>
#include <string_view>

namespace pcm {

namespace {

void set(GLenum capability, bool on) { on ? glEnable(capability) : glDisable(capability); }

}  // namespace

bool is_compatibility_context()
{
    GLint major = 0;
    GLint minor = 0;
    glGetIntegerv(GL_MAJOR_VERSION, &major);
    glGetIntegerv(GL_MINOR_VERSION, &minor);
    if (major < 3 || (major == 3 && minor < 2)) return true;
    GLint profile = 0;
    glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
    return (profile & GL_CONTEXT_CORE_PROFILE_BIT) == 0;
}

GlStateGuard::GlStateGuard()
{
    compatibility_ = is_compatibility_context();
    const auto keep = [&](GLenum capability) {
        switches_.emplace_back(capability, glIsEnabled(capability) == GL_TRUE);
    };
    for (const GLenum capability :
         {GL_DEPTH_TEST, GL_BLEND, GL_PROGRAM_POINT_SIZE, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_CULL_FACE, GL_DITHER,
          GL_MULTISAMPLE, GL_SAMPLE_ALPHA_TO_COVERAGE, GL_SAMPLE_ALPHA_TO_ONE, GL_SAMPLE_COVERAGE,
          GL_RASTERIZER_DISCARD, GL_POLYGON_OFFSET_FILL, GL_FRAMEBUFFER_SRGB, GL_COLOR_LOGIC_OP, GL_PRIMITIVE_RESTART,
          GL_DEPTH_CLAMP})
        keep(capability);
    if (GLEW_ARB_sample_shading || GLEW_VERSION_4_0) keep(GL_SAMPLE_SHADING);
    if (compatibility_)
        for (const GLenum capability :
             {GL_POINT_SPRITE, GL_POINT_SMOOTH, GL_ALPHA_TEST, GL_POLYGON_STIPPLE, GL_POLYGON_SMOOTH})
            keep(capability);
    GLint clip_distances = 0;
    glGetIntegerv(GL_MAX_CLIP_DISTANCES, &clip_distances);
    for (int i = 0; i < clip_distances; ++i) keep(GL_CLIP_DISTANCE0 + static_cast<GLenum>(i));
    glGetIntegerv(GL_CURRENT_PROGRAM, &program_);
    glGetIntegerv(GL_VERTEX_ARRAY_BINDING, &vertex_array_);
    glGetIntegerv(GL_ARRAY_BUFFER_BINDING, &array_buffer_);
    glGetIntegerv(GL_COPY_WRITE_BUFFER, &copy_write_buffer_);  // as a query this is the binding
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &draw_framebuffer_);
    glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read_framebuffer_);
    glGetIntegerv(GL_RENDERBUFFER_BINDING, &renderbuffer_);
    glGetIntegerv(GL_ACTIVE_TEXTURE, &active_texture_);
    for (std::size_t unit = 0; unit < textures_.size(); ++unit) {
        glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
        textures_[unit] = {{{GL_TEXTURE_2D, 0}, {GL_TEXTURE_2D_MULTISAMPLE, 0}}};
        glGetIntegerv(GL_TEXTURE_BINDING_2D, &textures_[unit][0].name);
        glGetIntegerv(GL_TEXTURE_BINDING_2D_MULTISAMPLE, &textures_[unit][1].name);
        glGetIntegerv(GL_SAMPLER_BINDING, &samplers_[unit]);
    }
    glActiveTexture(static_cast<GLenum>(active_texture_));
    glGetIntegerv(GL_VIEWPORT, viewport_.data());
    glGetIntegerv(GL_BLEND_SRC_RGB, &blend_[0]);
    glGetIntegerv(GL_BLEND_DST_RGB, &blend_[1]);
    glGetIntegerv(GL_BLEND_SRC_ALPHA, &blend_[2]);
    glGetIntegerv(GL_BLEND_DST_ALPHA, &blend_[3]);
    glGetIntegerv(GL_BLEND_EQUATION_RGB, &blend_equation_[0]);
    glGetIntegerv(GL_BLEND_EQUATION_ALPHA, &blend_equation_[1]);
    polygon_mode_ = {GL_FILL, GL_FILL};
    glGetIntegerv(GL_POLYGON_MODE, polygon_mode_.data());  // one value in core contexts, two in compatibility contexts
    if (gl_has_clip_control()) {
        glGetIntegerv(GL_CLIP_ORIGIN, &clip_[0]);
        glGetIntegerv(GL_CLIP_DEPTH_MODE, &clip_[1]);
    }
    glGetFloatv(GL_COLOR_CLEAR_VALUE, clear_colour_.data());
    glGetFloatv(GL_DEPTH_CLEAR_VALUE, &clear_depth_);
    glGetFloatv(GL_DEPTH_RANGE, depth_range_.data());
    glGetIntegerv(GL_DEPTH_FUNC, &depth_function_);
    glGetBooleanv(GL_DEPTH_WRITEMASK, &depth_mask_);
    glGetBooleanv(GL_COLOR_WRITEMASK, colour_mask_.data());
}

void GlStateGuard::set_plain() const
{
    for (const auto& [capability, on] : switches_)
        if (capability != GL_MULTISAMPLE) glDisable(capability);
    glEnable(GL_MULTISAMPLE);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glDepthRange(0, 1);
    for (std::size_t unit = 0; unit < samplers_.size(); ++unit)
        if (samplers_[unit]) glBindSampler(static_cast<GLuint>(unit), 0);
}

GlStateGuard::~GlStateGuard()
{
    // A program that was deleted while in use cannot be bound again after another one was.
    if (program_ == 0 || glIsProgram(static_cast<GLuint>(program_)))
        glUseProgram(static_cast<GLuint>(program_));
    else
        glUseProgram(0);
    glBindVertexArray(static_cast<GLuint>(vertex_array_));
    glBindBuffer(GL_ARRAY_BUFFER, static_cast<GLuint>(array_buffer_));
    glBindBuffer(GL_COPY_WRITE_BUFFER, static_cast<GLuint>(copy_write_buffer_));
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(draw_framebuffer_));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(read_framebuffer_));
    glBindRenderbuffer(GL_RENDERBUFFER, static_cast<GLuint>(renderbuffer_));
    for (std::size_t unit = 0; unit < textures_.size(); ++unit) {
        glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
        for (const Texture& texture : textures_[unit]) glBindTexture(texture.target, static_cast<GLuint>(texture.name));
        if (samplers_[unit]) glBindSampler(static_cast<GLuint>(unit), static_cast<GLuint>(samplers_[unit]));
    }
    glActiveTexture(static_cast<GLenum>(active_texture_));
    glViewport(viewport_[0], viewport_[1], viewport_[2], viewport_[3]);
    glBlendFuncSeparate(static_cast<GLenum>(blend_[0]), static_cast<GLenum>(blend_[1]), static_cast<GLenum>(blend_[2]),
                        static_cast<GLenum>(blend_[3]));
    glBlendEquationSeparate(static_cast<GLenum>(blend_equation_[0]), static_cast<GLenum>(blend_equation_[1]));
    if (compatibility_) {
        glPolygonMode(GL_FRONT, static_cast<GLenum>(polygon_mode_[0]));
        glPolygonMode(GL_BACK, static_cast<GLenum>(polygon_mode_[1]));
    } else {
        glPolygonMode(GL_FRONT_AND_BACK, static_cast<GLenum>(polygon_mode_[0]));
    }
    if (gl_has_clip_control()) glClipControl(static_cast<GLenum>(clip_[0]), static_cast<GLenum>(clip_[1]));
    glClearColor(clear_colour_[0], clear_colour_[1], clear_colour_[2], clear_colour_[3]);
    glClearDepth(static_cast<GLclampd>(clear_depth_));
    glDepthRange(static_cast<GLclampd>(depth_range_[0]), static_cast<GLclampd>(depth_range_[1]));
    glDepthFunc(static_cast<GLenum>(depth_function_));
    glDepthMask(depth_mask_);
    glColorMask(colour_mask_[0], colour_mask_[1], colour_mask_[2], colour_mask_[3]);
    for (const auto& [capability, on] : switches_) set(capability, on);
}

bool gl_functions_loaded()
{
    return glCreateShader && glGenVertexArrays && glGenBuffers && glBufferSubData && glMultiDrawArrays &&
           glVertexAttribPointer && glUniformMatrix4fv && glGenFramebuffers && glTexImage2DMultisample;
}

bool gl_has_clip_control() { return (GLEW_VERSION_4_5 || GLEW_ARB_clip_control) && glClipControl; }

bool gl_is_software()
{
    const auto* const renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    const std::string_view name = renderer ? renderer : "";
    for (const char* software : {"llvmpipe", "softpipe", "swrast", "Software", "SwiftShader"})
        if (name.find(software) != std::string_view::npos) return true;
    return false;
}

std::string drain_gl_errors()
{
    std::string names;
    // A lost context reports errors forever: stop after some.
    for (int i = 0; i < 32; ++i) {
        const GLenum error = glGetError();
        if (error == GL_NO_ERROR) break;
        char name[16];
        std::snprintf(name, sizeof name, "0x%04x", error);
        const char* known = error == GL_INVALID_ENUM                    ? "invalid enum"
                            : error == GL_INVALID_VALUE                 ? "invalid value"
                            : error == GL_INVALID_OPERATION             ? "invalid operation"
                            : error == GL_OUT_OF_MEMORY                 ? "out of memory"
                            : error == GL_INVALID_FRAMEBUFFER_OPERATION ? "invalid framebuffer operation"
                                                                        : name;
        names += (names.empty() ? "" : ", ") + std::string(known);
    }
    return names;
}

}  // namespace pcm
