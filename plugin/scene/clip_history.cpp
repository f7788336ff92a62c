#include "plugin/scene/clip_history.h"

namespace pcm::host {

bool same(const std::optional<ClipBox>& a, const std::optional<ClipBox>& b)
{
    if (!a || !b) return !a && !b;
    return a->centre == b->centre && a->axes == b->axes && a->half == b->half && a->outside == b->outside &&
           a->enabled == b->enabled;
}

ClipHistory::ClipHistory(Scene& scene) : QObject(&scene), scene_(scene), boxes_{scene.part<SceneState>().clip()}
{
    connect(&scene.part<SceneState>(), &SceneState::clip_changed, this, [this] {
        if (!setting_) add(scene_.part<SceneState>().clip());
    });
}

void ClipHistory::set(const std::optional<ClipBox>& box)
{
    if (same(box, scene_.part<SceneState>().clip())) return;
    setting_ = true;
    scene_.part<SceneState>().set_clip(box);
    setting_ = false;
}

void ClipHistory::add(const std::optional<ClipBox>& box)
{
    if (same(box, boxes_[done_])) return;
    boxes_.resize(done_ + 1);
    boxes_.push_back(box);
    if (boxes_.size() > most_steps) boxes_.erase(boxes_.begin());
    done_ = boxes_.size() - 1;
}

void ClipHistory::show(const std::optional<ClipBox>& box) { set(box); }

void ClipHistory::keep(const std::optional<ClipBox>& box)
{
    add(box);
    set(box);
}

void ClipHistory::begin_with(const std::optional<ClipBox>& box)
{
    set(box);
    boxes_ = {box};
    done_ = 0;
}

void ClipHistory::undo()
{
    if (can_undo()) set(boxes_[--done_]);
}

void ClipHistory::redo()
{
    if (can_redo()) set(boxes_[++done_]);
}

}  // namespace pcm::host
