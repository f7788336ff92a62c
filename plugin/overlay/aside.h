// A place to draw what is not shown. The view's context must be current.
#pragma once

#include <GL/glew.h>

#include <QOpenGLFramebufferObject>

namespace pcm::host {

// A framebuffer for frames that are not shown; bound during its lifetime.
class Aside {
public:
    Aside(int width, int height) : buffer_(width, height, QOpenGLFramebufferObject::CombinedDepthStencil)
    {
        glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &drawn_into_);
        glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read_from_);
        buffer_.bind();
    }
    ~Aside()
    {
        glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(drawn_into_));
        glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(read_from_));
    }
    Aside(const Aside&) = delete;
    Aside& operator=(const Aside&) = delete;

private:
    QOpenGLFramebufferObject buffer_;
    GLint drawn_into_ = 0, read_from_ = 0;
};

}  // namespace pcm::host
