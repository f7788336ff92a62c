#include "plugin/overlay/blend_image.h"

#include <GL/glew.h>

namespace pcm::host {

void blend_image(const QImage& image, int x, int y)
{
    GLint program = 0, unpack_buffer = 0, alignment = 4, row_length = 0;
    glGetIntegerv(GL_CURRENT_PROGRAM, &program);
    glGetIntegerv(GL_PIXEL_UNPACK_BUFFER_BINDING, &unpack_buffer);
    glGetIntegerv(GL_UNPACK_ALIGNMENT, &alignment);
    glGetIntegerv(GL_UNPACK_ROW_LENGTH, &row_length);
    glPushAttrib(GL_ALL_ATTRIB_BITS);
    glUseProgram(0);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    for (const GLenum off : {GL_DEPTH_TEST, GL_LIGHTING, GL_TEXTURE_2D, GL_TEXTURE_1D, GL_FOG, GL_ALPHA_TEST,
                             GL_STENCIL_TEST, GL_SCISSOR_TEST, GL_COLOR_LOGIC_OP, GL_CULL_FACE})
        glDisable(off);
    glPixelTransferi(GL_MAP_COLOR, GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glWindowPos2i(x, y);
    glPixelZoom(1, 1);
    const QImage flipped = image.mirrored();  // OpenGL's rows begin at the bottom
    glDrawPixels(flipped.width(), flipped.height(), GL_RGBA, GL_UNSIGNED_BYTE, flipped.constBits());
    glPopAttrib();
    glPixelStorei(GL_UNPACK_ALIGNMENT, alignment);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, row_length);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, static_cast<GLuint>(unpack_buffer));
    glUseProgram(static_cast<GLuint>(program));
}

}  // namespace pcm::host
