// Trees on servers that are replaced while layers show them. Files are put on a server one by one, the index last: what
// lies there in between is not a tree.
#pragma once

#include "plugin/scene/worker.h"

#include "pcm/point_cloud.h"

#include <QElapsedTimer>
#include <QObject>

#include <filesystem>
#include <memory>
#include <string>

namespace pcm::host {

class Scene;

// Opens them again when they are whole, on a thread; the layers show what they have until then. A part of the scene.
// GUI thread.
class ReplacedTrees : public QObject {
    Q_OBJECT

public:
    explicit ReplacedTrees(Scene& scene);

    // Some of the points of `tree` could not be loaded, and `error` is why. Does nothing for a tree of this machine,
    // where the server did not answer, and within some seconds after the last time.
    void could_not_load(const Tree& tree, const std::string& error);

private:
    void show(const std::shared_ptr<PointCloud>& now);

    Scene& scene_;
    QElapsedTimer asked_;
    Worker worker_;
};

// Whether `now`, opened later from the same place, is to take the place of `before`: it has other points, or nothing
// more can be read of `before`, for the reason in `error`.
bool takes_the_place(const TreeInfo& now, const TreeInfo& before, const std::string& error);

}  // namespace pcm::host
