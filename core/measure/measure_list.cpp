#include "pcm/measure/measure_list.h"

#include "pcm/system/error.h"

#include <algorithm>
#include <cctype>
#include <utility>

namespace pcm {
namespace {

constexpr std::size_t most_steps = 1000, longest_name = 1000;

void check_name(const std::string& name)
{
    const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
    const char* wrong = name.empty()                                        ? "is empty"
                        : name.size() > longest_name                        ? "is longer than 1000 bytes"
                        : std::any_of(name.begin(), name.end(), is_control) ? "has control characters"
                                                                            : nullptr;
    if (wrong) throw Error(ErrorCode::invalid_argument, {}, std::string("the name of a measure ") + wrong);
}

}  // namespace

const Measure& MeasureList::at(std::size_t index) const
{
    check_index(index);
    return *measures_[index];
}

void MeasureList::check_index(std::size_t index) const
{
    if (index >= measures_.size())
        throw Error(ErrorCode::invalid_argument, {},
                    "there is no measure number " + std::to_string(index + 1) + "; the list has " +
                        std::to_string(measures_.size()));
}

void MeasureList::change(Measures measures)
{
    undone_.push_back(std::exchange(measures_, std::move(measures)));
    if (undone_.size() > most_steps) undone_.pop_front();
    redone_.clear();
}

std::string MeasureList::free_name(MeasureKind kind) const
{
    std::string word = name_of(kind);
    word[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(word[0])));
    for (std::size_t number = 1;; ++number) {
        std::string name = word + " " + std::to_string(number);
        if (std::none_of(measures_.begin(), measures_.end(), [&](const auto& other) { return other->name == name; }))
            return name;
    }
}

std::size_t MeasureList::add(Measure measure)
{
    if (measure.name.empty()) measure.name = free_name(measure.kind);
    check_name(measure.name);
    Measures measures = measures_;
    measures.push_back(std::make_shared<const Measure>(std::move(measure)));
    change(std::move(measures));
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
    replace(index, std::move(measure));
}

void MeasureList::replace(std::size_t index, Measure measure)
{
    check_index(index);
    check_name(measure.name);
    Measures measures = measures_;
    measures[index] = std::make_shared<const Measure>(std::move(measure));
    change(std::move(measures));
}

void MeasureList::remove(std::size_t index)
{
    check_index(index);
    Measures measures = measures_;
    measures.erase(measures.begin() + static_cast<std::ptrdiff_t>(index));
    change(std::move(measures));
}

void MeasureList::clear()
{
    if (!empty()) change({});
}

void MeasureList::undo()
{
    if (undone_.empty()) return;
    redone_.push_back(std::exchange(measures_, std::move(undone_.back())));
    undone_.pop_back();
}

void MeasureList::redo()
{
    if (redone_.empty()) return;
    undone_.push_back(std::exchange(measures_, std::move(redone_.back())));
    redone_.pop_back();
}

}  // namespace pcm
