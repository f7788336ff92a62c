// A scene's list of one kind, with what is selected in it: what the books of measures and of primitives have in common.
#pragma once

#include "plugin/scene/scene.h"

#include <QObject>

#include <cstddef>
#include <functional>
#include <optional>
#include <utility>

namespace pcm::host {

class ListBookSignals : public QObject {
    Q_OBJECT

signals:
    void changed();  // the list, the selection, or how they are shown

protected:
    using QObject::QObject;
};

// `List` has size(), and steps with undo (pcm/lists/undo_list.h). GUI thread.
template <class List>
class ListBook : public ListBookSignals {
public:
    const List& list() const { return list_; }
    // Passes on what `step` throws; the list is then as it was.
    void change(const std::function<void(List& list)>& step)
    {
        List changed = list_;
        step(changed);
        list_ = std::move(changed);
        if (selected_ && *selected_ >= list_.size()) selected_.reset();
        show();
    }
    // Replaces the present ones, which cannot be restored.
    void replace(List list)
    {
        list_ = std::move(list);
        selected_.reset();
        show();
    }

    // The one that views show in its own way, whose numbers the panels show.
    std::optional<std::size_t> selected() const { return selected_; }
    void select(std::optional<std::size_t> index)
    {
        if (index && *index >= list_.size()) index.reset();
        if (index == selected_) return;
        selected_ = index;
        show();
    }

protected:
    explicit ListBook(Scene& scene) : ListBookSignals(&scene), scene_(scene) {}
    virtual void show() = 0;  // in the views; emits changed()

    Scene& scene_;

private:
    List list_;
    std::optional<std::size_t> selected_;
};

}  // namespace pcm::host
