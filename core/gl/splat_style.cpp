#include "pcm/gl/splat_style.h"

#include <string_view>

namespace pcm {
namespace {

bool has(const Schema& schema, std::string_view name, std::uint32_t components)
{
    const auto i = schema.find(name);
    return i && schema[*i].components >= components;
}

void add(std::string* notice, const std::string& absent, const std::string& instead)
{
    if (!notice) return;
    if (!notice->empty()) *notice += "; ";
    *notice += "the cloud has no " + absent + ": " + instead;
}

}  // namespace

CloudStyle usable_style(const CloudStyle& asked, const Schema& schema, std::string* notice)
{
    if (notice) notice->clear();
    CloudStyle style = asked;
    // Every point has a size, which stands for its radius.
    style.splats = drawable_mode(asked.splats, true, has(schema, attribute_name::normal, 3));
    if (style.splats != asked.splats) add(notice, "normals", std::string(name_of(style.splats)) + " splats are drawn");
    for (;;) {
        const ColourTraits& traits = traits_of(style.colour);
        if (traits.source == ColourSource::none ||
            has(schema, attribute_of(traits.source), components_of(traits.source)))
            return style;
        style.colour = traits.when_absent;
        add(notice, traits.absent, std::string(name_of(style.colour)) + " is shown");
    }
}

}  // namespace pcm
