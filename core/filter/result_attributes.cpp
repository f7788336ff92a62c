#include "pcm/filter/result_attributes.h"

#include "pcm/system/error.h"

#include <string>

namespace pcm {
namespace {

std::string type_text(const Attribute& attribute)
{
    std::string text(name_of(attribute.type));
    if (attribute.components > 1) text += " x " + std::to_string(attribute.components);
    if (attribute.scale != 1 || attribute.offset != 0) text += ", scaled";
    return text;
}

}  // namespace

std::size_t place_for(TreeChanges& changes, const Attribute& attribute)
{
    const auto tree = changes.tree();
    const auto place = tree->info().schema.find(attribute.name);
    if (!place) return changes.add_attribute(attribute);
    const Attribute& present = tree->info().schema[*place];
    if (present.type != attribute.type || present.components != attribute.components || present.scale != 1 ||
        present.offset != 0)
        throw Error(ErrorCode::invalid_argument, tree->folder(),
                    "the attribute '" + attribute.name + "' exists with another type (" + type_text(present) +
                        "); the computed values are " + type_text(attribute),
                    "convert the cloud to a tree without this attribute first");
    return *place;
}

}  // namespace pcm
