#include "plugin/render/legend_box.h"

#include <GL/glew.h>

#include <algorithm>
#include <cmath>

namespace pcm::host {

namespace {

constexpr int distance = 8;       // from the view's border, Qt's pixels
constexpr int info_height = 120;  // MeshLab's own text at the bottom of the view

// At a place from the viewport's lower left corner, pixels.
void blend(const QImage& image, int x, int y)
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

}  // namespace

void LegendBox::draw(const std::vector<LayerLegend>& legends, const QSize& view, double ratio)
{
    picture_ = draw_legends(legends, std::max(0, view.height() - info_height), ratio);
    if (picture_.image.isNull()) return;
    const QSize size = picture_.image.size();
    const int width = static_cast<int>(std::ceil(size.width() / ratio));
    corner_ = QPoint(std::max(0, view.width() - distance - width), distance);
    blend(picture_.image, static_cast<int>(corner_.x() * ratio),
          static_cast<int>((view.height() - corner_.y()) * ratio) - size.height());
}

std::optional<unsigned> LegendBox::class_at(const QPoint& place) const
{
    for (const auto& [row, number] : picture_.classes)
        if (row.contains(place - corner_)) return number;
    return std::nullopt;
}

}  // namespace pcm::host
