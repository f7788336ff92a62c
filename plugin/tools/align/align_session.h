// The pairs of points that a user has picked in a document to align one layer to another, and the motion that they
// give.
//
// One for each scene; tools of several views add to the same pairs. GUI thread.
#pragma once

#include "pcm/align/rigid_fit.h"
#include "plugin/scene/picker.h"
#include "plugin/scene/scene_view.h"

#include <QObject>
#include <QString>

#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

struct PickedEnd {
    Vec3d position{};    // source coordinates of its layer's cloud, as the file has them
    double spacing = 0;  // spacing of the cloud's points there, source units; 0: not known
};

struct PickedPair {
    std::optional<PickedEnd> moving, fixed;
    double weight = 1;
    bool is_complete() const { return moving && fixed; }
};

class AlignSession : public QObject {
    Q_OBJECT

public:
    explicit AlignSession(Scene& scene);

    Scene& scene() const { return scene_; }
    // The layers; null where none is chosen, or it shows no tree any more.
    SceneLayer* moving() const;
    SceneLayer* fixed() const;
    // Chooses layers by id, -1: none. Other layers than before lose the pairs' points of that side.
    void choose(int moving, int fixed);
    // The current layer is to move, and the first other visible one is fixed; nothing if layers are chosen already.
    void choose_first();
    // The layers exchange their roles, and so do the points of all pairs.
    void swap();

    const std::vector<PickedPair>& pairs() const { return pairs_; }
    // A point of one of the two layers: it completes the first pair that lacks it, begins a new one, or replaces that
    // of `selected`. Returns what was done, or why nothing was.
    QString take(const Picked& point);
    // The pair whose points the next picks replace; -1: none.
    int selected() const { return selected_; }
    void select(int pair);
    void remove(int pair);
    void clear();
    // Pairs of a file, in source coordinates of the two clouds, replace all. Throws what read_pairs() throws.
    void load(const std::string& file);
    // The complete pairs. Throws Error(invalid_argument) if there are none, and what write_pairs() throws.
    void save(const std::string& file) const;

    bool with_scale() const { return with_scale_; }
    void set_scale(bool on);

    // From the complete pairs: source coordinates of the moving cloud to places of the scene. Nothing where problem()
    // says why.
    const std::optional<RigidFit>& fit() const { return fit_; }
    const QString& problem() const { return problem_; }
    // For each pair, its number in fit(); -1 for those that are not complete.
    int number_in_fit(std::size_t pair) const;
    // Where the view shows an end now.
    std::optional<Vec3d> shown(const PickedEnd& end, bool moving) const;

    // Sets the moving layer's matrix and returns lines for the log. Throws Error(invalid_argument) without a fit, and
    // for a locked layer.
    std::vector<std::string> apply();

    // Called when layers or their matrices have changed.
    void refresh();

signals:
    void changed();

private:
    void update();

    Scene& scene_;
    int moving_ = -1, fixed_ = -1, selected_ = -1;
    std::vector<PickedPair> pairs_;
    bool with_scale_ = false;
    std::optional<RigidFit> fit_;
    QString problem_;
};

// The rows of text under the table of pairs: RMS, motion, uncertainty, rounding; or what is wrong.
QString summary_of(const AlignSession& session);

}  // namespace pcm::host
