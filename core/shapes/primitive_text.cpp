#include "pcm/shapes/primitive_text.h"

#include "pcm/system/rounded_text.h"

namespace pcm {

std::string place_text(const ShapeFit& fit)
{
    const ShapeTraits& traits = traits_of(fit.shape.kind);
    std::string text = traits.name + (traits.place.in + rounded_text(fit.shape.point, fit.errors.position));
    if (traits.has_axis())
        text += std::string(", ") + traits.axis_name() + " " + rounded_text(fit.shape.axis, fit.errors.angle);
    return text;
}

}  // namespace pcm
