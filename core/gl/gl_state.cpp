#include "gl/gl_state.h"

#include <GL/glew.h>

#include <cstdio>

namespace pcm {

namespace {

void set(GLenum capability, bool on) { on ? glEnable(capability) : glDisable(capability); }

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

}  // namespace

GlStateGuard::GlStateGuard()
{
    compatibility_ = is_compatibility_context();
    glGetIntegerv(GL_CURRENT_PROGRAM, &program_);
    glGetIntegerv(GL_VERTEX_ARRAY_BINDING, &vertex_array_);
    glGetIntegerv(GL_ARRAY_BUFFER_BINDING, &array_buffer_);
    glGetIntegerv(GL_COPY_WRITE_BUFFER, &copy_write_buffer_);  // as a query this is the binding
    glGetIntegerv(GL_DEPTH_FUNC, &depth_function_);
    glGetBooleanv(GL_DEPTH_WRITEMASK, &depth_mask_);
    depth_test_ = glIsEnabled(GL_DEPTH_TEST);
    blend_ = glIsEnabled(GL_BLEND);
    program_point_size_ = glIsEnabled(GL_PROGRAM_POINT_SIZE);
    if (compatibility_) {
        point_sprite_ = glIsEnabled(GL_POINT_SPRITE);
        point_smooth_ = glIsEnabled(GL_POINT_SMOOTH);
    }
}

GlStateGuard::~GlStateGuard()
{
    // A program that was deleted while in use cannot be bound again once it is let go of.
    if (program_ == 0 || glIsProgram(static_cast<GLuint>(program_)))
        glUseProgram(static_cast<GLuint>(program_));
    else
        glUseProgram(0);
    glBindVertexArray(static_cast<GLuint>(vertex_array_));
    glBindBuffer(GL_ARRAY_BUFFER, static_cast<GLuint>(array_buffer_));
    glBindBuffer(GL_COPY_WRITE_BUFFER, static_cast<GLuint>(copy_write_buffer_));
    glDepthFunc(static_cast<GLenum>(depth_function_));
    glDepthMask(depth_mask_);
    set(GL_DEPTH_TEST, depth_test_);
    set(GL_BLEND, blend_);
    set(GL_PROGRAM_POINT_SIZE, program_point_size_);
    if (compatibility_) {
        set(GL_POINT_SPRITE, point_sprite_);
        set(GL_POINT_SMOOTH, point_smooth_);
    }
}

bool gl_functions_loaded()
{
    return glCreateShader && glGenVertexArrays && glGenBuffers && glBufferSubData && glMultiDrawArrays &&
           glVertexAttribPointer && glUniformMatrix4fv;
}

std::string drain_gl_errors()
{
    std::string names;
    // A lost context reports errors for ever.
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
