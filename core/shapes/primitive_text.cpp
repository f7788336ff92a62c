#include "pcm/shapes/primitive_text.h"

#include "pcm/system/rounded_text.h"

namespace pcm {

std::string place_text(const ShapeFit& fit)
{
    const ShapeTraits& traits = traits_of(fit.shape.kind);
    const bool is_plane = fit.shape.kind == ShapeKind::plane, is_cylinder = fit.shape.kind == ShapeKind::cylinder;
    const char* place = is_plane || is_cylinder             ? " through "
                        : fit.shape.kind == ShapeKind::cone ? " with its apex at "
                                                            : " about ";
    std::string text = traits.name + (place + rounded_text(fit.shape.point, fit.errors.position));
    if (traits.axis) text += (is_plane ? ", normal " : ", axis ") + rounded_text(fit.shape.axis, fit.errors.angle);
    return text;
}

}  // namespace pcm
