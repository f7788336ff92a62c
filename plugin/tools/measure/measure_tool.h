// The tool Measure: clicks on points make measures, and its panel has the list of them.
//
// A click without a movement picks a point; dragging and the wheel move MeshLab's camera. Ending the tool keeps the
// measures. GUI thread; profiles and volumes are computed on a thread of their own.
#pragma once

#include "plugin/scene/picker.h"
#include "plugin/scene/worker.h"
#include "plugin/tools/list_tool.h"
#include "plugin/tools/measure/draft.h"
#include "plugin/tools/measure/measure_panel.h"

#include <QPointer>

#include <functional>
#include <memory>
#include <optional>
#include <vector>

class QMouseEvent;

namespace pcm::host {

class MeasureBook;
class ProfileWindow;
struct ProfileData;

class MeasureTool : public ListTool {
    Q_OBJECT

public:
    MeasureTool();
    ~MeasureTool() override;
    bool start(SceneView& view) override;
    void end() override;
    void draw(QPainter* painter) override;

    // Also the place of the cursor, for the line to it.
    void mouseMoveEvent(QMouseEvent* event) override;

protected:
    // Moves without a button, and double clicks.
    bool eventFilter(QObject* receiver, QEvent* event) override;

private:
    MeasureBook& book() const;
    void say_in_panel(const QString& text) override
    {
        if (panel_) panel_->say(text);
    }
    void make_panel();
    void show_panel();
    void show_draft();
    void press(MeasurePanel::Button button);
    void change_kind();

    void click(const QPoint& place, Qt::KeyboardModifiers modifiers) override;
    bool has_right_click() const override { return true; }
    void right_click() override { end_draft(); }
    void press_key(ListKey key) override;
    void accept() override { end_draft(); }
    void take(int click, const PickAnswer& answer);
    void end_draft();
    bool cancel() override;  // also what is computed
    bool stop();             // the same without words
    void clear_draft();
    bool take_back() override;
    void finish();  // makes a measure of the complete draft
    void keep(Measure measure);
    void write();

    // In measure_clouds.cpp.
    SceneLayer& layer_of(const Measure& measure) const;
    double width_for(const Measure& measure) const;
    double usual_width(const std::vector<MeasuredPoint>& line) const;  // 0: not known
    void measure_cloud(std::size_t index);                             // plots a profile, finds a volume
    void plot(const Measure& measure);
    void write_points(const std::shared_ptr<const ProfileData>& data, const QString& extension, ProfileWindow& window);
    void find_volume(const Measure& measure);
    void take_volume(const Measure& measure, const std::vector<MeasureValue>& values,
                     const std::vector<std::string>& notes);
    // On a thread of its own; what it returns is done afterwards, in the GUI thread.
    using Afterwards = std::function<void()>;
    void begin(const QString& what, const std::function<Afterwards(const ProgressFunction& progress)>& work);

    QPointer<MeasurePanel> panel_;
    Draft draft_;
    std::unique_ptr<QObject> picks_;  // parent of the contexts of picks that are not answered
    std::optional<int> first_layer_;  // the layer that the draft's first point was picked on
    std::vector<double> spacings_;    // spacings of the points around the draft's points, in the scene
    Worker work_{"another profile or volume is being computed"};
    QPoint mouse_;
    bool tracked_mouse_ = false;
};

}  // namespace pcm::host
