// Named things in an order that are added, renamed, hidden, changed and deleted, with undo and redo.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace pcm {

// Throws Error(invalid_argument) for a name that is empty, longer than 1000 bytes, or has control characters. `what`:
// "measure".
void check_list_name(const std::string& name, const char* what);
// "there is no measure number 4; the list has 3".
[[noreturn]] void refuse_index(const char* what, std::size_t index, std::size_t size);

// What lists of some kind are derived from; a T has a `name` and may be `hidden`. One thread. Every change is one step
// of undo(); the last 1000 steps are kept, which share what they have in common. Functions with an index throw
// Error(invalid_argument) for one that the list does not have, those with a thing or a name what check_list_name()
// throws, and then change nothing. Names are no key: two things may have the same.
template <class T>
class UndoList {
public:
    std::size_t size() const { return things_.size(); }
    bool empty() const { return things_.empty(); }
    const T& operator[](std::size_t index) const { return *things_[index]; }  // index < size()
    const T& at(std::size_t index) const
    {
        check_index(index);
        return *things_[index];
    }
    void rename(std::size_t index, const std::string& name)
    {
        T thing = at(index);
        thing.name = name;
        replace(index, std::move(thing));
    }
    void hide(std::size_t index, bool hidden)
    {
        T thing = at(index);
        thing.hidden = hidden;
        replace(index, std::move(thing));
    }
    // Another one in its place.
    void replace(std::size_t index, T thing)
    {
        check_index(index);
        check_list_name(thing.name, what_);
        Things things = things_;
        things[index] = std::make_shared<const T>(std::move(thing));
        change(std::move(things));
    }
    void remove(std::size_t index)
    {
        check_index(index);
        Things things = things_;
        things.erase(things.begin() + static_cast<std::ptrdiff_t>(index));
        change(std::move(things));
    }
    void clear()
    {
        if (!things_.empty()) change({});
    }

    bool can_undo() const { return !undone_.empty(); }
    bool can_redo() const { return !redone_.empty(); }
    void undo()  // does nothing when there is nothing to undo
    {
        if (undone_.empty()) return;
        redone_.push_back(std::exchange(things_, std::move(undone_.back())));
        undone_.pop_back();
    }
    void redo()
    {
        if (redone_.empty()) return;
        undone_.push_back(std::exchange(things_, std::move(redone_.back())));
        redone_.pop_back();
    }

protected:
    explicit UndoList(const char* what) : what_(what) {}  // one thing's name in messages; outlives the list
    ~UndoList() = default;
    UndoList(const UndoList&) = default;
    UndoList(UndoList&&) = default;
    UndoList& operator=(const UndoList&) = default;
    UndoList& operator=(UndoList&&) = default;

    bool has_name(const std::string& name) const
    {
        return std::any_of(things_.begin(), things_.end(), [&](const auto& thing) { return thing->name == name; });
    }
    void append(std::vector<T> added)  // one step
    {
        for (const T& thing : added) check_list_name(thing.name, what_);
        Things things = things_;
        things.reserve(things.size() + added.size());
        for (T& thing : added) things.push_back(std::make_shared<const T>(std::move(thing)));
        change(std::move(things));
    }
    void forget_steps()
    {
        undone_.clear();
        redone_.clear();
    }

private:
    using Things = std::vector<std::shared_ptr<const T>>;
    static constexpr std::size_t most_steps = 1000;

    void check_index(std::size_t index) const
    {
        if (index >= things_.size()) refuse_index(what_, index, things_.size());
    }
    void change(Things things)
    {
        undone_.push_back(std::exchange(things_, std::move(things)));
        if (undone_.size() > most_steps) undone_.pop_front();
        redone_.clear();
    }

    const char* what_;
    Things things_;
    std::deque<Things> undone_;  // the states before, the last one last
    std::vector<Things> redone_;
};

}  // namespace pcm
