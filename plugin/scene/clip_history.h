// The changes of a document's clip box, to be undone. GUI thread.
#pragma once

#include "plugin/scene/scene.h"

#include "plugin/scene/scene_state.h"

#include <QObject>

#include <optional>
#include <vector>

namespace pcm::host {

bool same(const std::optional<ClipBox>& a, const std::optional<ClipBox>& b);

// One for each scene. Changes by others, such as a filter, are steps too.
class ClipHistory : public QObject {
    Q_OBJECT

public:
    explicit ClipHistory(Scene& scene);

    // Shows a box without a step, as while one is dragged; the next keep() makes the step.
    void show(const std::optional<ClipBox>& box);
    void keep(const std::optional<ClipBox>& box);
    // The box that a project was opened with: there is nothing before it to go back to.
    void begin_with(const std::optional<ClipBox>& box);
    bool can_undo() const { return done_ > 0; }
    bool can_redo() const { return done_ + 1 < boxes_.size(); }
    void undo();
    void redo();

private:
    static constexpr std::size_t most_steps = 1000;
    void set(const std::optional<ClipBox>& box);
    void add(const std::optional<ClipBox>& box);

    Scene& scene_;
    std::vector<std::optional<ClipBox>> boxes_;  // the first is the one before all steps
    std::size_t done_ = 0;                       // index in boxes_ of the one that is shown
    bool setting_ = false;
};

}  // namespace pcm::host
