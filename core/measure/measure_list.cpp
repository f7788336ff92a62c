#include "pcm/measure/measure_list.h"

#include <cctype>
#include <utility>

namespace pcm {
namespace {

std::string free_name(const UndoList<Measure>& list, MeasureKind kind)
{
    std::string word = name_of(kind);
    word[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(word[0])));
    for (std::size_t number = 1;; ++number) {
        const std::string name = word + " " + std::to_string(number);
        if (!list.has_name(name)) return name;
    }
}

}  // namespace

std::size_t MeasureList::add(Measure measure)
{
    if (measure.name.empty()) measure.name = free_name(list_, measure.kind);
    check_list_name(measure.name, "measure");
    list_.add({std::move(measure)});
    return size() - 1;
}

void MeasureList::rename(std::size_t index, const std::string& name)
{
    Measure measure = at(index);
    measure.name = name;
    replace(index, std::move(measure));
}

void MeasureList::hide(std::size_t index, bool hidden)
{
    Measure measure = at(index);
    measure.hidden = hidden;
    list_.replace(index, std::move(measure));
}

void MeasureList::replace(std::size_t index, Measure measure)
{
    at(index);
    check_list_name(measure.name, "measure");
    list_.replace(index, std::move(measure));
}

}  // namespace pcm
