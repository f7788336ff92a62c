// The tool Fit Primitives: a click on a surface fits a shape to the points around it, further clicks refine it, and its
// panel has the list of accepted ones.
//
// A click without a movement picks a point; dragging and the wheel move MeshLab's camera. Fits are computed on a worker
// (worker.h), in the coordinates of the picked cloud, of the points that the view shows. Ending the tool keeps the
// list. GUI thread.
#pragma once

#include "plugin/scene/annotations.h"
#include "plugin/scene/picker.h"
#include "plugin/scene/worker.h"
#include "plugin/tools/fit/fit_panel.h"
#include "plugin/tools/list_tool.h"
#include "plugin/tools/selection_uses.h"

#include <QPointer>

#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace pcm::host {

class PrimitiveBook;

// The places that were clicked, in the source coordinates of a layer's cloud.
struct FitPlaces {
    int layer_id = -1;
    std::shared_ptr<PointCloud> cloud;
    std::vector<Vec3d> on, off;  // the surface
};

// A shape that was found and is not accepted yet.
struct FitDraft {
    FitPlaces places;
    Primitive primitive;
    std::shared_ptr<const PointSet> points, before;  // its points; those that were selected when the draft was begun
    ReachedFrom reached;                             // how its points are found again
    bool doubt_shown = false;                        // whether a first Enter has shown that it is doubtful
};

class FitTool : public ListTool {
    Q_OBJECT

public:
    FitTool();
    ~FitTool() override;
    bool start(SceneView& view) override;
    void end() override;

private:
    enum class Way { first, add, take_away };

    PrimitiveBook& book() const;
    void say_in_panel(const QString& text) override
    {
        if (panel_) panel_->say(text);
    }
    void make_panel();
    void show_panel();
    void press(FitPanel::Button button);
    void publish(const QString& state);

    void click(const QPoint& place, Qt::KeyboardModifiers modifiers) override;
    void take(Way way, const Picked& picked);
    void fit();
    // Before it is followed: the shape of the places of fit `number`.
    void show_first(int number, const FitPlaces& places, const Primitive& primitive);
    void forget_first();
    void take_fit(const FitPlaces& places, std::optional<FittedPrimitive>& found, std::exception_ptr failure);
    void keep_draft(const FitPlaces& places, FittedPrimitive& found);
    void show_draft();
    std::vector<Annotation> drawn(const FitDraft& draft, const QString& label) const;
    QString doubt() const;  // the draft's: "doubtful (...): ..."; empty: none
    void press_key(ListKey key) override;
    void accept() override;
    bool cancel() override;
    bool take_back() override;  // the last place that was added or taken away
    void discard();             // the draft; what was selected before is selected again

    // In fit_uses.cpp.
    void write();
    void copy(std::optional<std::size_t> index) const;  // nothing: all
    void choose_colour(std::size_t index);
    void with_points(std::size_t index, const std::function<void(SceneLayer& layer)>& then);
    void use_points(FitPanel::Button button);

    QPointer<FitPanel> panel_;
    std::unique_ptr<QObject> picks_;   // the context of picks that are not answered
    std::optional<FitPlaces> wanted_;  // being fitted
    std::optional<FitDraft> first_;    // while it is followed: what it is around the places, without points
    std::optional<FitDraft> draft_;
    std::string unit_;    // unit of lengths
    bool again_ = false;  // the wanted fit has changed while it ran
    int fits_ = 0;        // number of answered fits
    Worker worker_{"a shape is being fitted"};
};

}  // namespace pcm::host
