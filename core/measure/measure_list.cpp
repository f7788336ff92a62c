#include "pcm/measure/measure_list.h"

#include <cctype>
#include <utility>

namespace pcm {

std::string MeasureList::free_name(MeasureKind kind) const
{
    std::string word = name_of(kind);
    word[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(word[0])));
    for (std::size_t number = 1;; ++number) {
        const std::string name = word + " " + std::to_string(number);
        if (!has_name(name)) return name;
    }
}

std::size_t MeasureList::add(Measure measure)
{
    if (measure.name.empty()) measure.name = free_name(measure.kind);
    append({std::move(measure)});
    return size() - 1;
}

}  // namespace pcm
